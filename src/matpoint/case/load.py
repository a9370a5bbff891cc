"""Reading a case: a file or a bundled name, with overrides."""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from matpoint.case.describe import first_problem
from matpoint.case.schema import CaseTable, InterpolationTable
from matpoint.errors import InputError, did_you_mean

_LARGEST = 50_000_000  # bytes of a case file


@dataclass(frozen=True)
class Case:
    """A case that has been read and checked table by table.

    Attributes
    ----------
    name
        The bundled name, or the file's name without its ending.
    tables
        Its tables.
    folder
        Where the files are that it names by relative paths; None takes the current folder.
    """

    name: str
    tables: CaseTable
    folder: Path | None = None


def bundled_cases() -> dict[str, str]:
    """Return the bundled cases: name -> text."""
    folder = resources.files("matpoint.case").joinpath("bundled")
    found = {f.name.removesuffix(".toml"): f for f in folder.iterdir() if f.name.endswith(".toml")}
    return {name: found[name].read_text(encoding="utf-8") for name in sorted(found)}


def _read(case: str) -> tuple[str, str, Path | None]:
    """The name, text and folder of a case; a file wins over a bundled name only if it looks like a path."""
    bundled = bundled_cases()
    if case in bundled:
        return case, bundled[case], None
    path = Path(case)
    try:
        if path.is_file():
            if path.stat().st_size > _LARGEST:
                raise InputError(f"case {case}: the file is larger than {_LARGEST // 10**6} MB")
            return path.stem, path.read_text(encoding="utf-8"), path.parent
    except (OSError, UnicodeDecodeError, ValueError) as error:
        raise InputError(f"case {case}: the file can't be read ({error})") from None
    raise InputError(
        f"case {case!r} is neither a file nor a bundled case{did_you_mean(case, bundled)};"
        f" bundled are {', '.join(bundled)}"
    )


def _parse(text: str, where: str) -> dict[str, Any]:
    try:
        return tomllib.loads(text)
    except (tomllib.TOMLDecodeError, RecursionError, ValueError) as error:
        raise InputError(f"{where}: not valid TOML ({error})") from None


def _value(text: str) -> Any:
    """A value as TOML writes it; a bare word is a string."""
    try:
        parsed = tomllib.loads(f"value = {text}")
    except (tomllib.TOMLDecodeError, RecursionError, ValueError):
        return text
    return parsed["value"] if set(parsed) == {"value"} else text


def _override(content: dict[str, Any], setting: str) -> None:
    """Apply one ``table.key=value``."""
    path, equals, text = setting.partition("=")
    steps = [s.strip() for s in path.split(".")]
    if not equals or not all(steps):
        raise InputError(f"--set {setting!r}: write it as table.key=value")
    place: Any = content
    for step, after in zip(steps, [*steps[1:], None], strict=True):
        key: Any = step
        if isinstance(place, list):
            if not (step.isascii() and step.isdigit() and len(step) < 10 and int(step) < len(place)):
                most = f"a number from 0 to {len(place) - 1}" if place else "left out: the list is empty"
                raise InputError(f"--set {setting!r}: {step!r} must be {most}")
            key = int(step)
        elif not isinstance(place, dict):
            raise InputError(f"--set {setting!r}: {step!r} lies below a value, not a table")
        if after is None:
            place[key] = _value(text.strip())
        elif isinstance(place, dict):
            place = place.setdefault(key, {})
        else:
            place = place[key]


def _leave_behind(content: dict[str, Any], before: dict[str, Any], overrides: Sequence[str]) -> None:
    """Drop the options of the file's method that another method, set by an override, does not have."""
    table = content.get("interpolation")
    if not before or not isinstance(table, dict) or table.get("method") == before.get("method"):
        return
    from matpoint.interpolation import METHODS  # noqa: PLC0415 (compiles)

    chosen = METHODS.get(str(table.get("method")))
    given = {setting.partition("=")[0].replace(" ", "") for setting in overrides}
    for key in set(before) & set(InterpolationTable.model_fields) - {"method"}:
        if chosen is not None and not hasattr(chosen, key) and f"interpolation.{key}" not in given:
            table.pop(key, None)


def check(content: dict[str, Any], where: str) -> CaseTable:
    """Return the tables of a case, given as TOML gives them.

    Raises
    ------
    InputError
        With ``where``, the table and key, the value, and what is allowed.
    """
    try:
        return CaseTable.model_validate(content)
    except ValidationError as error:
        raise InputError(f"{where}: {first_problem(error, CaseTable, content)}") from None
    except RecursionError:
        raise InputError(f"{where}: its tables are nested too deeply") from None


def load(case: str, overrides: Sequence[str] = ()) -> Case:
    """Read a case and check its tables.

    Parameters
    ----------
    case
        A file, or the name of a bundled case.
    overrides
        Settings as ``table.key=value``, values as in TOML or bare words; entries of lists by their
        number from 0, for instance ``bodies.0.per_cell=3``. Another ``interpolation.method`` leaves
        behind the file's options that it does not have.

    Raises
    ------
    InputError
        With the table and key, the value, and what is allowed.
    """
    name, text, folder = _read(str(case))
    content = _parse(text, f"case {case}")
    before = dict(table) if isinstance(table := content.get("interpolation"), dict) else {}
    for setting in overrides:
        _override(content, setting)
    _leave_behind(content, before, overrides)
    return Case(name, check(content, f"case {case}"), folder)

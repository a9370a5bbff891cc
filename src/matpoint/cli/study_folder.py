"""The output folder of a study: made anew, or that of a study which this one extends."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from matpoint.cli.converging import settings_of
from matpoint.errors import InputError
from matpoint.output.folder import extend_folder, prepare_folder, wrote

if TYPE_CHECKING:
    from matpoint.study import Plan

#: What a study writes.
FILES = ("figure-*.png", "converge.json", "settings.json", "table.txt")
_CURE = "use --force to replace it, or --out for another folder"
_FREE = ("methods", "interpolations", "stages", "matpoint", "python")  # more methods may join


def study_folder(folder: Path, force: bool, planned: Plan) -> Path:
    """Create the folder of a study, or take that of a study which this one extends: it repeats all of it.

    The results of the study before are replaced when the new ones are written, and no other file is touched.

    Raises
    ------
    InputError
        As :func:`~matpoint.output.prepare_folder` does; also if the study in the folder has other settings,
        or has runs that this one lacks, and ``force`` is not given.
    """
    if force or not wrote(folder, ("converge.json", "settings.json")):
        return prepare_folder(folder, force, FILES)
    try:
        before = _read(folder / "settings.json")
        found = _read(folder / "converge.json")
        lost = _lost(found, planned)
    except (OSError, ValueError, TypeError, KeyError, AttributeError):
        return prepare_folder(folder, force, FILES)  # no study, or half of one: it refuses
    _refuse_other_settings(folder, before, settings_of(planned))
    if lost:
        raise InputError(
            f"output: {folder} holds a study whose runs this one lacks: {', '.join(lost)}; name these too to"
            f" extend it, {_CURE}"
        )
    return extend_folder(folder, FILES)


def _read(path: Path) -> dict[str, Any]:
    found = json.loads(path.read_text(encoding="utf-8"))
    if not isinstance(found, dict):
        raise TypeError(path)
    return found


def _lost(found: dict[str, Any], planned: Plan) -> list[str]:
    """Runs of the study before that this one does not have: method and cells."""
    lost = []
    for method, entries in found.items():
        if method != "order":
            sizes = [e["cells"] for e in entries]
            missing = sizes if method not in planned.methods else [n for n in sizes if n not in planned.cells]
            if missing:
                lost.append(f"{method} on {', '.join(map(str, missing))} cells")
    return lost


def _refuse_other_settings(folder: Path, before: dict[str, Any], now: dict[str, Any]) -> None:
    """Refuse to mix studies: what both have must be the same."""
    plain = json.loads(json.dumps(now))
    pairs = [(key, before.get(key), plain.get(key)) for key in plain if key not in _FREE]
    for table in ("interpolations", "stages"):
        old = before.get(table)
        for method, choice in (old if isinstance(old, dict) else {}).items():
            pairs.append((method, choice, plain[table].get(method, choice)))
    for key, old, new in pairs:
        if old != new:
            raise InputError(f"output: {folder} holds a study with {key} = {old}, here {new}; {_CURE}")

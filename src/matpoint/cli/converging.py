"""What ``converge`` reads and writes."""

from __future__ import annotations

import dataclasses
import platform
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from matpoint._version import __version__
from matpoint.errors import InputError
from matpoint.output.folder import claim
from matpoint.output.summary import write_json
from matpoint.problems import PROBLEMS, ManufacturedProblem

if TYPE_CHECKING:
    from matpoint.case import Case
    from matpoint.interpolation import Interpolation
    from matpoint.study import Plan, Study
    from matpoint.transfers import Transfer

_LONGEST = 18  # digits of a size


def read_problem(read: Case, case: str) -> ManufacturedProblem:
    """Return the manufactured problem of a case.

    Raises
    ------
    InputError
        If it has none.
    """
    from matpoint.case import make_problem  # noqa: PLC0415 (slow to import)

    table = read.tables.problem
    problem = None if table is None else make_problem(table)
    if not isinstance(problem, ManufacturedProblem):
        names = [name for name, kind in PROBLEMS.items() if issubclass(kind, ManufacturedProblem)]
        raise InputError(f"case {case}: it has no manufactured problem; those are {', '.join(names)}")
    return problem


def whole_numbers(text: str | None) -> list[int] | None:
    """Return the sizes of ``--cells``.

    Raises
    ------
    InputError
        If one of them is no whole number.
    """
    if text is None:
        return None
    parts = [part.strip() for part in text.split(",")]
    if not all(part.isascii() and part.isdigit() for part in parts):
        raise InputError(f"--cells {text!r} must be whole numbers separated by commas, for instance 8,16,32")
    if any(len(part) > _LONGEST for part in parts):
        raise InputError(f"--cells: a number of over {_LONGEST} digits is no size of a grid; take 8,16,32")
    return [int(part) for part in parts]


def split_settings(settings: Sequence[str]) -> dict[str, list[str]]:
    """Return which keys of the tables that a study knows were set: table -> keys, in order.

    Raises
    ------
    InputError
        If one is of another table, which the study would pass over, or names a whole table or the method.
    """
    keys: dict[str, list[str]] = {"problem": [], "scheme": [], "interpolation": []}
    for setting in settings:
        table, key, *_ = [*(part.strip() for part in setting.partition("=")[0].split(".")), ""]
        if table not in keys:
            raise InputError(
                f"--set {setting!r}: grid, times and output are the study's own; problem.*, scheme.* and"
                " interpolation.OPTION can be set"
            )
        if not key:
            raise InputError(f"--set {setting!r}: set one key of the table, such as {table}.KEY=VALUE")
        if (table, key) == ("interpolation", "method"):
            raise InputError(f"--set {setting!r}: a study takes its methods from --methods")
        keys[table].append(key)
    return keys


def read_scheme(
    read: Case, keys: Sequence[str], problem: ManufacturedProblem
) -> tuple[ManufacturedProblem, Transfer]:
    """Return the problem with the order of stages that was set, and the transfer that was set.

    Of the case's own ``[scheme]`` nothing is taken: it belongs to a run of the case.

    Raises
    ------
    InputError
        If an option belongs to another transfer, or ``problem.scheme`` says another order.
    """
    from matpoint.case.objects import make_transfer  # noqa: PLC0415 (slow to import)
    from matpoint.case.schema import SchemeTable  # noqa: PLC0415

    table = SchemeTable(**{key: getattr(read.tables.scheme, key) for key in keys})
    if table.order is not None:
        if problem.scheme not in ("", table.order):
            raise InputError(f"scheme.order = {table.order!r}: problem.scheme = {problem.scheme!r}; set one")
        problem = dataclasses.replace(problem, scheme=table.order)
    return problem, make_transfer(table)


def read_methods(read: Case, keys: Sequence[str], names: Sequence[str]) -> dict[str, Interpolation]:
    """Return the methods with the options of ``[interpolation]`` that were set, the same for all of them.

    Raises
    ------
    InputError
        If a method does not have such an option, or can't take such a value.
    """
    from matpoint.case.objects import make_interpolation  # noqa: PLC0415 (slow to import)
    from matpoint.case.schema import InterpolationTable  # noqa: PLC0415

    options = {key: getattr(read.tables.interpolation, key) for key in keys}
    found = {}
    for name in names:
        try:
            found[name] = make_interpolation(InterpolationTable(method=name, **options))
        except InputError as error:
            raise InputError(f"{error} ({name} is one of the methods)") from None
    return found


def settings_of(planned: Plan) -> dict[str, Any]:
    """Return what a study's ``settings.json`` says of what was run."""
    settings = dataclasses.asdict(planned.problem)
    settings.pop("cells")
    return {
        "problem": planned.problem.name, **settings, "end": planned.problem.end,
        "transfer": repr(planned.transfer),
        "methods": list(planned.methods),
        "interpolations": {label: repr(choice) for label, choice in planned.methods.items()},
        "stages": {label: planned.problem.scheme_for(c).name for label, c in planned.methods.items()},
        "matpoint": __version__, "python": platform.python_version(),
    }  # fmt: skip


def write_all(study: Study, folder: Path) -> None:
    """Write figures, ``table.txt``, ``converge.json`` and ``settings.json`` into a folder that exists."""
    from matpoint.study.figures import write_study  # noqa: PLC0415 (loads matplotlib)

    write_study(study, folder)
    claim(folder / "table.txt").write_text(study.tables() + "\n", encoding="utf-8")
    write_json(folder / "converge.json", study.json())
    write_json(folder / "settings.json", settings_of(study.plan))

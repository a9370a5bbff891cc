"""What ``converge`` reads and writes."""

from __future__ import annotations

import dataclasses
import platform
from pathlib import Path
from typing import TYPE_CHECKING

from matpoint._version import __version__
from matpoint.errors import InputError
from matpoint.output.folder import claim
from matpoint.output.summary import write_json
from matpoint.problems import PROBLEMS, ManufacturedProblem

if TYPE_CHECKING:
    from matpoint.case import Case
    from matpoint.study import Study


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
    if not all(part.isascii() and part.isdigit() and len(part) < 7 for part in parts):
        raise InputError(f"--cells {text!r} must be whole numbers separated by commas, for instance 8,16,32")
    return [int(part) for part in parts]


def write_all(study: Study, folder: Path) -> None:
    """Write figures, ``table.txt``, ``converge.json`` and ``settings.json`` into a folder that exists."""
    from matpoint.study.figures import write_study  # noqa: PLC0415 (loads matplotlib)

    write_study(study, folder)
    claim(folder / "table.txt").write_text(study.tables() + "\n", encoding="utf-8")
    write_json(folder / "converge.json", study.json())
    settings = dataclasses.asdict(study.problem)
    settings.pop("cells")
    write_json(
        folder / "settings.json",
        {
            "problem": study.problem.name, **settings, "end": study.problem.end,
            "methods": list(study.entries), "matpoint": __version__, "python": platform.python_version(),
        },
    )  # fmt: skip

"""Case files: TOML tables checked by a schema, and what is made of them."""

from __future__ import annotations

from matpoint.case.build import build_forecast, build_simulation, make_problem
from matpoint.case.load import Case, bundled_cases, load
from matpoint.case.schema import CaseTable
from matpoint.case.writers import build_writers, planned

__all__ = [
    "Case",
    "CaseTable",
    "build_forecast",
    "build_simulation",
    "build_writers",
    "bundled_cases",
    "load",
    "make_problem",
    "planned",
]

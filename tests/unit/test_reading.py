"""What is printed of the IMLS paper: one fit, in tables and in text."""

from __future__ import annotations

import pytest

from matpoint.problems.errors_track import NORMS
from matpoint.reproduce.imls import _rows
from matpoint.reproduce.imls_reading import reading, resolved
from matpoint.study.worker import entry

METHODS = (
    "mpm",
    "cpdi1",
    "cpdi2",
    "mls",
    "imls",
    "spline-imls",
    "imls-as-coded",
    "imls-as-printed",
    "mls-raw",
)


@pytest.fixture
def found():
    """Errors of second order from 16 cells on; 8 cells are far off that line."""
    errors = {8: 5.0, 16: 4.0, 32: 1.0, 64: 0.25}
    return {name: [entry(n, dict.fromkeys(NORMS, e)) for n, e in errors.items()] for name in METHODS}


def test_tables_and_text_fit_the_same_cells(found):
    assert [e["cells"] for e in resolved(found["imls"])] == [16, 32, 64]
    assert all(row.endswith("| 2.00 |") for row in _rows(found, "velocity"))
    text = "\n".join(reading(found))
    assert text.count("fitted 2.00") + text.count("fitted\n 2.00") == 4

    assert "in the tables, are from 16 cells on" in text

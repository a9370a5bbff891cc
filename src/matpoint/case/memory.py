"""What a case needs of the machine's memory, known before anything large is made."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from matpoint.body import Body
from matpoint.case.load import Case
from matpoint.case.writers import build_writers
from matpoint.footprint import Forecast
from matpoint.forecast import forecast
from matpoint.grid import Grid
from matpoint.interpolation.contract import Interpolation
from matpoint.scheme import Scheme


def forecast_run(
    case: Case, grid: Grid, bodies: Sequence[Body], interpolation: Interpolation, scheme: Scheme
) -> Forecast:
    """Return the memory that a case needs, what writing its results takes included."""
    writers = [w for w in build_writers(case, Path()) if hasattr(w, "buffer")]
    return forecast(grid, bodies, interpolation, scheme, writers)  # type: ignore[arg-type]

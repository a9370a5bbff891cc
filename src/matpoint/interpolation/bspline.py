"""B-splines of degree 2 and 3 with open knots at the grid's faces (Steffen, Kirby, Berzins 2008)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from matpoint.errors import InputError
from matpoint.grid import Grid
from matpoint.interpolation.box import BoxInterpolation
from matpoint.nodes import Axis, spline_axis


@dataclass(frozen=True)
class BSpline(BoxInterpolation):
    """Smooth splines that reproduce linear fields up to the wall.

    Parameters
    ----------
    degree
        2 (quadratic) or 3 (cubic).
    """

    degree: int = 2
    walls_only: ClassVar[bool] = True
    citation: ClassVar[tuple[str, ...]] = ("sulsky1994", "steffen2008")

    def __post_init__(self) -> None:
        if self.degree not in (2, 3):
            raise InputError(f"BSpline: degree = {self.degree!r}; 2 and 3 are allowed")

    @property
    def name(self) -> str:
        return f"bspline{self.degree}"

    def axis(self, grid: Grid, k: int) -> Axis:
        return spline_axis(grid, k, self.degree)

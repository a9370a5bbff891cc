"""MPM: particles as points, linear hats (Sulsky, Chen and Schreyer 1994)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from matpoint.grid import Grid
from matpoint.interpolation.box import BoxInterpolation
from matpoint.nodes import Axis, hat_axis


@dataclass(frozen=True)
class Linear(BoxInterpolation):
    """Linear hats at the particle's point: the limit l -> 0 of GIMP."""

    citation: ClassVar[tuple[str, ...]] = ("sulsky1994",)

    @property
    def name(self) -> str:
        return "mpm"

    def axis(self, grid: Grid, k: int) -> Axis:
        return hat_axis(grid, k, 0, 0)

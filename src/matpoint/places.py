"""Places where conditions and loads act: grid planes, boundary sets and corners of particle domains."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from matpoint.checks import number
from matpoint.errors import InputError
from matpoint.grid import Grid

_AXES = {"x": 0, "y": 1, "z": 2}


class RegionLike(Protocol):
    """Anything that tells which points it contains."""

    def contains(self, points: np.ndarray) -> np.ndarray:
        """Return a flag for each of the points, shape (n, 3) [m]."""
        ...


@dataclass(frozen=True)
class Plane:
    """A grid plane: the nodes on it and beyond it.

    Parameters
    ----------
    axis
        ``"x"``, ``"y"``, ``"z"`` or 0, 1, 2: the axis normal to the plane.
    at
        Coordinate [m]; it must lie on a line of the grid.
    side
        ``"lower"``: the body lies above the plane; ``"upper"``: below it. None takes the face of
        the grid that is nearer.
    """

    axis: str | int
    at: float
    side: str | None = None

    def __post_init__(self) -> None:
        if self.axis not in (*_AXES, 0, 1, 2) or isinstance(self.axis, bool):
            raise InputError(f'plane: axis = {self.axis!r}; "x", "y", "z" are allowed')
        number("plane: at", self.at)
        if self.side not in (None, "lower", "upper"):
            raise InputError(f'plane: side = {self.side!r}; "lower" and "upper" are allowed')

    @property
    def number(self) -> int:
        """The axis as 0, 1, 2."""
        return _AXES[self.axis] if isinstance(self.axis, str) else self.axis

    def check(self, grid: Grid, walls_only: bool) -> None:
        """Raise InputError if the plane does not lie on a line of the grid."""
        k = self.number
        if k >= grid.dim:
            raise InputError(f"plane: axis {'xyz'[k]} does not exist in {grid.dim}-D")
        cells = (self.at - grid.lower[k]) / grid.cell[k]
        if abs(cells - round(cells)) > 1e-6 or not 0 <= round(cells) <= grid.cells[k]:
            near = grid.lower[k] + min(max(round(cells), 0), grid.cells[k]) * grid.cell[k]
            raise InputError(
                f"plane: {'xyz'[k]} = {self.at:g} is not on a line of the grid; the nearest is {near:g}"
            )
        if walls_only and round(cells) not in (0, grid.cells[k]):
            raise InputError(
                f"plane: {'xyz'[k]} = {self.at:g} lies inside the grid; with B-splines a plane must be a"
                f" face of the grid ({grid.lower[k]:g} or {grid.upper[k]:g}): end the grid there"
            )

    def select(self, grid: Grid, points: np.ndarray) -> np.ndarray:
        """Return a flag for the points [m] on or beyond the plane."""
        k = self.number
        side = self.side
        if side is None:
            side = "lower" if self.at - grid.lower[k] <= grid.upper[k] - self.at else "upper"
        hair = 1e-7 * grid.cell[k]
        x = points[:, k]
        return x <= self.at + hair if side == "lower" else x >= self.at - hair


@dataclass(frozen=True)
class Surface:
    """A boundary set of the particle domains, by its name in the mesh.

    It moves with the material and need not follow the grid: a condition on it makes its vertices degrees
    of freedom of their own. It needs a method whose domains share corners (cpdi2, enriched-cpdi2).

    Parameters
    ----------
    name
        As in ``Domains.sets``, for instance ``"inner"``.
    body
        Name of a body; None takes the set of all bodies, less the faces where two of them touch.
    """

    name: str
    body: str | None = None

    def __post_init__(self) -> None:
        if not isinstance(self.name, str) or not self.name:
            raise InputError(f"surface: name = {self.name!r} must be the name of a boundary set")

    def __str__(self) -> str:
        return f"{self.name!r}" + ("" if self.body is None else f" of body {self.body!r}")


@dataclass(frozen=True)
class Corners:
    """The corners of particle domains that begin in a region; they become degrees of freedom.

    Parameters
    ----------
    region
        Any region [m].
    """

    region: RegionLike


Where = Plane | Surface | Corners | RegionLike

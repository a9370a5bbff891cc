"""Node records on a grid, with the rows of weights that an interpolation puts on each axis."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from matpoint.grid import Grid
from matpoint.kernels.rows import Absent, Cubic, Gimp, Hat, Quadratic
from matpoint.kernels.vector import records


class Axis:
    """One axis of the grid as kernels see it: a row type and the coordinates of its nodes [m]."""

    def __init__(self, row: Any, coordinates: np.ndarray, reach: int) -> None:
        self.row, self.coordinates, self.reach = row, coordinates, reach


def absent_axis() -> Axis:
    """Return an axis that the run does not have: one node, weight 1, gradient 0."""
    return Axis(Absent(1), np.zeros(1), 1)


def hat_axis(grid: Grid, k: int, below: int, above: int) -> Axis:
    """Return linear hats on axis ``k`` with nodes added beyond both ends of the box."""
    h, cells = grid.cell[k], grid.cells[k] + below + above
    origin = grid.lower[k] - below * h
    return Axis(Hat(origin, 1.0 / h, cells), origin + h * np.arange(cells + 1), 2)


def gimp_axis(grid: Grid, k: int, below: int, above: int, reach: int) -> Axis:
    """Return averaged hats on axis ``k``; ``reach`` nodes see a particle."""
    hats = hat_axis(grid, k, below, above)
    return Axis(Gimp(hats.row.origin, hats.row.inverse, (0.0,) * reach), hats.coordinates, reach)


def spline_axis(grid: Grid, k: int, degree: int) -> Axis:
    """Return B-splines of degree 2 or 3 with open knots; nodes are the Greville abscissae.

    With nodes at the means of ``degree`` successive knots the splines reproduce x up to the wall.
    """
    h, cells = grid.cell[k], grid.cells[k]
    knots = np.clip(np.arange(-degree, cells + degree + 1), 0, cells)
    greville = np.array([knots[i + 1 : i + 1 + degree].mean() for i in range(cells + degree)])
    row = (Quadratic if degree == 2 else Cubic)(grid.lower[k], 1.0 / h, cells)
    return Axis(row, grid.lower[k] + h * greville, degree + 1)


class Nodes:
    """Records of all nodes: those of the grid, then enriched vertices.

    Attributes
    ----------
    records : ndarray, shape (grid nodes + extra, 8)
        Momentum (3) [kg m/s], mass [kg], force (3) [N], spare; after the solve velocity (3) [m/s],
        mass, velocity increment (3) [m/s], spare.
    shape : tuple of int
        Grid nodes along the three axes; the last axis is the fastest.
    """

    def __init__(self, axes: Sequence[Axis], extra: int = 0) -> None:
        self._axes = [*axes] + [absent_axis()] * (3 - len(axes))
        self.shape: tuple[int, int, int] = tuple(len(a.coordinates) for a in self._axes)  # type: ignore[assignment]
        self.on_grid = int(np.prod(self.shape))
        self.records = records(self.on_grid + extra)
        self.flat = self.records.reshape(-1)
        # The longest axis makes the most slabs; a slab is wider than any support is long.
        self.slab_axis = int(np.argmax(self.shape))
        self.slab_cells = max(4, 2 * max(a.reach for a in self._axes))

    @property
    def rows(self) -> tuple[Any, Any, Any]:
        """The three row types, as kernels take them."""
        a, b, c = self._axes
        return a.row, b.row, c.row

    @property
    def coordinates(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Node coordinates [m] along the three axes."""
        a, b, c = self._axes
        return a.coordinates, b.coordinates, c.coordinates

    def set_axes(self, axes: Sequence[Axis]) -> None:
        """Put longer or shorter rows on the same nodes (domains that have grown)."""
        self._axes = [*axes] + [absent_axis()] * (3 - len(axes))
        self.slab_cells = max(4, 2 * max(a.reach for a in self._axes))

    def positions(self) -> np.ndarray:
        """Return the positions of the grid's nodes [m], shape (grid nodes, 3)."""
        mesh = np.meshgrid(*self.coordinates, indexing="ij")
        return np.stack([m.ravel() for m in mesh], axis=1)

    def clear(self) -> None:
        """Empty all records before a transfer."""
        self.records.fill(0.0)

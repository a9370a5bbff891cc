"""Node records on a grid, with the rows of weights that an interpolation puts on each axis."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from matpoint.grid import Grid
from matpoint.kernels.nodes import clear
from matpoint.kernels.rows import Absent, Cubic, EqualGimp, Gimp, Hat, Quadratic
from matpoint.kernels.vector import records
from matpoint.threads import Team

_LIGHT = 32  # nodes that are as much work as one particle


class Axis:
    """One axis of the grid as kernels see it.

    Attributes
    ----------
    row
        Its row type.
    coordinates : ndarray
        Of its nodes [m].
    reach : int
        How many nodes a point sees.
    slab : int
        Cells of the thinnest slab such that every second one shares no node: if a point in cell c writes to
        nodes from c - a to c + b, weights of zero included, it is a + b.
    """

    def __init__(self, row: Any, coordinates: np.ndarray, reach: int, slab: int) -> None:
        self.row, self.coordinates, self.reach, self.slab = row, coordinates, reach, slab


def absent_axis() -> Axis:
    """Return an axis that the run does not have: one node, weight 1, gradient 0."""
    return Axis(Absent(1), np.zeros(1), 1, 1)


def hat_axis(grid: Grid, k: int, below: int, above: int) -> Axis:
    """Return linear hats on axis ``k`` with nodes added beyond both ends of the box."""
    h, cells = grid.cell[k], grid.cells[k] + below + above
    origin = grid.lower[k] - below * h
    return Axis(Hat(origin, 1.0 / h, cells), origin + h * np.arange(cells + 1), 2, 1)


def gimp_axis(grid: Grid, k: int, below: int, above: int, reach: int, half: float | None = None) -> Axis:
    """Return averaged hats on axis ``k``; ``reach`` nodes see a particle.

    ``half`` [m] is the half-length of all boxes if they are of one size.
    """
    hats = hat_axis(grid, k, below, above)
    origin, inverse, zeros = hats.row.origin, hats.row.inverse, (0.0,) * reach
    row = Gimp(origin, inverse, zeros)
    if half is not None:
        row = EqualGimp(origin, inverse, half * inverse, 0.5 / (half * inverse), zeros)
    # Boxes of up to reach - 2 cells, and a hair, begin less than reach / 2 cells below their centre, and the
    # row of the shortest reaches reach - 1 nodes above it.
    return Axis(row, hats.coordinates, reach, reach - 1 + reach // 2)


def spline_axis(grid: Grid, k: int, degree: int) -> Axis:
    """Return B-splines of degree 2 or 3 with open knots; nodes are the Greville abscissae.

    With nodes at the means of ``degree`` successive knots the splines reproduce x up to the wall.
    """
    h, cells = grid.cell[k], grid.cells[k]
    knots = np.clip(np.arange(-degree, cells + degree + 1), 0, cells)
    greville = np.array([knots[i + 1 : i + 1 + degree].mean() for i in range(cells + degree)])
    row = (Quadratic if degree == 2 else Cubic)(grid.lower[k], 1.0 / h, cells)
    return Axis(row, grid.lower[k] + h * greville, degree + 1, degree)


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
        self.first: tuple[int, int, int] = (0, 0, 0)  # of the active block, and one past its end
        self.last = self.first

    @property
    def extra(self) -> int:
        """How many are no part of the grid: enriched vertices."""
        return len(self.records) - self.on_grid

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

    def positions(self) -> np.ndarray:
        """Return the positions of the grid's nodes [m], shape (grid nodes, 3)."""
        mesh = np.meshgrid(*self.coordinates, indexing="ij")
        return np.stack([m.ravel() for m in mesh], axis=1)

    @property
    def reach(self) -> tuple[int, int, int]:
        """How many nodes a point sees along each axis."""
        a, b, c = self._axes
        return a.reach, b.reach, c.reach

    @property
    def slabs(self) -> tuple[int, int, int]:
        """How many cells thick slabs across each axis are."""
        a, b, c = self._axes
        return a.slab, b.slab, c.slab

    def set_slabs(self, cells: Sequence[int]) -> None:
        """Make slabs so many cells thick across each of the run's axes."""
        for axis, thickness in zip(self._axes, cells, strict=False):
            axis.slab = thickness

    def cells_of(self, low: np.ndarray, high: np.ndarray) -> list[tuple[int, int]]:
        """Return first and last cell along each axis of a box between two corners [m], within the grid."""
        found = []
        for axis, a, b in zip(self._axes, low.tolist(), high.tolist(), strict=True):
            row, last = axis.row, len(axis.coordinates) - 1
            if isinstance(row, Absent):
                found.append((0, 0))
                continue
            ends = (math.floor((x - row.origin) * row.inverse) for x in (a, b))
            found.append(tuple(min(max(cell, 0), last) for cell in ends))
        return found

    def active_within(self, low: np.ndarray, high: np.ndarray) -> None:
        """Work only on nodes that points in a box [m] can see; the others are empty, and cost nothing.

        Parameters
        ----------
        low, high
            Its corners, (3,) each.
        """
        cells = list(zip(self.cells_of(low, high), self.reach, self.shape, strict=True))
        first = tuple(max(a - reach // 2, 0) for (a, _), reach, _ in cells)
        last = tuple(min(b + reach, count) for (_, b), reach, count in cells)
        if (first, last) != (self.first, self.last):
            clear(self.flat, self.first[0], self.last[0], *self.shape[1:], self.first, self.last)
            self.first, self.last = first, last  # type: ignore[assignment]

    def planes(self, team: Team, call: Callable[[int, int], Any]) -> None:
        """Call ``call(start, stop)`` on pieces of the active nodes' planes across the first axis."""
        i, j, k = (b - a for a, b in zip(self.first, self.last, strict=True))
        first = self.first[0]
        team.split(i, lambda a, b: call(first + a, first + b), each=-(-j * k // _LIGHT))

    def each(self, team: Team, call: Callable[..., Any]) -> None:
        """Call ``call(start, stop, ny, nz, first, last)`` on the active nodes, and on those off the grid.

        Those are planes start:stop of a grid, each of ``ny`` by ``nz`` nodes, within the block from ``first``
        to ``last``.
        """
        ny, nz = self.shape[1:]
        self.planes(team, lambda a, b: call(a, b, ny, nz, self.first, self.last))
        if self.extra:
            call(0, 1, 1, 1, (0, 0, self.on_grid), (1, 1, len(self.records)))

    def clear(self, team: Team) -> None:
        """Empty the active records before a transfer."""
        self.each(team, lambda *some: clear(self.flat, *some))

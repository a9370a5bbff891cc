"""Particles by cell, and the cells that they fill, within a block around the body."""

from __future__ import annotations

import numpy as np

from matpoint.grid import Grid
from matpoint.kernels import cells as kernels
from matpoint.particles import Particles
from matpoint.sorting import sort_by_cell
from matpoint.threads import Team

FULL = 0.75  # filled share that makes a cell whole; beside a free surface a full cell has 7/8 an axis
_MARGIN = 2  # cells: a particle adds to the cells beside its own; the next are empty


def room(array: np.ndarray, count: int) -> np.ndarray:
    """Return the array if it has at least ``count`` entries, else a longer one that begins with them."""
    if len(array) >= count:
        return array
    longer = np.zeros((count + count // 8, *array.shape[1:]), array.dtype)
    longer[: len(array)] = array
    return longer


class CellList:
    """Particles by cell, and how much of each cell they fill.

    Cells are numbered within a block that holds all particles: what lies beyond costs nothing.

    Attributes
    ----------
    origin, size, inverse : ndarray, shape (3,)
        Of the grid; missing axes have one cell of size 1 and inverse 0.
    first, cells : ndarray of int64, shape (3,)
        First cell of the block along each axis, and how many there are.
    cell : ndarray, shape (n,)
        The cell of each particle.
    pointer, order
        Particles of cell c are ``order[pointer[c]:pointer[c + 1]]``.
    filled : ndarray
        Share of each cell that is filled [-].
    whole : ndarray of uint8
        Cells that the body fills.
    """

    def __init__(self, grid: Grid, team: Team, count: int) -> None:
        self._team = team
        absent = 3 - grid.dim
        self.origin = np.array([*grid.lower, *(0.0,) * absent])
        self.size = np.array([*grid.cell, *(1.0,) * absent])
        self.inverse = np.array([*(1.0 / h for h in grid.cell), *(0.0,) * absent])
        self._all = np.array([*grid.cells, *(1,) * absent])
        self.first, self.cells = np.zeros(3, dtype=np.int64), self._all.copy()
        self.cell = np.zeros(count, dtype=np.int32)
        self.order = self.cell.copy()
        self._filled, self._whole = np.zeros(0), np.zeros(0, dtype=np.uint8)
        self._cut = np.zeros(0, dtype=np.int64)

    def renew(self, particles: Particles, low: np.ndarray, high: np.ndarray) -> None:
        """Sort the particles again, where they are now, within a box [m]."""
        x = particles.position
        corners = (((c - self.origin) * self.inverse).astype(np.int64) for c in (low, high))
        least, most = (np.clip(c, 0, self._all - 1) for c in corners)
        self.first = np.maximum(least - _MARGIN, 0)
        self.cells = np.minimum(most + _MARGIN, self._all - 1) - self.first + 1
        self.pointer = sort_by_cell(
            self._team, x, self.origin, self.inverse, self.first, self.cells, self.cell, self.order
        )
        self._fill(particles)

    def _fill(self, particles: Particles) -> None:
        count = int(self.cells.prod())
        self._filled, self._whole = room(self._filled, count), room(self._whole, count)
        self.filled, self.whole = self._filled[:count], self._whole[:count]
        self.filled.fill(0.0)
        slab = 2 * int(self.cells[1] * self.cells[2])
        pointer = np.append(self.pointer[:-1:slab], self.pointer[-1])
        self._team.coloured(
            pointer,
            lambda slabs, a, b: kernels.fill_cells(
                particles.position, particles.volume, *self.arguments, slabs, a, b, pointer, self.order,
                self.filled,
            ),
        )  # fmt: skip

    def mark_whole(self, surrounded: bool) -> None:
        """Flag the cells that the body fills; if ``surrounded``, it must fill all around them too.

        Beside a free surface a fit has particles on one side only, and to reach beyond them is to
        extrapolate: such cells are left to their particles.
        """
        reach = ((self.inverse > 0.0) & surrounded).astype(np.int64)
        kernels.mark_whole(self.filled, FULL, self.cells, reach, self.whole)

    def list_cut(self) -> np.ndarray:
        """Return the particles of cells that are not whole, in order of cell, until the next call."""
        count = kernels.list_cut(self.whole, self.pointer, self.order, self._cut[:0])
        self._cut = room(self._cut, count)
        kernels.list_cut(self.whole, self.pointer, self.order, self._cut)
        return self._cut[:count]

    @property
    def arguments(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Origin, inverse, first and cells, as kernels take them."""
        return self.origin, self.inverse, self.first, self.cells

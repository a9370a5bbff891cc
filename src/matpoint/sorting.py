"""Counting sorts by slab and by cell, in parallel; the order is the same for any number of threads."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from matpoint.grid import Grid
from matpoint.kernels import EVERY_POINT
from matpoint.kernels.locate import cell_keys, place_by_key, slab_keys, survey
from matpoint.nodes import Nodes
from matpoint.threads import Team

_MOST_PIECES = 16  # each has counts of its own

# Finds the keys of points start:stop and counts them.
_Keys = Callable[[int, int, np.ndarray], object]


def box_of(
    team: Team, x: np.ndarray, lower: np.ndarray, upper: np.ndarray
) -> tuple[int, np.ndarray, np.ndarray]:
    """Return the first of points (n, 3) [m] outside two corners, or -1, and the corners of their own box."""
    pieces = team.pieces(len(x))
    low, high = np.empty((len(pieces), 3)), np.empty((len(pieces), 3))
    found = team.map(lambda k, a, b: survey(x, a, b, lower, upper, low[k], high[k]), pieces)
    lost = [p for p in found if p >= 0]
    return min(lost, default=-1), low.min(axis=0), high.max(axis=0)


def _sort(
    team: Team, keys: int, find: _Keys, points: np.ndarray, key: np.ndarray, order: np.ndarray
) -> np.ndarray:
    """Put points in the stable order of their keys; return where each key's begin, and the end."""
    pieces = team.pieces(len(order), min(team.threads, _MOST_PIECES))
    counts = np.empty((len(pieces), keys), dtype=np.int64)
    team.map(lambda k, a, b: find(a, b, counts[k]), pieces)
    pointer = np.zeros(keys + 1, dtype=np.int64)
    np.cumsum(counts.sum(axis=0), out=pointer[1:])
    offset = pointer[:-1] + np.cumsum(counts, axis=0) - counts
    team.map(lambda k, a, b: place_by_key(key, points, a, b, offset[k], order), pieces)
    return pointer


class Slabs:
    """Points in order of slab, renewed each step.

    Slabs lie across the axis along which the points reach over most of them, so that threads share
    the work wherever in the grid the points are.

    Parameters
    ----------
    nodes
        What the points scatter to.
    points
        Those that take part, int32; none given are all of ``count``.
    """

    def __init__(self, nodes: Nodes, team: Team, count: int, points: np.ndarray = EVERY_POINT) -> None:
        self._nodes, self._team, self._points = nodes, team, points
        self._count = count if points is EVERY_POINT else len(points)
        self._key = np.zeros(self._count, dtype=np.int32)
        self.order = np.zeros(self._count, dtype=np.int32)
        self.pointer = np.zeros(2, dtype=np.int64)

    def renew(self, x: np.ndarray, low: np.ndarray, high: np.ndarray) -> None:
        """Sort the points again, where they are now [m], (n, 3), within a box."""
        n = self._nodes
        ends = [(a // w, b // w) for (a, b), w in zip(n.cells_of(low, high), n.slabs, strict=True)]
        axis = max(range(3), key=lambda k: ends[k][1] - ends[k][0])
        first, width, row = ends[axis][0], n.slabs[axis], n.rows[axis]
        count = ends[axis][1] - first + 1
        slab_of = np.repeat(np.arange(count, dtype=np.int32), width)
        # Cells are counted from where the row counts them: rounding must not put a point elsewhere.
        origin, inverse = getattr(row, "origin", 0.0), getattr(row, "inverse", 0.0)
        self.pointer = _sort(
            self._team, count,
            lambda a, b, counts: slab_keys(
                x, self._points, a, b, axis, origin, inverse, first * width, slab_of, self._key, counts
            ),
            self._points, self._key, self.order,
        )  # fmt: skip


def sort_by_cell(
    team: Team,
    x: np.ndarray,
    origin: np.ndarray,
    inverse: np.ndarray,
    first: np.ndarray,
    cells: np.ndarray,
    key: np.ndarray,
    order: np.ndarray,
) -> np.ndarray:
    """Sort points (n, 3) [m] by cell, the last axis fastest; return where each cell's begin, and the end.

    Parameters
    ----------
    origin, inverse
        Corner of cell 0 [m], below all points, and one over the size of a cell [1/m], 0 on missing axes.
    first, cells
        The block of cells that counts: its first cell and its size; points outside go to its nearest.
    key, order
        Written: the cell of each point within the block, and the points in order, int32 (n,).
    """
    return _sort(
        team,
        int(cells.prod()),
        lambda a, b, counts: cell_keys(x, a, b, origin, inverse, first, cells, key, counts),
        EVERY_POINT,
        key,
        order,
    )


def cell_order(team: Team, grid: Grid, x: np.ndarray) -> np.ndarray | None:
    """Return the stable order of points (n, 3) [m] by cell, the last axis fastest; None if they are in it."""
    d = grid.dim
    size, corner, most = np.full(3, np.inf), np.zeros(3), np.zeros(3, dtype=np.int64)
    # One cell more on each side, for what lies a little outside; only cells that hold points are counted.
    size[:d], most[:d] = grid.cell, np.array(grid.cells) + 1
    corner[:d] = np.array(grid.lower) - grid.cell
    inverse = 1.0 / size
    first, last = (np.clip(((c - corner) * inverse).astype(np.int64), 0, most) for c in (x.min(0), x.max(0)))
    key, order = np.empty(len(x), dtype=np.int32), np.empty(len(x), dtype=np.int32)
    sort_by_cell(team, x, corner, inverse, first, last - first + 1, key, order)
    return None if (key[1:] >= key[:-1]).all() else order

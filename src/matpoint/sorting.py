"""Counting sorts by slab and by cell, in parallel; the order is the same for any number of threads."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from matpoint.grid import Grid
from matpoint.kernels import EVERY_POINT
from matpoint.kernels.locate import cell_keys, place_by_key, slab_keys, survey
from matpoint.nodes import Nodes
from matpoint.threads import Team, lowest

_WORTH_IT = 100_000  # points of a sort, of 1 to 3 ns each: fewer are sorted before a helper is awake
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
    return lowest(found), low.min(axis=0), high.max(axis=0)


def _pieces(team: Team, count: int) -> list[tuple[int, int]]:
    """Cut a sort into no more pieces than threads: they are over before one could help another out."""
    return team.pieces(count, min(team.threads, _MOST_PIECES if count >= _WORTH_IT else 1))


class _Counting:
    """A counting sort in pieces: ``count`` them all, then ``place`` the points."""

    def __init__(
        self, team: Team, points: np.ndarray, key: np.ndarray, pieces: list[tuple[int, int]]
    ) -> None:
        self._team, self._points, self._key, self.pieces = team, points, key, pieces

    def count(self, keys: int, find: _Keys) -> None:
        """Find keys, of which there are so many, and count them."""
        self.begin(keys)
        self._team.map(lambda k, a, b: find(a, b, self.counts[k]), self.pieces)

    def begin(self, keys: int) -> None:
        """Make room for the counts of each piece."""
        self.counts = np.empty((len(self.pieces), keys), dtype=np.int64)

    def place(self, order: np.ndarray) -> np.ndarray:
        """Put points in the stable order of their keys; return where each key's begin, and the end."""
        keys = self.counts.shape[1]
        pointer = np.zeros(keys + 1, dtype=np.int64)
        np.cumsum(self.counts.sum(axis=0), out=pointer[1:])
        offset = pointer[:-1] + np.cumsum(self.counts, axis=0) - self.counts
        self._team.map(
            lambda k, a, b: place_by_key(self._key, self._points, a, b, offset[k], order), self.pieces
        )
        return pointer


class _Layout(NamedTuple):
    """Slabs across an axis: ``slabs`` of them, ``width`` cells thick, from cell ``first`` on."""

    axis: int
    first: int
    width: int
    slabs: int


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
        taken = count if points is EVERY_POINT else len(points)
        self._key = np.zeros(taken, dtype=np.int32)
        self.order = np.zeros(taken, dtype=np.int32)
        self.pointer = np.zeros(2, dtype=np.int64)
        self._layout: _Layout | None = None  # of the last time
        self._counted: tuple[_Layout, _Counting] | None = None

    def survey(
        self, x: np.ndarray, lower: np.ndarray, upper: np.ndarray
    ) -> tuple[int, np.ndarray, np.ndarray]:
        """As :func:`box_of`, before :meth:`renew` sorts the points, or the chosen ones, which then ascend.

        While they are in the processor's cache they are put into the slabs of the last time. As long as these
        serve, to renew them is half done.
        """
        layout = self._layout
        if layout is None:
            return box_of(self._team, x, lower, upper)
        whole = own = _pieces(self._team, len(x))
        if self._points is not EVERY_POINT:  # those of them in each piece
            own = list(pairwise([0, *np.searchsorted(self._points, [b for _, b in whole]).tolist()]))
        sort = _Counting(self._team, self._points, self._key, own)
        sort.begin(layout.slabs)
        keys = self._keys(x, layout)
        boxes = np.empty((2, len(whole), 3))

        def piece(k: int, a: int, b: int) -> int:
            lost = survey(x, a, b, lower, upper, boxes[0, k], boxes[1, k])
            if lost < 0:
                keys(*own[k], sort.counts[k])
            return lost

        lost = lowest(self._team.map(piece, whole))
        self._counted = None if lost >= 0 else (layout, sort)
        return lost, boxes[0].min(axis=0), boxes[1].max(axis=0)

    def renew(self, x: np.ndarray, low: np.ndarray, high: np.ndarray) -> None:
        """Sort the points again, where they are now [m], (n, 3), within a box."""
        n, counted = self._nodes, self._counted
        self._counted = None
        ends = [(a // w, b // w) for (a, b), w in zip(n.cells_of(low, high), n.slabs, strict=True)]
        axis = max(range(3), key=lambda k: ends[k][1] - ends[k][0])
        (first, last), width = ends[axis], n.slabs[axis]
        layout = self._layout = _Layout(axis, first * width, width, last - first + 1)
        if counted is None or counted[0] != layout:
            pieces = _pieces(self._team, len(self._key))
            sort = _Counting(self._team, self._points, self._key, pieces)
            sort.count(layout.slabs, self._keys(x, layout))
        else:
            sort = counted[1]
        self.pointer = sort.place(self.order)

    def _keys(self, x: np.ndarray, layout: _Layout) -> _Keys:
        """Return what finds and counts the slabs of points."""
        axis, first, width, slabs = layout
        row, slab_of = self._nodes.rows[axis], np.repeat(np.arange(slabs, dtype=np.int32), width)
        # Cells are counted from where the row counts them: rounding must not put a point elsewhere.
        origin, inverse = getattr(row, "origin", 0.0), getattr(row, "inverse", 0.0)
        return lambda a, b, counts: slab_keys(
            x, self._points, a, b, axis, origin, inverse, first, slab_of, self._key, counts
        )


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
    sort = _Counting(team, EVERY_POINT, key, _pieces(team, len(key)))
    sort.count(
        int(cells.prod()),
        lambda a, b, counts: cell_keys(x, a, b, origin, inverse, first, cells, key, counts),
    )
    return sort.place(order)


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

"""Cells that a body fills: their share, the Gauss points in them, and the particles of all others.

Cells are those of a block: ``first`` is its first cell along the three axes, ``cells`` its size; they are
numbered within it with the last axis fastest. ``origin`` is the grid's corner [m], ``inverse`` one over the
size of a cell [1/m], 0 on missing axes, which have one cell.
"""

from __future__ import annotations

import numpy as np

from matpoint.jit import device, kernel


@device
def _between(x, origin, inverse, first, cells):
    """The two cells of the block whose centres a coordinate lies between, and the upper one's share.

    What would go beyond the grid stays in the last cell, as if the wall were a mirror.
    """
    if inverse == 0.0:
        return 0, 0, 0.0
    r = (x - origin) * inverse - 0.5
    below = int(np.floor(r))
    upper = r - below
    below -= first
    return min(max(below, 0), cells - 1), min(max(below + 1, 0), cells - 1), upper


@device
def _add_line(filled, row, lower, upper, amount, share):
    """Split an amount between two cells of one line along the last axis."""
    filled[row + lower] += amount * (1.0 - share)
    filled[row + upper] += amount * share


@kernel
def fill_cells(
    x, volume, origin, inverse, first, cells, slabs, start, stop, pointer, order, filled
):  # fmt: skip
    """How much of each cell is filled [-]: particles' volumes spread by hats around the cells' centres.

    Of the particles of slabs[start:stop], in order of cell: slabs two cells thick, two apart, share no cell.
    """
    scale = 1.0
    for a in range(3):
        scale *= inverse[a] if inverse[a] > 0.0 else 1.0
    for q in range(start, stop):
        for r in range(pointer[slabs[q]], pointer[slabs[q] + 1]):
            p = order[r]
            i0, i1, u = _between(x[p, 0], origin[0], inverse[0], first[0], cells[0])
            j0, j1, v = _between(x[p, 1], origin[1], inverse[1], first[1], cells[1])
            k0, k1, w = _between(x[p, 2], origin[2], inverse[2], first[2], cells[2])
            share = scale * volume[p]
            _add_line(filled, (i0 * cells[1] + j0) * cells[2], k0, k1, share * (1.0 - u) * (1.0 - v), w)
            _add_line(filled, (i0 * cells[1] + j1) * cells[2], k0, k1, share * (1.0 - u) * v, w)
            _add_line(filled, (i1 * cells[1] + j0) * cells[2], k0, k1, share * u * (1.0 - v), w)
            _add_line(filled, (i1 * cells[1] + j1) * cells[2], k0, k1, share * u * v, w)


@kernel
def mark_whole(filled, full, cells, reach, whole):
    """Flag the cells that are filled to ``full``, and so are all up to ``reach`` (3) cells around them.

    The block has an empty margin wherever the grid goes on, so that nothing beyond it must be asked.
    """
    for c in range(whole.shape[0]):
        whole[c] = 1
    for c in range(whole.shape[0]):
        if filled[c] >= full:
            continue
        i, j, k = c // (cells[1] * cells[2]), (c // cells[2]) % cells[1], c % cells[2]
        for a in range(max(i - reach[0], 0), min(i + reach[0] + 1, cells[0])):
            for b in range(max(j - reach[1], 0), min(j + reach[1] + 1, cells[1])):
                row = (a * cells[1] + b) * cells[2]
                for d in range(max(k - reach[2], 0), min(k + reach[2] + 1, cells[2])):
                    whole[row + d] = 0


@kernel
def list_whole(whole, first, cells, chosen, low, high):
    """List the whole cells; return how many. ``low``, ``high`` (3): the least and greatest, in the grid."""
    n = 0
    for a in range(3):
        low[a], high[a] = first[a] + cells[a], first[a] - 1
    for i in range(cells[0]):
        for j in range(cells[1]):
            for k in range(cells[2]):
                c = (i * cells[1] + j) * cells[2] + k
                if whole[c] > 0:
                    chosen[n] = c
                    n += 1
                    low[0], high[0] = min(low[0], first[0] + i), max(high[0], first[0] + i)
                    low[1], high[1] = min(low[1], first[1] + j), max(high[1], first[1] + j)
                    low[2], high[2] = min(low[2], first[2] + k), max(high[2], first[2] + k)
    return n


@kernel
def list_cut(whole, pointer, order, cut):
    """List the particles of cells that are not whole, cell by cell; return how many.

    An empty ``cut`` is left as it is: they are counted only.
    """
    n = 0
    for c in range(whole.shape[0]):
        if whole[c] == 0:
            for q in range(pointer[c], pointer[c + 1]):
                if cut.shape[0] > 0:
                    cut[n] = order[q]
                n += 1
    return n


@kernel
def gauss_points(start, stop, chosen, unit, origin, size, first, cells, position):
    """Positions [m] of the Gauss points of chosen[start:stop]; ``unit`` are those of a cell of size 1."""
    points = unit.shape[0]
    for q in range(start, stop):
        c = chosen[q]
        i, j, k = c // (cells[1] * cells[2]), (c // cells[2]) % cells[1], c % cells[2]
        for g in range(points):
            at = q * points + g
            position[at, 0] = origin[0] + (first[0] + i + unit[g, 0]) * size[0]
            position[at, 1] = origin[1] + (first[1] + j + unit[g, 1]) * size[1]
            position[at, 2] = origin[2] + (first[2] + k + unit[g, 2]) * size[2]

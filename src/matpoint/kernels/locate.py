"""Where points are: refusal of those outside, and counting sorts by slab or by cell.

A scatter runs over slabs of cells along one axis. Slabs of one colour (even or odd) touch no
node in common, so they may run on any thread in any order; inside a slab, points keep their
order. Each node therefore sums its contributions in one fixed order, whatever the threads.

A sort is made in pieces: each counts its keys, then puts its points where those of the same key in
earlier pieces end. The result is the stable order, whatever the pieces.
"""

from __future__ import annotations

from math import inf

import numpy as np

from matpoint.jit import kernel


@kernel
def survey(x, start, stop, lower, upper, low, high):
    """Return the first point of x[start:stop] that is not in [lower, upper] (or not a number), or -1.

    ``low`` and ``high`` take the corners of the box around them all.
    """
    a0, a1, a2, b0, b1, b2, numbers = inf, inf, inf, -inf, -inf, -inf, 0.0
    for p in range(start, stop):
        x0, x1, x2 = x[p, 0], x[p, 1], x[p, 2]
        a0, b0 = x0 if x0 < a0 else a0, x0 if x0 > b0 else b0
        a1, b1 = x1 if x1 < a1 else a1, x1 if x1 > b1 else b1
        a2, b2 = x2 if x2 < a2 else a2, x2 if x2 > b2 else b2
        numbers += 0.0 * (x0 + x1 + x2)
    low[0], low[1], low[2], high[0], high[1], high[2] = a0, a1, a2, b0, b1, b2
    inside = numbers == 0.0  # NaN if a coordinate is none
    for a in range(3):
        inside = inside and lower[a] <= low[a] and high[a] <= upper[a]
    if not inside:
        for p in range(start, stop):
            for a in range(3):
                if not (lower[a] <= x[p, a] <= upper[a]):
                    return p
    return -1


@kernel
def find_stretched(x, half, start, stop, lower, upper):
    """Return the first particle whose box x -+ half leaves [lower, upper], or -1."""
    for p in range(start, stop):
        for a in range(3):
            if not (lower[a] <= x[p, a] - half[p, a] and x[p, a] + half[p, a] <= upper[a]):
                return p
    return -1


@kernel
def slab_keys(x, points, start, stop, axis, origin, inverse, first, slab_of, key, counts):
    """Slab of each of points[start:stop] (all if there is no list), by a table of cells; count them.

    ``origin`` is the corner of cell 0 [m], ``inverse`` one over the size of a cell [1/m], ``first`` the table's
    first cell.
    """
    for s in range(counts.shape[0]):
        counts[s] = 0
    last, before, run = slab_of.shape[0] - 1, np.int32(0), 0
    for r in range(start, stop):
        p = points[r] if points.shape[0] > 0 else r
        s = slab_of[min(max(int((x[p, axis] - origin) * inverse) - first, 0), last)]
        key[r] = s
        if s != before:  # neighbours are mostly of one slab: count runs of them
            counts[before] += run
            before, run = s, 0
        run += 1
    counts[before] += run


@kernel
def cell_keys(x, start, stop, origin, inverse, first, cells, key, counts):
    """Cell of each of x[start:stop] within a block of ``cells`` from ``first``, the last axis fastest; count."""
    for c in range(counts.shape[0]):
        counts[c] = 0
    for p in range(start, stop):
        number = 0
        for a in range(3):
            k = int((x[p, a] - origin[a]) * inverse[a]) - first[a]
            number = number * cells[a] + min(max(k, 0), cells[a] - 1)
        key[p] = number
        counts[number] += 1


@kernel
def place_by_key(key, points, start, stop, offset, order):
    """Put points[start:stop] (or their numbers) where their keys' turn comes; ``offset`` is moved on."""
    for r in range(start, stop):
        order[offset[key[r]]] = points[r] if points.shape[0] > 0 else r
        offset[key[r]] += 1

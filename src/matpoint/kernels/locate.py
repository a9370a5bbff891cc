"""Where points are: refusal of those outside, slabs of cells, and order by slab.

A scatter runs over slabs of cells along one axis. Slabs of one colour (even or odd) touch no
node in common, so they may run on any thread in any order; inside a slab, points keep their
order. Each node therefore sums its contributions in one fixed order, whatever the threads.
"""

from __future__ import annotations

from matpoint.jit import kernel


@kernel
def find_outside(x, start, stop, lower, upper):
    """Return the first point of x[start:stop] that is not in [lower, upper] (or not a number), or -1."""
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
def order_by_slab(x, axis, origin, inverse, points, slab, pointer, order):
    """Stable counting sort of ``points`` by slab of cells; pointer[s]:pointer[s+1] lists slab s.

    ``inverse`` is one over the slab's width [1/m]; ``slab`` is scratch as long as ``points``.
    """
    slabs = pointer.shape[0] - 1
    for s in range(slabs + 1):
        pointer[s] = 0
    for r in range(points.shape[0]):
        s = min(max(int((x[points[r], axis] - origin) * inverse), 0), slabs - 1)
        slab[r] = s
        pointer[s + 1] += 1
    for s in range(slabs):
        pointer[s + 1] += pointer[s]
    for r in range(points.shape[0]):
        s = slab[r]
        order[pointer[s]] = points[r]
        pointer[s] += 1
    for s in range(slabs, 0, -1):
        pointer[s] = pointer[s - 1]
    pointer[0] = 0

"""Conjugate gradients with a mass that couples the nodes, two velocities a node at once.

Vectors are flat records: the velocity at the start of the step in lanes 0 to 2, the one at its end in lanes 4
to 6; every lane is a system of its own. Loops run over planes start:stop of nodes within the block from
``first`` to ``last``; sums over each plane go to a row of ``sums``, flat, so that they do not depend on the
threads. ``inverse`` is one over the lumped mass of a node [1/kg], 0 without mass: the preconditioner.
"""

from __future__ import annotations

from matpoint.jit import kernel
from matpoint.kernels.vector import fma, load, minus, pack, plus, scale, splat, store, times, zero


@kernel
def begin(start, stop, ny, nz, first, last, sums, nodes, dt, rate, right, inverse, lumped, u):
    """Right sides M v = p and M v+ = p + dt (f - rate p); the first guess divides by the lumped mass."""
    for i in range(start, stop):
        total = zero()
        for j in range(first[1], last[1]):
            row = (i * ny + j) * nz
            for n in range(row + first[2], row + last[2]):
                a, m = 8 * n, nodes[8 * n + 3]
                x, y, z = nodes[a], nodes[a + 1], nodes[a + 2]
                fx, fy, fz = nodes[a + 4] - rate * x, nodes[a + 5] - rate * y, nodes[a + 6] - rate * z
                given = pack(x, y, z, 0.0, x + dt * fx, y + dt * fy, z + dt * fz, 0.0)
                inverse[n], lumped[n] = 1.0 / m if m > 0.0 else 0.0, 0.0
                guess = scale(inverse[n], given)
                store(right, a, given)
                store(u, a, guess)
                total = plus(total, times(given, guess))
        store(sums, 8 * (i - first[0]), total)


@kernel
def fill_ones(start, stop, ny, nz, first, last, vector):
    """One in every lane."""
    for i in range(start, stop):
        for j in range(first[1], last[1]):
            row = (i * ny + j) * nz
            for n in range(row + first[2], row + last[2]):
                store(vector, 8 * n, splat(1.0))


@kernel
def lump_rest(start, stop, ny, nz, first, last, nodes, row_sums, lumped):
    """Mass that is not in the rows of the consistent mass, whose sums are in the lanes of ``row_sums``."""
    for i in range(start, stop):
        for j in range(first[1], last[1]):
            row = (i * ny + j) * nz
            for n in range(row + first[2], row + last[2]):
                lumped[n] = max(nodes[8 * n + 3] - row_sums[8 * n], 0.0)


@kernel
def add_lumped(start, stop, ny, nz, first, last, lumped, inverse, source, product):
    """Add the lumped part to a product with the consistent one; where nothing has mass it is zero."""
    for i in range(start, stop):
        for j in range(first[1], last[1]):
            row = (i * ny + j) * nz
            for n in range(row + first[2], row + last[2]):
                value = fma(lumped[n], load(source, 8 * n), load(product, 8 * n))
                store(product, 8 * n, value if inverse[n] > 0.0 else zero())


@kernel
def subtract(start, stop, ny, nz, first, last, right, product, residual):
    """What is left of the right side."""
    for i in range(start, stop):
        for j in range(first[1], last[1]):
            row = (i * ny + j) * nz
            for n in range(8 * (row + first[2]), 8 * (row + last[2]), 8):
                store(residual, n, minus(load(right, n), load(product, n)))


@kernel
def multiply(start, stop, ny, nz, first, last, sums, a, b):
    """Sum a b, lane by lane."""
    for i in range(start, stop):
        total = zero()
        for j in range(first[1], last[1]):
            row = (i * ny + j) * nz
            for n in range(8 * (row + first[2]), 8 * (row + last[2]), 8):
                total = plus(total, times(load(a, n), load(b, n)))
        store(sums, 8 * (i - first[0]), total)


@kernel
def weigh(start, stop, ny, nz, first, last, sums, inverse, residual):
    """Sum r r / m, lane by lane."""
    for i in range(start, stop):
        total = zero()
        for j in range(first[1], last[1]):
            row = (i * ny + j) * nz
            for n in range(row + first[2], row + last[2]):
                r = load(residual, 8 * n)
                total = plus(total, times(scale(inverse[n], r), r))
        store(sums, 8 * (i - first[0]), total)


@kernel
def go(start, stop, ny, nz, first, last, step, direction, product, u, residual):
    """A step along the direction; ``step`` (8) has one for every lane."""
    length = load(step, 0)
    for i in range(start, stop):
        for j in range(first[1], last[1]):
            row = (i * ny + j) * nz
            for n in range(8 * (row + first[2]), 8 * (row + last[2]), 8):
                store(u, n, plus(load(u, n), times(length, load(direction, n))))
                store(residual, n, minus(load(residual, n), times(length, load(product, n))))


@kernel
def turn(start, stop, ny, nz, first, last, inverse, residual, share, direction):
    """The next direction: r / m, and a ``share`` (8) of the last."""
    kept = load(share, 0)
    for i in range(start, stop):
        for j in range(first[1], last[1]):
            row = (i * ny + j) * nz
            for n in range(row + first[2], row + last[2]):
                downhill = scale(inverse[n], load(residual, 8 * n))
                store(direction, 8 * n, plus(downhill, times(kept, load(direction, 8 * n))))


@kernel
def take(start, stop, ny, nz, first, last, u, nodes):
    """Velocity at the end of the step, and its increment, to the records."""
    for i in range(start, stop):
        for j in range(first[1], last[1]):
            row = (i * ny + j) * nz
            for n in range(8 * (row + first[2]), 8 * (row + last[2]), 8):
                for a in range(n, n + 3):
                    nodes[a] = u[a + 4]
                    nodes[a + 4] = u[a + 4] - u[a]

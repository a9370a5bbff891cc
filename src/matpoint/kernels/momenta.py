"""Momenta of reconstructed velocities: sums to compare, and plain averages beside free surfaces."""

from __future__ import annotations

from math import sqrt

from matpoint.jit import kernel, summing_kernel
from matpoint.kernels.spread import spread
from matpoint.kernels.vector import load, pack, plus, store, zero


@kernel
def sum_records(start, stop, ny, nz, first, last, nodes, sums):
    """Sum the records of each plane start:stop of the active nodes into a row of ``sums``, flat."""
    for i in range(start, stop):
        total = zero()
        for j in range(first[1], last[1]):
            begin = (i * ny + j) * nz
            for n in range(begin + first[2], begin + last[2]):
                total = plus(total, load(nodes, 8 * n))
        store(sums, 8 * (i - first[0]), total)


@summing_kernel
def sum_momenta(start, stop, block, mass, v, sums):
    """Sum m v (3) and |m v| [kg m/s] of particles, a row of ``sums`` for each block."""
    for first in range(start, stop, block):
        x, y, z, size = 0.0, 0.0, 0.0, 0.0
        for p in range(first, min(first + block, stop)):
            a, b, c = mass[p] * v[p, 0], mass[p] * v[p, 1], mass[p] * v[p, 2]
            x, y, z, size = x + a, y + b, z + c, size + sqrt(a * a + b * b + c * c)
        at = first // block
        sums[at, 0], sums[at, 1], sums[at, 2], sums[at, 3] = x, y, z, size


@kernel
def averages_to_nodes(
    ax, ay, az, ny, nz, nodes, slabs, start, stop, pointer, order, x, v, mass, cell, whole
):  # fmt: skip
    """Add momentum (3), mass, and the mass of particles in cells that are not whole (S 1, 2)."""
    for q in range(start, stop):
        for r in range(pointer[slabs[q]], pointer[slabs[q] + 1]):
            p = order[r]
            m = mass[p]
            cut = m if whole[cell[p]] == 0 else 0.0
            content = pack(m * v[p, 0], m * v[p, 1], m * v[p, 2], m, cut, 0.0, 0.0, 0.0)
            spread(ax, ay, az, ny, nz, nodes, x, p, content)


@kernel
def take_averages(start, stop, ny, nz, first, last, averages, nodes):
    """Give nodes that see a particle of a cut cell the mean of the velocities around, as MPM does."""
    for i in range(start, stop):
        for j in range(first[1], last[1]):
            begin = (i * ny + j) * nz
            for n in range(8 * (begin + first[2]), 8 * (begin + last[2]), 8):
                if averages[n + 4] > 0.0:
                    share = nodes[n + 3] / averages[n + 3]
                    for a in range(n, n + 3):
                        nodes[a] = share * averages[a]

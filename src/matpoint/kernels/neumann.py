"""Neumann's series on the nodes (Nairn and Hammerquist 2021): its terms, and the way to the next.

Loops run over planes start:stop of nodes within the block from ``first`` to ``last``. ``term`` and ``total``
are velocities [m/s], (records, 3); ``trip`` is a second set of flat records, which goes to the particles and
back in the place of ``nodes``.
"""

from __future__ import annotations

from matpoint.jit import kernel
from matpoint.kernels.vector import pack, store


@kernel
def begin_series(start, stop, ny, nz, first, last, nodes, share, term, total):
    """The first term is v - share dv; the others are yet to be added up."""
    for i in range(start, stop):
        for j in range(first[1], last[1]):
            row = (i * ny + j) * nz
            for n in range(row + first[2], row + last[2]):
                for a in range(3):
                    term[n, a] = nodes[8 * n + a] - share * nodes[8 * n + 4 + a]
                    total[n, a] = 0.0


@kernel
def set_out(start, stop, ny, nz, first, last, nodes, velocity, trip):
    """Nodes of the same masses with another velocity, and no increments."""
    for i in range(start, stop):
        for j in range(first[1], last[1]):
            row = (i * ny + j) * nz
            for n in range(row + first[2], row + last[2]):
                v0, v1, v2, m = velocity[n, 0], velocity[n, 1], velocity[n, 2], nodes[8 * n + 3]
                store(trip, 8 * n, pack(v0, v1, v2, m, 0.0, 0.0, 0.0, 0.0))


@kernel
def lessen(start, stop, ny, nz, first, last, returned, term):
    """(1 - S+ S) v from v and S+ S v, (records, 3)."""
    for i in range(start, stop):
        for j in range(first[1], last[1]):
            row = (i * ny + j) * nz
            for n in range(row + first[2], row + last[2]):
                for a in range(3):
                    term[n, a] -= returned[n, a]


@kernel
def add_term(start, stop, ny, nz, first, last, term, total):
    """Add one more term to the sum."""
    for i in range(start, stop):
        for j in range(first[1], last[1]):
            row = (i * ny + j) * nz
            for n in range(row + first[2], row + last[2]):
                for a in range(3):
                    total[n, a] += term[n, a]


@kernel
def take_sum(start, stop, ny, nz, first, last, total, lane, nodes):
    """Velocity at the end plus the series' terms, to the lanes of velocities (0) or of increments (4)."""
    for i in range(start, stop):
        for j in range(first[1], last[1]):
            row = (i * ny + j) * nz
            for n in range(row + first[2], row + last[2]):
                for a in range(3):
                    nodes[8 * n + lane + a] = nodes[8 * n + a] + total[n, a]

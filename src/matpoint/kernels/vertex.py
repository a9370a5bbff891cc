"""Transfers of the vertex family: particle -> corner -> node, and back.

Index letters: p particle, a vertex, c corner of a particle (``corners[p, c] = a``), n node. The
corner weights are ``weights[p, c] = (R, G_x, G_y, G_z)`` with R = (1/V) int N and
G = (1/V) int grad N over the particle's domain (S 24 and its gradient). Records of vertices have
the layout of node records. An enriched vertex is a node of its own: its record is that node's.
"""

from __future__ import annotations

import numpy as np

from matpoint.jit import device, kernel
from matpoint.kernels.content import contribution, take
from matpoint.kernels.corners import CORNERS
from matpoint.kernels.spread import spread, value_at
from matpoint.kernels.vector import fma, lane, load, store, zero


@kernel
def independent_blocks(corners, vertices, smallest, edges):
    """Cut the particles into runs so that no vertex is shared by runs k and k + 2 or farther apart.

    Even runs may then add to vertices side by side, and odd ones after them. ``edges`` takes where runs
    end, from 0; returns how many it took. Runs have ``smallest`` particles or more; those in order of cell
    have about a layer of cells.
    """
    last = np.zeros(vertices, dtype=np.int32)
    for p in range(corners.shape[0]):
        for c in range(corners.shape[1]):
            if corners[p, c] >= 0:
                last[corners[p, c]] = p
    edges[0], taken, reach, before = 0, 1, -1, -1
    for p in range(corners.shape[0]):
        for c in range(corners.shape[1]):
            if corners[p, c] >= 0:
                reach = max(reach, last[corners[p, c]])
        if p >= before and p + 1 - edges[taken - 1] >= smallest:
            edges[taken], taken, before = p + 1, taken + 1, reach
    if edges[taken - 1] < corners.shape[0]:
        edges[taken], taken = corners.shape[0], taken + 1
    return taken


@kernel
def find_first(edges, corners, kind, seen, first):
    """Bit c of ``first[p]``: no particle adds to corner c of p before p does, even runs before odd ones.

    ``seen`` (vertices,), False throughout, tells afterwards which have any particle.
    """
    for colour in range(2):
        for k in range(colour, edges.shape[0] - 1, 2):
            for p in range(edges[k], edges[k + 1]):
                bits = 0
                for c in range(CORNERS[kind[p]]):
                    if not seen[corners[p, c]]:
                        seen[corners[p, c]] = True
                        bits |= 1 << c
                first[p] = bits


@kernel
def particles_to_vertices(
    runs, start, stop, edges, corners, kind, first, weights, v, mass, volume, stress, body, kinematic, dynamic,
    records,
):  # fmt: skip
    """Sum what particles bring to the records of their corners (S 1, 2, 9, 23).

    The particles are those of runs[start:stop], run k being edges[k]:edges[k + 1]. What a record held before
    is forgotten by the ``first`` that adds to it.
    """
    for q in range(start, stop):
        for p in range(edges[runs[q]], edges[runs[q] + 1]):
            content, pull_x, pull_y, pull_z = contribution(
                p, v, mass, volume, stress, body, kinematic, dynamic
            )
            for c in range(CORNERS[kind[p]]):
                a = 8 * corners[p, c]
                before = zero() if (first[p] >> c) & 1 else load(records, a)
                record = fma(weights[p, c, 1], pull_x, fma(weights[p, c, 0], content, before))
                record = fma(weights[p, c, 3], pull_z, fma(weights[p, c, 2], pull_y, record))
                store(records, a, record)


@kernel
def vertices_to_nodes(ax, ay, az, ny, nz, nodes, slabs, start, stop, pointer, order, x, records):
    """Each vertex hands its record to the nodes of its cell with S_i(x_a) (S 23, 25)."""
    for q in range(start, stop):
        for r in range(pointer[slabs[q]], pointer[slabs[q] + 1]):
            a = order[r]
            spread(ax, ay, az, ny, nz, nodes, x, a, load(records, 8 * a))


@device
def _move(a, value, x, x_next, dt):
    """Corners move with the grid velocity: x_a += dt sum_i S_i(x_a) v_i (S, section 3)."""
    for k in range(3):
        x_next[a, k] = x[a, k] + dt * lane(value, k)


@kernel
def nodes_to_vertices(ax, ay, az, ny, nz, nodes, start, stop, points, x, records, x_next, dt, move):
    """The nodes' velocity and increment at vertices points[start:stop] (S 17), and where they ``move``."""
    for q in range(start, stop):
        a = points[q]
        value = value_at(ax, ay, az, ny, nz, nodes, x, a)
        store(records, 8 * a, value)
        if move:
            _move(a, value, x, x_next, dt)


@kernel
def move_vertices(start, stop, points, records, x, x_next, dt):
    """Move vertices points[start:stop], whose velocities are in their records."""
    for q in range(start, stop):
        a = points[q]
        _move(a, load(records, 8 * a), x, x_next, dt)


@kernel
def vertices_to_particles(
    start, stop, corners, kind, weights, records, v, x, x_next, gradient, dt, flip, move, differentiate
):
    """Velocity and position (S 13, 14) if ``move``, velocity gradient (S 15) if ``differentiate``.

    ``gradient`` is of these particles only.
    """
    for p in range(start, stop):
        value, along_x, along_y, along_z = zero(), zero(), zero(), zero()
        for c in range(CORNERS[kind[p]]):
            record = load(records, 8 * corners[p, c])
            value = fma(weights[p, c, 0], record, value)
            along_x = fma(weights[p, c, 1], record, along_x)
            along_y = fma(weights[p, c, 2], record, along_y)
            along_z = fma(weights[p, c, 3], record, along_z)
        take(
            p, start, value, along_x, along_y, along_z, v, x, x_next, gradient, dt, flip, move, differentiate
        )  # fmt: skip

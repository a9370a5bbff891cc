"""CPDI1's transfers: a parallelepiped that follows F, its corners, their nodes, and back, at once.

Corners c of particle p lie at x_p +- r_1 +- r_2 +- r_3 with r_k = F r_k0 (S 16), and no two particles have one
in common: neither they nor their weights are kept. ``edges[p, k]`` is r_k; those of missing axes have length
1/2, so that V = 8 r_1 . (r_2 x r_3) serves every dimension.
"""

from __future__ import annotations

import numpy as np

from matpoint.jit import device, kernel
from matpoint.kernels.content import contribution, take
from matpoint.kernels.corners import SIGNS, cofactors
from matpoint.kernels.spread import spread, value_at
from matpoint.kernels.vector import fma, load, scale, splat, store_quadruples, store_triples, zero

_SIGN_X, _SIGN_Y, _SIGN_Z = (np.ascontiguousarray(SIGNS[:, k]) for k in range(3))


@device
def _spread(centre, r, s, t):
    """Centre +- r +- s +- t at the eight corners."""
    return fma(t, load(_SIGN_Z, 0), fma(s, load(_SIGN_Y, 0), fma(r, load(_SIGN_X, 0), splat(centre))))


@device
def _corners(p, dim, position, r, corner, weights):
    """Put eight corners into ``corner`` and their R and G (S 18, 19) into ``weights``, both flat.

    The first 2^dim of them count; they do not go along missing axes.
    """
    # Rows of the cofactor matrix are r2 x r3, r3 x r1, r1 x r2.
    e = cofactors(
        r[p, 0, 0], r[p, 0, 1], r[p, 0, 2], r[p, 1, 0], r[p, 1, 1], r[p, 1, 2], r[p, 2, 0], r[p, 2, 1],
        r[p, 2, 2],
    )  # fmt: skip
    two, three = 1.0 if dim > 1 else 0.0, 1.0 if dim > 2 else 0.0
    share = 0.125 if dim > 2 else (0.25 if dim > 1 else 0.5)
    s = share / (r[p, 0, 0] * e[0][0] + r[p, 0, 1] * e[0][1] + r[p, 0, 2] * e[0][2])
    s2, s3 = two * s, three * s
    store_triples(
        corner, 0,
        _spread(position[p, 0], r[p, 0, 0], two * r[p, 1, 0], three * r[p, 2, 0]),
        _spread(position[p, 1], r[p, 0, 1], two * r[p, 1, 1], three * r[p, 2, 1]),
        _spread(position[p, 2], r[p, 0, 2], two * r[p, 1, 2], three * r[p, 2, 2]),
    )  # fmt: skip
    store_quadruples(
        weights, 0, splat(share),
        _spread(0.0, s * e[0][0], s2 * e[1][0], s3 * e[2][0]),
        _spread(0.0, s * e[0][1], s2 * e[1][1], s3 * e[2][1]),
        _spread(0.0, s * e[0][2], s2 * e[1][2], s3 * e[2][2]),
    )  # fmt: skip


@kernel
def parallelepipeds(start, stop, dim, position, edges, x, weights):
    """Corners of parallelepipeds start:stop: corner c of the p-th is x[p * 2^dim + c].

    ``weights`` (n, 2^dim, 4) takes R and G; an empty one takes none.
    """
    count, places, own = 2**dim, np.empty(24), np.empty(32)
    for p in range(start, stop):
        _corners(p, dim, position, edges, places, own)
        for c in range(count):
            for a in range(3):
                x[p * count + c, a] = places[3 * c + a]
            if weights.shape[0] > 0:
                for a in range(4):
                    weights[p, c, a] = own[4 * c + a]


@kernel
def stretch_edges(start, stop, F, edges0, edges, far):
    """r_k = F r_k0 (S 16); ``far`` (3,) [m] takes sum_k |r_k|, the largest distance of a corner along each axis."""
    x, y, z = 0.0, 0.0, 0.0
    for p in range(start, stop):
        for k in range(3):
            e0, e1, e2 = edges0[p, k, 0], edges0[p, k, 1], edges0[p, k, 2]
            for a in range(3):
                edges[p, k, a] = F[p, a, 0] * e0 + F[p, a, 1] * e1 + F[p, a, 2] * e2
        a = abs(edges[p, 0, 0]) + abs(edges[p, 1, 0]) + abs(edges[p, 2, 0])
        b = abs(edges[p, 0, 1]) + abs(edges[p, 1, 1]) + abs(edges[p, 2, 1])
        c = abs(edges[p, 0, 2]) + abs(edges[p, 1, 2]) + abs(edges[p, 2, 2])
        x, y, z = a if a > x else x, b if b > y else y, c if c > z else z
    far[0], far[1], far[2] = x, y, z


@kernel
def particles_to_nodes(
    ax, ay, az, ny, nz, nodes, slabs, start, stop, pointer, order,
    dim, x, edges, v, mass, volume, stress, body, kinematic, dynamic,
):  # fmt: skip
    """Add what the particles of slabs[start:stop] bring to their corners to the nodes (S 1, 2, 9, 23)."""
    count, corner, weights = 2**dim, np.empty((8, 3)), np.empty(32)
    places = corner.reshape(-1)
    for q in range(start, stop):
        for r in range(pointer[slabs[q]], pointer[slabs[q] + 1]):
            p = order[r]
            content, pull_x, pull_y, pull_z = contribution(
                p, v, mass, volume, stress, body, kinematic, dynamic
            )
            _corners(p, dim, x, edges, places, weights)
            for c in range(count):
                record = fma(weights[4 * c + 1], pull_x, scale(weights[4 * c], content))
                record = fma(weights[4 * c + 3], pull_z, fma(weights[4 * c + 2], pull_y, record))
                spread(ax, ay, az, ny, nz, nodes, corner, c, record)


@kernel
def nodes_to_particles(
    ax, ay, az, ny, nz, nodes, start, stop,
    dim, x, edges, v, x_next, gradient, dt, flip, move, differentiate,
):  # fmt: skip
    """Velocity and position (S 13, 14) if ``move``, velocity gradient (S 15) if ``differentiate``.

    ``gradient`` is of these particles only.
    """
    count, corner, weights = 2**dim, np.empty((8, 3)), np.empty(32)
    places = corner.reshape(-1)
    for p in range(start, stop):
        _corners(p, dim, x, edges, places, weights)
        value, along_x, along_y, along_z = zero(), zero(), zero(), zero()
        for c in range(count):
            record = value_at(ax, ay, az, ny, nz, nodes, corner, c)
            value = fma(weights[4 * c], record, value)
            along_x = fma(weights[4 * c + 1], record, along_x)
            along_y = fma(weights[4 * c + 2], record, along_y)
            along_z = fma(weights[4 * c + 3], record, along_z)
        take(
            p, start, value, along_x, along_y, along_z, v, x, x_next, gradient, dt, flip, move, differentiate
        )  # fmt: skip

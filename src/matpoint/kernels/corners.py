"""Corner weights R_a = (1/V) int N_a and G_a = (1/V) int grad N_a of a particle's domain.

Kinds are numbered as ``matpoint.domains.Kind``: 0 line, 1 quadrilateral, 2 hexahedron,
3 triangle, 4 tetrahedron; corners are in VTK's order. Source: S 18-24 with the corrections of the
methods page, section 3: the weights are exact, and x_p = sum_a R_a x_a is the domain's centroid.
Each function writes ``weights[p, c] = (R, G_x, G_y, G_z)`` and returns the smallest corner
Jacobian, in units of its own: what counts is that it is <= 0 for a domain that has turned over.
"""

from __future__ import annotations

import numpy as np

from matpoint.jit import device, kernel, set_item

CORNERS = np.array([2, 4, 8, 3, 4])  # by kind
SIGNS = np.array(
    [[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1], [-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]],
    dtype=float,
)
_GAUSS = 1.0 / np.sqrt(3.0)


@device
def _put(weights, p, c, share, gx, gy, gz):
    weights[p, c, 0] = share
    weights[p, c, 1] = gx
    weights[p, c, 2] = gy
    weights[p, c, 3] = gz


@device
def _line(p, corners, x, weights):
    length = x[corners[p, 1], 0] - x[corners[p, 0], 0]
    _put(weights, p, 0, 0.5, -1.0 / length, 0.0, 0.0)
    _put(weights, p, 1, 0.5, 1.0 / length, 0.0, 0.0)
    return length


@device
def _quad(p, corners, x, weights):
    """S 22 for the gradients; exact R by the a, b of the methods page (S 21 is for parallelograms)."""
    i, j, k, m = corners[p, 0], corners[p, 1], corners[p, 2], corners[p, 3]
    x1, x2, x3, x4 = x[i, 0], x[j, 0], x[k, 0], x[m, 0]
    y1, y2, y3, y4 = x[i, 1], x[j, 1], x[k, 1], x[m, 1]
    volume = 0.5 * ((x3 - x1) * (y4 - y2) - (x4 - x2) * (y3 - y1))
    a = (x4 - x1) * (y2 - y3) - (x2 - x3) * (y4 - y1)
    b = (x3 - x4) * (y1 - y2) - (x1 - x2) * (y3 - y4)
    s, t = 1.0 / (24.0 * volume), 0.5 / volume
    _put(weights, p, 0, (6.0 * volume - a - b) * s, (y2 - y4) * t, (x4 - x2) * t, 0.0)
    _put(weights, p, 1, (6.0 * volume - a + b) * s, (y3 - y1) * t, (x1 - x3) * t, 0.0)
    _put(weights, p, 2, (6.0 * volume + a + b) * s, (y4 - y2) * t, (x2 - x4) * t, 0.0)
    _put(weights, p, 3, (6.0 * volume + a - b) * s, (y1 - y3) * t, (x3 - x1) * t, 0.0)
    smallest = (x2 - x1) * (y4 - y1) - (x4 - x1) * (y2 - y1)
    smallest = min(smallest, (x3 - x2) * (y1 - y2) - (x1 - x2) * (y3 - y2))
    smallest = min(smallest, (x4 - x3) * (y2 - y3) - (x2 - x3) * (y4 - y3))
    smallest = min(smallest, (x1 - x4) * (y3 - y4) - (x3 - x4) * (y1 - y4))
    return smallest if volume > 0.0 else min(smallest, volume)


@device
def _triangle(p, corners, x, weights):
    i, j, k = corners[p, 0], corners[p, 1], corners[p, 2]
    double = (x[j, 0] - x[i, 0]) * (x[k, 1] - x[i, 1]) - (x[k, 0] - x[i, 0]) * (x[j, 1] - x[i, 1])
    s = 1.0 / double
    _put(weights, p, 0, 1.0 / 3.0, (x[j, 1] - x[k, 1]) * s, (x[k, 0] - x[j, 0]) * s, 0.0)
    _put(weights, p, 1, 1.0 / 3.0, (x[k, 1] - x[i, 1]) * s, (x[i, 0] - x[k, 0]) * s, 0.0)
    _put(weights, p, 2, 1.0 / 3.0, (x[i, 1] - x[j, 1]) * s, (x[j, 0] - x[i, 0]) * s, 0.0)
    return double


@device
def _cofactors(j00, j01, j02, j10, j11, j12, j20, j21, j22):
    return (
        (j11 * j22 - j12 * j21, j12 * j20 - j10 * j22, j10 * j21 - j11 * j20),
        (j02 * j21 - j01 * j22, j00 * j22 - j02 * j20, j01 * j20 - j00 * j21),
        (j01 * j12 - j02 * j11, j02 * j10 - j00 * j12, j00 * j11 - j01 * j10),
    )


@device
def _tetrahedron(p, corners, x, weights):
    o, i, j, k = corners[p, 0], corners[p, 1], corners[p, 2], corners[p, 3]
    e = _cofactors(
        x[i, 0] - x[o, 0], x[j, 0] - x[o, 0], x[k, 0] - x[o, 0],
        x[i, 1] - x[o, 1], x[j, 1] - x[o, 1], x[k, 1] - x[o, 1],
        x[i, 2] - x[o, 2], x[j, 2] - x[o, 2], x[k, 2] - x[o, 2],
    )  # fmt: skip
    six = (x[i, 0] - x[o, 0]) * e[0][0] + (x[j, 0] - x[o, 0]) * e[0][1] + (x[k, 0] - x[o, 0]) * e[0][2]
    s = 1.0 / six
    gx, gy, gz = 0.0, 0.0, 0.0
    for c in range(3):
        _put(weights, p, c + 1, 0.25, e[0][c] * s, e[1][c] * s, e[2][c] * s)
        gx, gy, gz = gx - e[0][c] * s, gy - e[1][c] * s, gz - e[2][c] * s
    _put(weights, p, 0, 0.25, gx, gy, gz)
    return six


@device
def _hex_jacobian(p, corners, x, r, s, t):
    """dx/d(r, s, t) of the trilinear map, nine numbers, rows x, y, z."""
    j = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    for c in range(8):
        a, u, v, w = corners[p, c], SIGNS[c, 0], SIGNS[c, 1], SIGNS[c, 2]
        dr = 0.125 * u * (1.0 + v * s) * (1.0 + w * t)
        ds = 0.125 * v * (1.0 + u * r) * (1.0 + w * t)
        dt = 0.125 * w * (1.0 + u * r) * (1.0 + v * s)
        j = (
            j[0] + x[a, 0] * dr, j[1] + x[a, 0] * ds, j[2] + x[a, 0] * dt,
            j[3] + x[a, 1] * dr, j[4] + x[a, 1] * ds, j[5] + x[a, 1] * dt,
            j[6] + x[a, 2] * dr, j[7] + x[a, 2] * ds, j[8] + x[a, 2] * dt,
        )  # fmt: skip
    return j


@device
def _hexahedron(p, corners, x, weights):
    """2 x 2 x 2 Gauss points integrate V, R and G of a trilinear domain exactly."""
    volume, smallest = 0.0, np.inf
    for c in range(8):
        _put(weights, p, c, 0.0, 0.0, 0.0, 0.0)
    for g in range(8):
        r, s, t = _GAUSS * SIGNS[g, 0], _GAUSS * SIGNS[g, 1], _GAUSS * SIGNS[g, 2]
        j = _hex_jacobian(p, corners, x, r, s, t)
        e = _cofactors(j[0], j[1], j[2], j[3], j[4], j[5], j[6], j[7], j[8])
        det = j[0] * e[0][0] + j[1] * e[0][1] + j[2] * e[0][2]
        volume += det
        for c in range(8):
            u, v, w = SIGNS[c, 0], SIGNS[c, 1], SIGNS[c, 2]
            ur, vs, wt = 1.0 + u * r, 1.0 + v * s, 1.0 + w * t
            dr, ds, dt = 0.125 * u * vs * wt, 0.125 * v * ur * wt, 0.125 * w * ur * vs
            weights[p, c, 0] += 0.125 * ur * vs * wt * det
            for k in range(3):
                weights[p, c, k + 1] += dr * e[k][0] + ds * e[k][1] + dt * e[k][2]
        j = _hex_jacobian(p, corners, x, SIGNS[g, 0], SIGNS[g, 1], SIGNS[g, 2])
        e = _cofactors(j[0], j[1], j[2], j[3], j[4], j[5], j[6], j[7], j[8])
        smallest = min(smallest, j[0] * e[0][0] + j[1] * e[0][1] + j[2] * e[0][2])
    for c in range(8):
        for k in range(4):
            weights[p, c, k] /= volume
    return 8.0 * smallest if volume > 0.0 else min(smallest, volume)


@kernel
def corner_weights(start, stop, kind, corners, x, weights, position):
    """Weights and centroid of domains start:stop; return the first that has turned over, or -1."""
    for p in range(start, stop):
        if kind[p] == 0:
            smallest = _line(p, corners, x, weights)
        elif kind[p] == 1:
            smallest = _quad(p, corners, x, weights)
        elif kind[p] == 2:
            smallest = _hexahedron(p, corners, x, weights)
        elif kind[p] == 3:
            smallest = _triangle(p, corners, x, weights)
        else:
            smallest = _tetrahedron(p, corners, x, weights)
        if not smallest > 0.0:
            return p
        for k in range(3):
            position[p, k] = 0.0
        for c in range(CORNERS[kind[p]]):
            for k in range(3):
                position[p, k] += weights[p, c, 0] * x[corners[p, c], k]
    return -1


@kernel
def parallelepipeds(start, stop, index, first, dim, position, F, edges, x, weights):
    """Corners x_p + sum s_k r_k with r_k = F r_k0 (S 16) and their weights (S 18, 19) for CPDI1.

    ``edges[p, k]`` are initial half edge vectors; those of missing axes have length 1/2, so that
    V = 8 r1 . (r2 x r3) serves every dimension. Corner c of the q-th particle of ``index`` is vertex
    first + q * 2^dim + c.
    """
    count = 2**dim
    fold = 2.0 ** (3 - dim)
    for q in range(start, stop):
        p, vertex = index[q], first + q * count
        r = (0.0,) * 9
        for k in range(3):
            e0, e1, e2 = edges[p, k, 0], edges[p, k, 1], edges[p, k, 2]
            for a in range(3):
                r = set_item(r, 3 * k + a, F[p, a, 0] * e0 + F[p, a, 1] * e1 + F[p, a, 2] * e2)
        # Rows of the cofactor matrix are r2 x r3, r3 x r1, r1 x r2.
        e = _cofactors(r[0], r[1], r[2], r[3], r[4], r[5], r[6], r[7], r[8])
        s = fold / (8.0 * (r[0] * e[0][0] + r[1] * e[0][1] + r[2] * e[0][2]))
        for c in range(count):
            u = SIGNS[c, 0]
            v = SIGNS[c, 1] if dim > 1 else 0.0
            w = SIGNS[c, 2] if dim > 2 else 0.0
            for a in range(3):
                x[vertex + c, a] = position[p, a] + u * r[a] + v * r[3 + a] + w * r[6 + a]
                weights[p, c, a + 1] = s * (u * e[0][a] + v * e[1][a] + w * e[2][a])
            weights[p, c, 0] = 1.0 / count

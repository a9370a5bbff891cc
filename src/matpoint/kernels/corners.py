"""Corner weights R_a = (1/V) int N_a and G_a = (1/V) int grad N_a of a particle's domain.

Kinds are numbered as ``matpoint.domains.Kind``: 0 line, 1 quadrilateral, 2 hexahedron,
3 triangle, 4 tetrahedron; corners are in VTK's order. Source: S 18-24 with the corrections of the
methods page, section 3: the weights are exact, and x_p = sum_a R_a x_a is the domain's centroid.
Each function writes ``weights[p, c] = (R, G_x, G_y, G_z)`` and returns the smallest corner
Jacobian, in units of its own: what counts is that it is <= 0 for a domain that has turned over.
"""

from __future__ import annotations

import numpy as np

from matpoint.jit import device, kernel
from matpoint.kernels.vector import (
    across_x,
    across_y,
    across_z,
    fma,
    lane,
    load,
    lower,
    minus,
    pack,
    plus,
    scale,
    store_quadruples,
    times,
)

CORNERS = np.array([2, 4, 8, 3, 4], dtype=np.int8)  # by kind
SIGNS = np.array(
    [[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1], [-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]],
    dtype=float,
)
# A linear function's values at the two Gauss points of an edge, from those at its ends.
_NEAR, _FAR = 0.5 + 0.5 / np.sqrt(3.0), 0.5 - 0.5 / np.sqrt(3.0)
_HALF_X, _HALF_Y, _HALF_Z = (0.5 * SIGNS[:, k] for k in range(3))


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
def cofactors(j00, j01, j02, j10, j11, j12, j20, j21, j22):
    """Return the cofactors of a matrix given by rows, as rows."""
    return (
        (j11 * j22 - j12 * j21, j12 * j20 - j10 * j22, j10 * j21 - j11 * j20),
        (j02 * j21 - j01 * j22, j00 * j22 - j02 * j20, j01 * j20 - j00 * j21),
        (j01 * j12 - j02 * j11, j02 * j10 - j00 * j12, j00 * j11 - j01 * j10),
    )


@device
def _tetrahedron(p, corners, x, weights):
    o, i, j, k = corners[p, 0], corners[p, 1], corners[p, 2], corners[p, 3]
    e = cofactors(
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
def _toward_gauss(value, neighbour):
    """From corners to Gauss points along one axis, or back: the operator is symmetric."""
    return fma(_NEAR, value, scale(_FAR, neighbour))


@device
def _edges(value):
    """d/dr, d/ds, d/dt of a trilinear field at the corners, from its values there."""
    return (
        times(load(_HALF_X, 0), minus(value, across_x(value))),
        times(load(_HALF_Y, 0), minus(value, across_y(value))),
        times(load(_HALF_Z, 0), minus(value, across_z(value))),
    )


@device
def _slopes_at_gauss(e):
    """Derivatives at Gauss points from those at corners; each is constant along its own axis."""
    r, s, t = e
    r, s, t = _toward_gauss(r, across_y(r)), _toward_gauss(s, across_x(s)), _toward_gauss(t, across_x(t))
    return (
        _toward_gauss(r, across_z(r)),
        _toward_gauss(s, across_z(s)),
        _toward_gauss(t, across_y(t)),
    )


@device
def _cross(a, b):
    return (
        minus(times(a[1], b[2]), times(a[2], b[1])),
        minus(times(a[2], b[0]), times(a[0], b[2])),
        minus(times(a[0], b[1]), times(a[1], b[0])),
    )


@device
def _determinant(a, b):
    return plus(times(a[0], b[0]), plus(times(a[1], b[1]), times(a[2], b[2])))


@device
def _pull(r, s, t):
    """sum_g (dN_a/dr r + dN_a/ds s + dN_a/dt t) at each corner a, for values at Gauss points."""
    r, s, t = plus(r, across_x(r)), plus(s, across_y(s)), plus(t, across_z(t))
    along_r = times(load(_HALF_X, 0), _toward_gauss(r, across_y(r)))
    along_s = times(load(_HALF_Y, 0), _toward_gauss(s, across_x(s)))
    flat = plus(along_r, along_s)
    t = _toward_gauss(t, across_x(t))
    return plus(_toward_gauss(flat, across_z(flat)), times(load(_HALF_Z, 0), _toward_gauss(t, across_y(t))))


@device
def _total(value):
    value = plus(value, across_x(value))
    value = plus(value, across_y(value))
    return lane(plus(value, across_z(value)), 0)


@device
def _coordinate(p, corners, x, k):
    return pack(
        x[corners[p, 0], k], x[corners[p, 1], k], x[corners[p, 2], k], x[corners[p, 3], k],
        x[corners[p, 4], k], x[corners[p, 5], k], x[corners[p, 6], k], x[corners[p, 7], k],
    )  # fmt: skip


@device
def _hexahedron(p, corners, x, flat, position):
    """V, R and G of a trilinear domain, exact: eight lanes are eight corners or eight Gauss points.

    With j = dx/d(r, s, t) at 2 x 2 x 2 Gauss points, V = sum_g det j, V R_a = sum_g N_a det j and
    V G_a = dV/dx_a = sum_g cof(j) dN_a/d(r, s, t). Going between corners and Gauss points is one
    interpolation per axis, the same both ways, so nothing is looped over.
    """
    cx, cy, cz = _coordinate(p, corners, x, 0), _coordinate(p, corners, x, 1), _coordinate(p, corners, x, 2)
    ex, ey, ez = _edges(cx), _edges(cy), _edges(cz)
    det = _determinant((ex[0], ey[0], ez[0]), _cross((ex[1], ey[1], ez[1]), (ex[2], ey[2], ez[2])))
    det = lower(det, across_x(det))
    det = lower(det, across_y(det))
    smallest = lane(lower(det, across_z(det)), 0)
    jx, jy, jz = _slopes_at_gauss(ex), _slopes_at_gauss(ey), _slopes_at_gauss(ez)
    r, s, t = (jx[0], jy[0], jz[0]), (jx[1], jy[1], jz[1]), (jx[2], jy[2], jz[2])
    st, tr, rs = _cross(s, t), _cross(t, r), _cross(r, s)
    det = _determinant(r, st)
    volume = _total(det)
    if not (smallest > 0.0 and volume > 0.0):  # write nothing: the particle may go on without these corners
        return -1.0
    inverse = 1.0 / volume
    share = _toward_gauss(det, across_x(det))
    share = _toward_gauss(share, across_y(share))
    share = scale(inverse, _toward_gauss(share, across_z(share)))
    store_quadruples(
        flat, 32 * p, share,
        scale(inverse, _pull(st[0], tr[0], rs[0])),
        scale(inverse, _pull(st[1], tr[1], rs[1])),
        scale(inverse, _pull(st[2], tr[2], rs[2])),
    )  # fmt: skip
    position[p, 0] = _total(times(share, cx))
    position[p, 1] = _total(times(share, cy))
    position[p, 2] = _total(times(share, cz))
    return smallest


@kernel
def corner_weights(start, stop, kind, corners, x, weights, position):
    """Weights and centroid of domains start:stop; return the first that has turned over, or -1."""
    flat = weights.reshape(-1)
    for p in range(start, stop):
        if kind[p] == 0:
            smallest = _line(p, corners, x, weights)
        elif kind[p] == 1:
            smallest = _quad(p, corners, x, weights)
        elif kind[p] == 2:
            smallest = _hexahedron(p, corners, x, flat, position)
        elif kind[p] == 3:
            smallest = _triangle(p, corners, x, weights)
        else:
            smallest = _tetrahedron(p, corners, x, weights)
        if not smallest > 0.0:
            return p
        if kind[p] == 2:
            continue
        for k in range(3):
            position[p, k] = 0.0
        for c in range(CORNERS[kind[p]]):
            for k in range(3):
                position[p, k] += weights[p, c, 0] * x[corners[p, c], k]
    return -1

"""Forces of tractions and pressures on the faces of particle domains.

Index letters: q face, c corner of a face, a vertex. Faces run counter-clockwise seen from outside, so that
the area vector points outward.
"""

from __future__ import annotations

import math

from matpoint.jit import device, kernel

_GAUSS = 1.0 / math.sqrt(3.0)


@device
def _push(force, q, c, share, area, pressure, tx, ty, tz):
    """Add share * (t |dA| - p dA) to corner c of face q."""
    size = math.sqrt(area[0] * area[0] + area[1] * area[1] + area[2] * area[2])
    force[q, c, 0] += share * (tx * size - pressure * area[0])
    force[q, c, 1] += share * (ty * size - pressure * area[1])
    force[q, c, 2] += share * (tz * size - pressure * area[2])


@device
def _cross(u, v):
    return (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])


@device
def _gap(x, a, b):
    return (x[b, 0] - x[a, 0], x[b, 1] - x[a, 1], x[b, 2] - x[a, 2])


@device
def _quadrilateral(force, q, corners, x, pressure, tx, ty, tz):
    """2 x 2 Gauss points: exact for a pressure, since N_a x_,r x x_,s is of degree 3 at the most."""
    o, i, j, k = corners[q, 0], corners[q, 1], corners[q, 2], corners[q, 3]
    low, high, left, right = _gap(x, o, i), _gap(x, k, j), _gap(x, o, k), _gap(x, i, j)
    for g in range(4):
        r = -_GAUSS if g % 2 == 0 else _GAUSS
        s = -_GAUSS if g < 2 else _GAUSS
        a, b, c, d = 0.25 * (1.0 - s), 0.25 * (1.0 + s), 0.25 * (1.0 - r), 0.25 * (1.0 + r)
        along_r = (a * low[0] + b * high[0], a * low[1] + b * high[1], a * low[2] + b * high[2])
        along_s = (c * left[0] + d * right[0], c * left[1] + d * right[1], c * left[2] + d * right[2])
        area = _cross(along_r, along_s)
        _push(force, q, 0, 4.0 * a * c, area, pressure, tx, ty, tz)
        _push(force, q, 1, 4.0 * a * d, area, pressure, tx, ty, tz)
        _push(force, q, 2, 4.0 * b * d, area, pressure, tx, ty, tz)
        _push(force, q, 3, 4.0 * b * c, area, pressure, tx, ty, tz)


@kernel
def face_forces(corners, sign, x, pressure, tx, ty, tz, force):
    """force[q, c] = int N_c (t |dA| - p dA) [N] over faces with vertices at x [m] (S 7, last term).

    Faces are points (unit cross-section), edges (unit thickness), triangles or bilinear quadrilaterals.
    """
    for q in range(corners.shape[0]):
        for c in range(corners.shape[1]):
            for k in range(3):
                force[q, c, k] = 0.0
        if corners.shape[1] == 1:
            _push(force, q, 0, 1.0, (sign[q], 0.0, 0.0), pressure, tx, ty, tz)
        elif corners.shape[1] == 2:
            e = _gap(x, corners[q, 0], corners[q, 1])
            for c in range(2):
                _push(force, q, c, 0.5, (e[1], -e[0], 0.0), pressure, tx, ty, tz)
        elif corners.shape[1] == 3:
            u, v = _gap(x, corners[q, 0], corners[q, 1]), _gap(x, corners[q, 0], corners[q, 2])
            n = _cross(u, v)
            for c in range(3):
                _push(force, q, c, 1.0 / 6.0, n, pressure, tx, ty, tz)
        else:
            _quadrilateral(force, q, corners, x, pressure, tx, ty, tz)


@kernel
def add_forces(vertices, force, records):
    """Add forces to the records of vertices, one after the other: one order of summation."""
    for q in range(vertices.shape[0]):
        for k in range(3):
            records[8 * vertices[q] + 4 + k] += force[q, k]

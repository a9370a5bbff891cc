"""From particles to Gauss points and nodes by moving least squares (T 24-31).

Points are Gauss points of cells that the body fills. With their fields they are what particles are to the
box family's transfers, which do the rest.
"""

from __future__ import annotations

import numpy as np

from matpoint.jit import device, kernel
from matpoint.kernels.mls import fill_basis, gather, improved_shape, moment_shape
from matpoint.kernels.vector import fma, lane, load, store, zero

ROOM = 8192  # particles in the cells around one point
STRIDE = ROOM + 8  # so that columns do not begin in the same lines of a cache
FIELDS = 16  # numbers that a particle hands to the points: two lines
HEAVY = 64  # a fit at one point is as much work as so many transfers of a particle
MODES = {"imls": 0, "mls": 1, "raw-mls": 2}


@kernel
def fill_cells(x, volume, origin, inverse, cells, filled):
    """How much of each cell is filled [-]: particles' volumes spread by hats around the cells' centres.

    What would go beyond the grid stays in the last cell, as if the wall were a mirror.
    """
    for c in range(filled.shape[0]):
        filled[c] = 0.0
    for p in range(x.shape[0]):
        share = volume[p]
        for a in range(3):
            if inverse[a] > 0.0:
                share *= inverse[a]
        r0 = (x[p, 0] - origin[0]) * inverse[0] - 0.5
        r1 = (x[p, 1] - origin[1]) * inverse[1] - 0.5
        r2 = (x[p, 2] - origin[2]) * inverse[2] - 0.5
        i, j, k = int(np.floor(r0)), int(np.floor(r1)), int(np.floor(r2))
        for corner in range(8):
            a, b, c = corner // 4, (corner // 2) % 2, corner % 2
            w = (1.0 - abs(r0 - i - a)) * (1.0 - abs(r1 - j - b)) * (1.0 - abs(r2 - k - c))
            ia = min(max(i + a, 0), cells[0] - 1)
            jb = min(max(j + b, 0), cells[1] - 1)
            kc = min(max(k + c, 0), cells[2] - 1)
            filled[(ia * cells[1] + jb) * cells[2] + kc] += w * share


@device
def _monomials_at(gx, gy, gz, columns, parent, axis, inverse, value):
    """Raw monomials x/h at a point, for MLS as it is usually written."""
    value[0] = 1.0
    for k in range(1, columns):
        g = gx * inverse[0] if axis[k] == 0 else (gy * inverse[1] if axis[k] == 1 else gz * inverse[2])
        value[k] = value[parent[k]] * g


@device
def shape_at(
    gx, gy, gz, mode, counts, parent, axis, tolerance, limit, origin, inverse, cells, support, smooth,
    x, order, pointer, near, weight, offset, basis, value, norm, moment, shape,
):  # fmt: skip
    """Shape functions of the particles around a point; return (neighbours, rank, condition number).

    ``counts[d]`` is the number of monomials of degree <= d. MLS lowers the degree until the condition
    number is below ``limit``; the rank is then that of the degree kept.
    """
    n = gather(gx, gy, gz, origin, inverse, cells, support, smooth, x, order, pointer, near, weight, offset)
    if n <= 0:
        return n, 0, np.inf
    top = counts.shape[0] - 1
    if mode == 0:
        fill_basis(n, counts[top], parent, axis, offset, basis)
        return n, improved_shape(n, counts[top], weight, basis, value, norm, tolerance, shape), 0.0
    if mode == 2:  # monomials of x/h itself, not shifted
        for j in range(n):
            offset[0, j] += gx * inverse[0]
            offset[1, j] += gy * inverse[1]
            offset[2, j] += gz * inverse[2]
    first = 0.0
    for degree in range(top, -1, -1):
        fill_basis(n, counts[degree], parent, axis, offset, basis)
        for k in range(counts[degree]):
            value[k] = 1.0 if k == 0 else 0.0
        if mode == 2:
            _monomials_at(gx, gy, gz, counts[degree], parent, axis, inverse, value)
        condition = moment_shape(n, counts[degree], weight, basis, value, moment, shape)
        if degree == top:
            first = condition
        if condition < limit or degree == 0:
            return n, counts[degree], first
    return n, 0, first


@kernel
def fields_at_points(
    start, stop, place, mode, counts, parent, axis, tolerance, limit, origin, inverse, cells, support,
    x, order, pointer, fields, values, ranks, conditions,
):  # fmt: skip
    """values[g] = sum_p phi_g(x_p) fields[p] at the points ``place`` (g, 3) [m] (T 24-26).

    ``fields`` and ``values`` are flat, ``FIELDS`` numbers each. Where the density, the first, comes out
    negative (few particles beside a free surface) the weighted mean is taken instead. Return the first point
    with more than ``ROOM`` particles around, or -1.
    """
    columns = counts[counts.shape[0] - 1]
    near, weight, shape = np.empty(ROOM, np.int64), np.empty(ROOM), np.empty(ROOM)
    offset, basis = np.empty((3, STRIDE)), np.empty((columns, STRIDE))
    value, norm, moment = np.empty(columns), np.empty(columns), np.empty((columns, columns))
    for g in range(start, stop):
        n, rank, condition = shape_at(
            place[g, 0], place[g, 1], place[g, 2], mode, counts, parent, axis, tolerance, limit, origin,
            inverse, cells, support, True, x, order, pointer, near, weight, offset, basis, value, norm,
            moment, shape,
        )  # fmt: skip
        if n < 0:
            return g
        ranks[g], conditions[g] = rank, condition
        first, second = _sum_fields(n, near, shape, fields)
        if n > 0 and not lane(first, 0) > 0.0:
            total = 0.0
            for j in range(n):
                total += weight[j]
            for j in range(n):
                shape[j] = weight[j] / total
            first, second = _sum_fields(n, near, shape, fields)
        store(values, FIELDS * g, first)
        store(values, FIELDS * g + 8, second)
    return -1


@device
def _sum_fields(n, near, shape, fields):
    first, second = zero(), zero()
    for j in range(n):
        at = FIELDS * near[j]
        first = fma(shape[j], load(fields, at), first)
        second = fma(shape[j], load(fields, at + 8), second)
    return first, second


@kernel
def velocities_at_nodes(
    start, stop, nodes, place, mode, counts, parent, axis, tolerance, limit, origin, inverse, cells, support,
    x, v, order, pointer, ranks, conditions,
):  # fmt: skip
    """v_i = sum_p phi_i(x_p) v_p with the hat as weight (T 31); written as momentum m_i v_i.

    ``place`` (nodes, 3) [m]. A node with mass that sees no particle takes a wider hat. Return the first
    node with more than ``ROOM`` neighbours, or -1.
    """
    columns = counts[counts.shape[0] - 1]
    near, weight, shape = np.empty(ROOM, np.int64), np.empty(ROOM), np.empty(ROOM)
    offset, basis = np.empty((3, STRIDE)), np.empty((columns, STRIDE))
    value, norm, moment = np.empty(columns), np.empty(columns), np.empty((columns, columns))
    for i in range(start, stop):
        ranks[i], conditions[i] = columns, 0.0
        m = nodes[8 * i + 3]
        nodes[8 * i] = nodes[8 * i + 1] = nodes[8 * i + 2] = 0.0
        if not m > 0.0:
            continue
        n, rank, condition, wide = 0, 0, np.inf, support
        while n == 0 and wide <= 8.0 * support:
            n, rank, condition = shape_at(
                place[i, 0], place[i, 1], place[i, 2], mode, counts, parent, axis, tolerance, limit, origin,
                inverse, cells, wide, False, x, order, pointer, near, weight, offset, basis, value, norm,
                moment, shape,
            )  # fmt: skip
            wide *= 2.0
        if n < 0:
            return i
        ranks[i], conditions[i] = rank, condition
        for j in range(n):
            for a in range(3):
                nodes[8 * i + a] += m * shape[j] * v[near[j], a]
    return -1

"""From particles to Gauss points and nodes by moving least squares (T 24-31).

Points are Gauss points of cells that the body fills. With their fields they are what particles are to the
box family's transfers, which do the rest.
"""

from __future__ import annotations

import numpy as np

from matpoint.jit import device, kernel
from matpoint.kernels.mls import fill_basis, gather, improved_shape, moment_shape
from matpoint.kernels.points import FIELDS
from matpoint.kernels.vector import fma, lane, load, scale, store, with_momentum, zero

ROOM = 8192  # particles in the cells around one point
STRIDE = ROOM + 8  # so that columns do not begin in the same lines of a cache
HEAVY = 64  # a fit at one point is as much work as so many transfers of a particle
MODES = {"imls": 0, "mls": 1, "raw-mls": 2}


@device
def workspace(long, short):
    """The arrays of one fit, in two that the thread keeps: of shape (columns + 6, STRIDE), (columns + 2, columns).

    They are neighbours, weights, shape functions, offsets and monomials; values, norms and moments.
    """
    near, weight, shape = long[0, :ROOM].view(np.int64), long[1], long[2]
    return near, weight, shape, long[3:6], long[6:], short[0], short[1], short[2:]


@device
def _monomials_at(gx, gy, gz, columns, parent, axis, inverse, value):
    """Raw monomials x/h at a point, for MLS as it is usually written."""
    value[0] = 1.0
    for k in range(1, columns):
        g = gx * inverse[0] if axis[k] == 0 else (gy * inverse[1] if axis[k] == 1 else gz * inverse[2])
        value[k] = value[parent[k]] * g


@device
def shape_at(
    gx, gy, gz, mode, counts, parent, axis, tolerance, limit, origin, inverse, first, cells, support, smooth,
    x, order, pointer, near, weight, offset, basis, value, norm, moment, shape,
):  # fmt: skip
    """Shape functions of the particles around a point; return (neighbours, rank, condition number).

    ``counts[d]`` is the number of monomials of degree <= d. MLS lowers the degree until the condition
    number is below ``limit``; the rank is then that of the degree kept.
    """
    n = gather(
        gx, gy, gz, origin, inverse, first, cells, support, smooth, x, order, pointer, near, weight, offset
    )  # fmt: skip
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
    highest = 0.0
    for degree in range(top, -1, -1):
        fill_basis(n, counts[degree], parent, axis, offset, basis)
        for k in range(counts[degree]):
            value[k] = 1.0 if k == 0 else 0.0
        if mode == 2:
            _monomials_at(gx, gy, gz, counts[degree], parent, axis, inverse, value)
        condition = moment_shape(n, counts[degree], weight, basis, value, moment, shape)
        if degree == top:
            highest = condition
        if condition < limit or degree == 0:
            return n, counts[degree], highest
    return n, 0, highest


@kernel
def fields_at_points(
    start, stop, place, mode, counts, parent, axis, tolerance, limit, origin, inverse, first, cells, support,
    x, order, pointer, fields, values, ranks, conditions, long, short,
):  # fmt: skip
    """values[g] = sum_p phi_g(x_p) fields[p] at the points ``place`` (g, 3) [m] (T 24-26).

    ``fields`` and ``values`` are flat, see ``kernels.points``. Where the density, the first, comes out
    negative (few particles beside a free surface) the weighted mean is taken instead. Return the first point
    with more than ``ROOM`` particles around, or -1.
    """
    near, weight, shape, offset, basis, value, norm, moment = workspace(long, short)
    for g in range(start, stop):
        n, rank, condition = shape_at(
            place[g, 0], place[g, 1], place[g, 2], mode, counts, parent, axis, tolerance, limit, origin,
            inverse, first, cells, support, True, x, order, pointer, near, weight, offset, basis, value, norm,
            moment, shape,
        )  # fmt: skip
        if n < 0:
            return g
        ranks[g], conditions[g] = rank, condition
        scalars, vectors = _sum_fields(n, near, shape, fields)
        if n > 0 and not lane(scalars, 0) > 0.0:
            total = 0.0
            for j in range(n):
                total += weight[j]
            for j in range(n):
                shape[j] = weight[j] / total
            scalars, vectors = _sum_fields(n, near, shape, fields)
        store(values, FIELDS * g, scalars)
        store(values, FIELDS * g + 8, vectors)
    return -1


@device
def _sum_fields(n, near, shape, fields):
    scalars, vectors = zero(), zero()
    for j in range(n):
        at = FIELDS * near[j]
        scalars = fma(shape[j], load(fields, at), scalars)
        vectors = fma(shape[j], load(fields, at + 8), vectors)
    return scalars, vectors


@kernel
def velocities_at_nodes(
    start, stop, ny, nz, low, high, nodes, node_x, node_y, node_z, mode, counts, parent, axis, tolerance,
    limit, origin, inverse, first, cells, support, x, order, pointer, fields, ranks, conditions, long,
    short,
):  # fmt: skip
    """v_i = sum_p phi_i(x_p) v_p with the hat as weight (T 31); written as momentum m_i v_i.

    Of nodes start:stop of the active ones, a block from ``low`` to ``high``; ``ranks`` and ``conditions`` are
    theirs. ``node_x`` and its like are the coordinates [m] along each axis. A node with mass that sees no
    particle takes a wider hat. Return the first node with more than ``ROOM`` neighbours, or -1.
    """
    columns = counts[counts.shape[0] - 1]
    near, weight, shape, offset, basis, value, norm, moment = workspace(long, short)
    wide_y, wide_z = high[1] - low[1], high[2] - low[2]
    for r in range(start, stop):
        i, j, k = low[0] + r // (wide_y * wide_z), low[1] + (r // wide_z) % wide_y, low[2] + r % wide_z
        at = ((i * ny + j) * nz + k) * 8
        ranks[r], conditions[r] = columns, 0.0
        record, velocity = load(nodes, at), zero()
        m = lane(record, 3)
        if m > 0.0:
            n, rank, condition, wide = 0, 0, np.inf, support
            while n == 0 and wide <= 8.0 * support:
                n, rank, condition = shape_at(
                    node_x[i], node_y[j], node_z[k], mode, counts, parent, axis, tolerance, limit, origin,
                    inverse, first, cells, wide, False, x, order, pointer, near, weight, offset, basis, value,
                    norm, moment, shape,
                )  # fmt: skip
                wide *= 2.0
            if n < 0:
                return r
            ranks[r], conditions[r] = rank, condition
            for q in range(n):
                velocity = fma(shape[q], load(fields, FIELDS * near[q] + 8), velocity)
        store(nodes, at, with_momentum(scale(m, velocity), record))
    return -1

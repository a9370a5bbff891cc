"""From particles to Gauss points and nodes by moving least squares (T 24-31).

Fields at a Gauss point are rows of ten: density, stress (xx, yy, zz, xy, yz, xz), density times body force (3).
The plan of a reconstruction is a tuple of plain values: see ``interpolation/reconstruction.py``.
"""

from __future__ import annotations

import numpy as np

from matpoint.jit import device, kernel
from matpoint.kernels.mls import fill_basis, gather, improved_shape, moment_shape
from matpoint.kernels.rows import row
from matpoint.kernels.vector import fma, load, pack, scale, store

ROOM = 4096  # neighbours of one point
MODES = {"imls": 0, "mls": 1, "raw-mls": 2}


@kernel
def order_by_cell(x, origin, inverse, cells, cell, pointer, order):
    """Stable counting sort of particles by cell, the last axis fastest; ``cell`` is scratch."""
    for c in range(pointer.shape[0]):
        pointer[c] = 0
    for p in range(x.shape[0]):
        number = 0
        for a in range(3):
            k = int(np.floor((x[p, a] - origin[a]) * inverse[a]))
            number = number * cells[a] + min(max(k, 0), cells[a] - 1)
        cell[p] = number
        pointer[number + 1] += 1
    for c in range(pointer.shape[0] - 1):
        pointer[c + 1] += pointer[c]
    for p in range(x.shape[0]):
        order[pointer[cell[p]]] = p
        pointer[cell[p]] += 1
    for c in range(pointer.shape[0] - 1, 0, -1):
        pointer[c] = pointer[c - 1]
    pointer[0] = 0


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
    n = gather(
        gx, gy, gz, origin, inverse, cells, support, smooth, x, order, pointer, near, weight, offset
    )
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
def cells_to_nodes(
    ax, ay, az, ny, nz, nodes, slabs, start, stop, slab_pointer, slab_cells, points, shares,
    mode, counts, parent, axis, tolerance, limit, origin, inverse, size, cells, support,
    x, order, pointer, fields, kinematic, dynamic, ranks, conditions,
):  # fmt: skip
    """Mass, internal and body force of whole cells by Gauss points (T 24-30, with rho in T 29).

    ``points`` (g, 3) are in units of the cell, ``shares`` (g,) times its volume; ``fields`` (n, 10) are the
    particles'. ``ranks`` and ``conditions`` take the smallest rank and the largest condition number in
    each cell. Return the first cell with more than ``ROOM`` neighbours, or -1.
    """
    columns = counts[counts.shape[0] - 1]
    near, weight, shape = np.empty(ROOM, np.int64), np.empty(ROOM), np.empty(ROOM)
    offset, basis = np.empty((3, ROOM)), np.empty((columns, ROOM))
    value, norm, moment = np.empty(columns), np.empty(columns), np.empty((columns, columns))
    for s in range(start, stop):
        for r in range(slab_pointer[slabs[s]], slab_pointer[slabs[s] + 1]):
            c = slab_cells[r]
            ranks[c], conditions[c] = columns, 0.0
            i0, j0, k0 = c // (cells[1] * cells[2]), (c // cells[2]) % cells[1], c % cells[2]
            for g in range(points.shape[0]):
                gx = origin[0] + (i0 + points[g, 0]) * size[0]
                gy = origin[1] + (j0 + points[g, 1]) * size[1]
                gz = origin[2] + (k0 + points[g, 2]) * size[2]
                n, rank, condition = shape_at(
                    gx, gy, gz, mode, counts, parent, axis, tolerance, limit, origin, inverse, cells,
                    support, True, x, order, pointer, near, weight, offset, basis, value, norm, moment, shape,
                )  # fmt: skip
                if n < 0:
                    return c
                ranks[c], conditions[c] = min(ranks[c], rank), max(conditions[c], condition)
                d, xx, yy, zz, xy, yz, xz, fx, fy, fz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
                for j in range(n):
                    p, w = near[j], shape[j]
                    d += w * fields[p, 0]
                    xx += w * fields[p, 1]
                    yy += w * fields[p, 2]
                    zz += w * fields[p, 3]
                    xy += w * fields[p, 4]
                    yz += w * fields[p, 5]
                    xz += w * fields[p, 6]
                    fx += w * fields[p, 7]
                    fy += w * fields[p, 8]
                    fz += w * fields[p, 9]
                m, f, t = kinematic * d * shares[g], dynamic * shares[g], -dynamic * shares[g]
                content = pack(0.0, 0.0, 0.0, m, f * fx, f * fy, f * fz, 0.0)
                pull_x = pack(0.0, 0.0, 0.0, 0.0, t * xx, t * xy, t * xz, 0.0)
                pull_y = pack(0.0, 0.0, 0.0, 0.0, t * xy, t * yy, t * yz, 0.0)
                pull_z = pack(0.0, 0.0, 0.0, 0.0, t * xz, t * yz, t * zz, 0.0)
                bx, wx, dx = row(ax, gx, 0.0)
                by, wy, dy = row(ay, gy, 0.0)
                bz, wz, dz = row(az, gz, 0.0)
                for i in range(len(wx)):
                    for j in range(len(wy)):
                        ww, dw, wd = wx[i] * wy[j], dx[i] * wy[j], wx[i] * dy[j]
                        line = fma(wd, pull_y, fma(dw, pull_x, scale(ww, content)))
                        slope = scale(ww, pull_z)
                        node = (((bx + i) * ny + by + j) * nz + bz) * 8
                        for k in range(len(wz)):
                            store(nodes, node, fma(dz[k], slope, fma(wz[k], line, load(nodes, node))))
                            node += 8
    return -1


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
    offset, basis = np.empty((3, ROOM)), np.empty((columns, ROOM))
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

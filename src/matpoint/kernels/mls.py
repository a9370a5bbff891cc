"""Moving least squares at one point: neighbours, monomials, orthogonalisation (T 1-17).

Index letters: j neighbour, k column of monomials. Monomials are of (x_p - x_g)/h, shifted to the point and
scaled by the cell, so that at the point itself they are (1, 0, 0, ...); column k > 0 is column
``parent[k]`` times the coordinate ``axis[k]``. Columns stand as rows of ``basis``, (columns, neighbours).
"""

from __future__ import annotations

import numpy as np

from matpoint.jit import device

#: A column is noise when its square's mean is below this, in cells: positions are rounded in their 14th digit.
_NOISE = 1e-20


@device
def spline_weight(r):
    """Quadratic spline of support 1.5 (T 27, with r = |x - x_p|/h), as a difference of two squares."""
    wide, narrow = max(1.5 - abs(r), 0.0), max(0.5 - abs(r), 0.0)
    return 0.5 * wide * wide - 1.5 * narrow * narrow


@device
def point_weight(r, support, smooth):
    """The weight at a distance of r cells: the quadratic spline, or the hat, stretched to ``support``."""
    if smooth:
        return spline_weight(r * 1.5 / support)
    return max(0.0, 1.0 - abs(r) / support)


@device
def _reach(centre, support, first, cells):
    """First and last cell of a block, along one axis, that a weight sees; ``centre`` is in cells of the grid.

    If it sees none of them the last is one less than the first.
    """
    low = min(max(int(np.floor(centre - support)) - first, 0), cells)
    high = max(min(int(np.floor(centre + support)) - first, cells - 1), -1)
    return low, high


@device
def gather(
    gx, gy, gz, origin, inverse, first, cells, support, smooth, x, order, pointer, near, weight, offset
):  # fmt: skip
    """List the particles within ``support`` cells of a point; return how many, or -1 if there is no room.

    ``near`` takes their indices, ``weight`` their weights, ``offset`` (3, room) their (x_p - x_g)/h.
    """
    cx, cy, cz = (gx - origin[0]) * inverse[0], (gy - origin[1]) * inverse[1], (gz - origin[2]) * inverse[2]
    ax, bx = _reach(cx, support, first[0], cells[0])
    ay, by = _reach(cy, support, first[1], cells[1])
    az, bz = _reach(cz, support, first[2], cells[2])
    n = 0
    for i in range(ax, bx + 1):
        for j in range(ay, by + 1):
            row = (i * cells[1] + j) * cells[2]
            begin, end = pointer[row + az], pointer[row + bz + 1]
            if n + end - begin > near.shape[0]:
                return -1
            for q in range(begin, end):
                p = order[q]
                near[n] = p
                offset[0, n] = (x[p, 0] - gx) * inverse[0]
                offset[1, n] = (x[p, 1] - gy) * inverse[1]
                offset[2, n] = (x[p, 2] - gz) * inverse[2]
                n += 1
    for j in range(n):  # without a branch, so that it is done for several at a time
        value = point_weight(offset[0, j], support, smooth)
        value *= point_weight(offset[1, j], support, smooth) if inverse[1] > 0.0 else 1.0
        value *= point_weight(offset[2, j], support, smooth) if inverse[2] > 0.0 else 1.0
        weight[j] = value
    kept = 0
    for j in range(n):
        if weight[j] > 0.0:
            near[kept], weight[kept] = near[j], weight[j]
            offset[0, kept], offset[1, kept], offset[2, kept] = offset[0, j], offset[1, j], offset[2, j]
            kept += 1
    return kept


@device
def fill_basis(n, columns, parent, axis, offset, basis):
    """Monomials of the neighbours, one column after the other."""
    for j in range(n):
        basis[0, j] = 1.0
    for k in range(1, columns):
        for j in range(n):
            basis[k, j] = basis[parent[k], j] * offset[axis[k], j]


@device
def _dot(n, weight, a, b):
    """<a, b> = sum_p w a(x_p) b(x_p) (T 7)."""
    total = 0.0
    for j in range(n):
        total += weight[j] * a[j] * b[j]
    return total


@device
def improved_shape(n, columns, weight, basis, value, norm, tolerance, shape):
    """IMLS: phi_p = w_p sum_k q_k(x_p) q_k(x_g) / <q_k, q_k> (T 11-16); return the rank kept.

    Gram-Schmidt is done twice for each column. A column with <q, q> < tolerance * <monomial, monomial> is
    dropped by itself: particles on a line lose the column across it and keep the one along it (T 17 would
    drop all that follow). So is one that is rounding alone, as when all particles stand level with the point:
    it may differ from the others as much as a true one. ``value`` and ``norm`` are scratch, (columns,).
    """
    for k in range(columns):
        value[k] = 1.0 if k == 0 else 0.0
    return orthogonal_shape(n, columns, weight, basis, value, norm, tolerance, shape)


@device
def orthogonal_shape(n, columns, weight, basis, value, norm, tolerance, shape):
    """``improved_shape`` for any point: ``value`` holds the monomials there, and is overwritten."""
    rank, norm[0] = 0, 0.0
    for k in range(columns):
        full = _dot(n, weight, basis[k], basis[k])
        for _ in range(2):
            for q in range(k):
                if norm[q] > 0.0:
                    share = _dot(n, weight, basis[k], basis[q]) / norm[q]
                    value[k] -= share * value[q]
                    for j in range(n):
                        basis[k, j] -= share * basis[q, j]
        left = _dot(n, weight, basis[k], basis[k])
        norm[k] = left if left > max(tolerance * full, _NOISE * norm[0]) else 0.0
        if norm[k] > 0.0:
            rank += 1
    for j in range(n):
        shape[j] = 0.0
    for k in range(columns):
        if norm[k] > 0.0:
            share = value[k] / norm[k]
            for j in range(n):
                shape[j] += share * basis[k, j]
    for j in range(n):
        shape[j] *= weight[j]
    return rank


@device
def moment_shape(n, columns, weight, basis, value, moment, shape):
    """MLS: phi_p = w_p p(x_g)^T A^-1 p(x_p), A = sum w p p^T (T 3-6); return A's condition number.

    ``value`` holds the monomials at the point. If A is singular nothing is written and inf is returned.
    """
    for k in range(columns):
        for q in range(k + 1):
            moment[k, q] = _dot(n, weight, basis[k], basis[q])
            moment[q, k] = moment[k, q]
    small = moment[:columns, :columns]
    spread = np.linalg.eigvalsh(small)
    if not spread[0] > 1e-15 * spread[-1]:
        return np.inf
    coefficient = np.linalg.solve(small, value[:columns])
    for j in range(n):
        total = 0.0
        for k in range(columns):
            total += coefficient[k] * basis[k, j]
        shape[j] = weight[j] * total
    return spread[-1] / spread[0]

"""Taylor least squares: a polynomial for each cell from its own particles (Wobbes et al. 2019).

Index letters: c cell, p particle of the cell, g Gauss point of it, k column of monomials, f field. Fields are
density, stress (6), body force per mass (3), velocity (3).
"""

from __future__ import annotations

import numpy as np

from matpoint.jit import device, kernel
from matpoint.kernels.mls import fill_basis, orthogonal_shape
from matpoint.kernels.reconstruct import ROOM


@device
def _fit(
    near, n, columns, parent, axis, tolerance, at, offset, weight, basis, value, norm, shape, fields, out
):
    """out[f] = sum_p phi(x_p) fields[p, f] at the place ``at`` (3), in cells from the centre; return rank."""
    fill_basis(n, columns, parent, axis, offset, basis)
    value[0] = 1.0
    for k in range(1, columns):
        value[k] = value[parent[k]] * at[axis[k]]
    rank = orthogonal_shape(n, columns, weight, basis, value, norm, tolerance, shape)
    for f in range(fields.shape[1]):
        total = 0.0
        for j in range(n):
            total += shape[j] * fields[near[j], f]
        out[f] = total
    return rank


@device
def _keep_means(near, n, shares, volume_of_cell, mass, volume, keep_stress, fields, values):
    """Shift the values at a cell's Gauss points so that its means are the particles' (Wobbes, section 3).

    The integral of the density is the particles' mass, those of density times velocity and body force are
    their momentum and force; with ``keep_stress`` the mean stress is theirs by volume. If a density is not
    positive then the cell's is constant.
    """
    points = shares.shape[0]
    total, filled = 0.0, 0.0
    for j in range(n):
        total += mass[near[j]]
        filled += volume[near[j]]
    found, least = 0.0, 1.0
    for g in range(points):
        found += shares[g] * values[g, 0]
    for g in range(points):
        values[g, 0] += (total - found) / volume_of_cell
        least = min(least, values[g, 0])
    if least <= 0.0:
        for g in range(points):
            values[g, 0] = total / volume_of_cell
    for f in range(1 if keep_stress else 7, fields.shape[1]):
        wanted, found = 0.0, 0.0
        for j in range(n):
            p = near[j]
            wanted += fields[p, f] * (volume[p] / filled if f < 7 else mass[p] / total)
        for g in range(points):
            found += shares[g] * values[g, f] * (1.0 / volume_of_cell if f < 7 else values[g, 0] / total)
        for g in range(points):
            values[g, f] += wanted - found


@kernel
def fields_in_cells(
    start, stop, chosen, unit, shares, columns, parent, axis, tolerance, keep_stress, origin, inverse, size,
    cells, x, mass, volume, order, pointer, fields, values, ranks,
):  # fmt: skip
    """Fields at the Gauss points of cells chosen[start:stop], with the cells' means kept.

    ``unit`` (g, 3) are the points of the unit cell, ``shares`` (g,) their volumes; ``values`` (cells * g,
    fields), ``ranks`` alike. A cell without particles gets zeros. Return the first cell with more than
    ``ROOM`` particles, or -1.
    """
    points, width = unit.shape[0], fields.shape[1]
    weight, shape = np.ones(ROOM), np.empty(ROOM)
    offset, basis = np.empty((3, ROOM)), np.empty((columns, ROOM))
    value, norm, at = np.empty(columns), np.empty(columns), np.empty(3)
    volume_of_cell = size[0] * size[1] * size[2]
    for q in range(start, stop):
        c = chosen[q]
        near = order[pointer[c] : pointer[c + 1]]
        n = near.shape[0]
        if n > ROOM:
            return c
        i, j, k = c // (cells[1] * cells[2]), (c // cells[2]) % cells[1], c % cells[2]
        for r in range(n):
            p = near[r]
            offset[0, r] = (x[p, 0] - origin[0]) * inverse[0] - i - 0.5
            offset[1, r] = (x[p, 1] - origin[1]) * inverse[1] - j - 0.5
            offset[2, r] = (x[p, 2] - origin[2]) * inverse[2] - k - 0.5
        for g in range(points):
            for a in range(3):
                at[a] = unit[g, a] - 0.5
            for f in range(width):
                values[q * points + g, f] = 0.0
            ranks[q * points + g] = 0
            if n > 0:
                ranks[q * points + g] = _fit(
                    near, n, columns, parent, axis, tolerance, at, offset, weight, basis, value, norm, shape,
                    fields, values[q * points + g],
                )  # fmt: skip
        if n > 0:
            _keep_means(
                near, n, shares, volume_of_cell, mass, volume, keep_stress, fields,
                values[q * points : (q + 1) * points],
            )  # fmt: skip
    return -1

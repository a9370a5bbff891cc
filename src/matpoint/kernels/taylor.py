"""Taylor least squares: a polynomial for each cell from its own particles (Wobbes et al. 2019).

Index letters: c cell, p particle of the cell, g Gauss point of it, k column of monomials, f field. Fields are
density, stress (6), body force per mass (3), velocity (3).
"""

from __future__ import annotations

import numpy as np

from matpoint.jit import device, kernel
from matpoint.kernels.mls import fill_basis, orthogonal_shape
from matpoint.kernels.reconstruct import ROOM, workspace


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


@kernel
def gather_fields(start, stop, mass, volume, stress, body, v, fields):
    """What particles start:stop hand over, a row of ``fields`` (n, 13) each."""
    for p in range(start, stop):
        b = p if body.shape[0] > 1 else 0
        fields[p, 0] = mass[p] / volume[p]
        for a in range(6):
            fields[p, 1 + a] = stress[p, a]
        for a in range(3):
            fields[p, 7 + a], fields[p, 10 + a] = body[b, a], v[p, a]


@kernel
def list_rest(covered, sliver, rest):
    """List the particles of which more than the share ``sliver`` went to no cell; return how many.

    An empty ``rest`` is left as it is: they are counted only.
    """
    n = 0
    for p in range(covered.shape[0]):
        if 1.0 - covered[p] > sliver:
            if rest.shape[0] > 0:
                rest[n] = p
            n += 1
    return n


@kernel
def carry_cells(start, stop, values, shares, mass, volume, stress, body, v):
    """What Gauss points start:stop stand for, from the fields there; ``shares`` [m^3] are those of a cell."""
    for g in range(start, stop):
        volume[g] = shares[g % shares.shape[0]]
        mass[g] = values[g, 0] * volume[g]
        for a in range(6):
            stress[g, a] = values[g, 1 + a]
        for a in range(3):
            body[g, a], v[g, a] = values[g, 7 + a], values[g, 10 + a]


@kernel
def carry_rest(
    start,
    stop,
    rest,
    first,
    covered,
    x,
    own_mass,
    own_volume,
    fields,
    position,
    mass,
    volume,
    stress,
    body,
    v,
):
    """What went to no cell of particles rest[start:stop] stands for itself, as points from ``first`` on."""
    for r in range(start, stop):
        p, q = rest[r], first + r
        share = 1.0 - covered[p]
        mass[q], volume[q] = share * own_mass[p], share * own_volume[p]
        for a in range(6):
            stress[q, a] = fields[p, 1 + a]
        for a in range(3):
            position[q, a], body[q, a], v[q, a] = x[p, a], fields[p, 7 + a], fields[p, 10 + a]


@kernel
def boxes_along(start, stop, half0, F, half):
    """Half-lengths l_k0 |F_kk| [m] of the boxes of particles start:stop."""
    for p in range(start, stop):
        for k in range(3):
            half[p, k] = half0[p, k] * abs(F[p, k, k])


@kernel
def sum_in_cells(
    x, half, mass, volume, fields, slot, origin, inverse, first, cells, totals, covered
):  # fmt: skip
    """Add up what cells hold: mass, volume, and each field by mass or, the stress, by volume.

    A particle counts for a cell with the share of its box, of half-lengths ``half`` [m], that lies there;
    with none, (1, 3) of zeros, for that of its centre. Cells are those of a block of ``cells`` from ``first``
    of the grid; ``slot`` is the row of ``totals`` of each cell, or -1;
    ``covered`` (n,) is the share of each particle that went to such cells.
    """
    least, most = np.empty(3, np.int64), np.empty(3, np.int64)
    for p in range(x.shape[0]):
        h = p if half.shape[0] > 1 else 0
        for a in range(3):
            low, high = x[p, a] - half[h, a] - origin[a], x[p, a] + half[h, a] - origin[a]
            least[a] = min(max(int(np.floor(low * inverse[a])) - first[a], 0), cells[a] - 1)
            most[a] = min(max(int(np.floor(high * inverse[a])) - first[a], 0), cells[a] - 1)
        covered[p] = 0.0
        for i in range(least[0], most[0] + 1):
            for j in range(least[1], most[1] + 1):
                for k in range(least[2], most[2] + 1):
                    q = slot[(i * cells[1] + j) * cells[2] + k]
                    if q < 0:
                        continue
                    share = 1.0
                    for a in range(3):
                        if half[h, a] > 0.0 and inverse[a] > 0.0:
                            n = first[a] + (i if a == 0 else (j if a == 1 else k))
                            low = max(x[p, a] - half[h, a], origin[a] + n / inverse[a])
                            high = min(x[p, a] + half[h, a], origin[a] + (n + 1) / inverse[a])
                            share *= max(0.0, high - low) / (2.0 * half[h, a])
                    covered[p] += share
                    m, v = share * mass[p], share * volume[p]
                    totals[q, 0] += m
                    totals[q, 13] += v
                    for f in range(1, 13):
                        totals[q, f] += (v if f < 7 else m) * fields[p, f]


@device
def _keep_means(totals, shares, volume_of_cell, keep_stress, values):
    """Shift the values at a cell's Gauss points so that its means are the particles' (Wobbes, section 3).

    The integral of the density is the particles' mass, those of density times velocity and body force are
    their momentum and force; with ``keep_stress`` the mean stress is theirs by volume. If a density is not
    positive then the cell's is constant.
    """
    points, mass = shares.shape[0], totals[0]
    found, least = 0.0, 1.0
    for g in range(points):
        found += shares[g] * values[g, 0]
    for g in range(points):
        values[g, 0] += (mass - found) / volume_of_cell
        least = min(least, values[g, 0])
    if least <= 0.0:
        for g in range(points):
            values[g, 0] = mass / volume_of_cell
    for f in range(1 if keep_stress else 7, 13):
        wanted, found = totals[f] / (totals[13] if f < 7 else mass), 0.0
        for g in range(points):
            found += shares[g] * values[g, f] * (1.0 / volume_of_cell if f < 7 else values[g, 0] / mass)
        for g in range(points):
            values[g, f] += wanted - found


@kernel
def fields_in_cells(
    start, stop, chosen, unit, shares, columns, parent, axis, tolerance, keep_stress, origin, inverse, first,
    cells, size, x, order, pointer, fields, totals, values, ranks, long, short,
):  # fmt: skip
    """Fields at the Gauss points of cells chosen[start:stop], with the cells' means kept.

    ``unit`` (g, 3) are the points of the unit cell, ``shares`` (g,) their volumes; ``values`` (cells * g,
    fields), ``ranks`` alike. ``totals`` are those of ``sum_in_cells``; a cell without any gets zeros, one
    without a centre constants. Return the first cell with more than
    ``ROOM`` particles, or -1.
    """
    points, width = unit.shape[0], fields.shape[1]
    _, weight, shape, offset, basis, value, norm, _ = workspace(long, short)
    at = np.empty(3)
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
            weight[r] = 1.0
            offset[0, r] = (x[p, 0] - origin[0]) * inverse[0] - (first[0] + i) - 0.5
            offset[1, r] = (x[p, 1] - origin[1]) * inverse[1] - (first[1] + j) - 0.5
            offset[2, r] = (x[p, 2] - origin[2]) * inverse[2] - (first[2] + k) - 0.5
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
        if totals[q, 0] > 0.0:
            _keep_means(totals[q], shares, volume_of_cell, keep_stress, values[q * points : (q + 1) * points])
    return -1

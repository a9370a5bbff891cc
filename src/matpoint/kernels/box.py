"""Transfers of the box family: a particle touches a block of nodes, weighed by three rows.

Index letters: p particle; i, j, k rows along the three axes; n node. ``nodes`` is the flat view
of the records: momentum (3), mass, force (3), spare before the solve; velocity, mass, velocity
increment, spare after it. Nodes are numbered with the last axis fastest.
"""

from __future__ import annotations

from matpoint.jit import device, kernel, set_item
from matpoint.kernels.content import contribution, take
from matpoint.kernels.rows import row
from matpoint.kernels.spread import spread, value_at
from matpoint.kernels.vector import fma, lane, load, pack, scale, store, zero


@kernel
def particles_to_nodes(
    ax, ay, az, ny, nz, nodes, slabs, start, stop, pointer, order,
    x, half, v, mass, volume, stress, body, kinematic, dynamic,
):  # fmt: skip
    """Add mass and momentum (S 1, 2) and internal plus body force (S 9, 7) of slabs[start:stop]."""
    for q in range(start, stop):
        for r in range(pointer[slabs[q]], pointer[slabs[q] + 1]):
            p = order[r]
            h = p if half.shape[0] > 1 else 0
            bx, wx, dx = row(ax, x[p, 0], half[h, 0])
            by, wy, dy = row(ay, x[p, 1], half[h, 1])
            bz, wz, dz = row(az, x[p, 2], half[h, 2])
            content, pull_x, pull_y, pull_z = contribution(
                p, v, mass, volume, stress, body, kinematic, dynamic
            )
            for i in range(len(wx)):
                wi, di = wx[i], dx[i]
                plane = fma(di, pull_x, scale(wi, content))
                plane_y, plane_z = scale(wi, pull_y), scale(wi, pull_z)
                for j in range(len(wy)):
                    line = fma(dy[j], plane_y, scale(wy[j], plane))
                    slope = scale(wy[j], plane_z)
                    n = (((bx + i) * ny + by + j) * nz + bz) * 8
                    for k in range(len(wz)):
                        store(nodes, n, fma(dz[k], slope, fma(wz[k], line, load(nodes, n))))
                        n += 8


@kernel
def nodes_to_particles(
    ax, ay, az, ny, nz, nodes, start, stop,
    x, half, v, x_next, gradient, dt, flip, move, differentiate,
):  # fmt: skip
    """Velocity and position (S 13, 14) if ``move``, velocity gradient (S 15) if ``differentiate``.

    ``flip`` is FLIP's share of the velocity, the rest is PIC. ``gradient`` is of these particles only.
    """
    for p in range(start, stop):
        h = p if half.shape[0] > 1 else 0
        bx, wx, dx = row(ax, x[p, 0], half[h, 0])
        by, wy, dy = row(ay, x[p, 1], half[h, 1])
        bz, wz, dz = row(az, x[p, 2], half[h, 2])
        value, along_x, along_y, along_z = zero(), zero(), zero(), zero()
        for i in range(len(wx)):
            plane, plane_y, plane_z = zero(), zero(), zero()
            for j in range(len(wy)):
                n = (((bx + i) * ny + by + j) * nz + bz) * 8
                line, slope = zero(), zero()
                for k in range(len(wz)):
                    node = load(nodes, n)
                    line = fma(wz[k], node, line)
                    slope = fma(dz[k], node, slope)
                    n += 8
                plane = fma(wy[j], line, plane)
                plane_y = fma(dy[j], line, plane_y)
                plane_z = fma(wy[j], slope, plane_z)
            wi = wx[i]
            value = fma(wi, plane, value)
            along_x = fma(dx[i], plane, along_x)
            along_y = fma(wi, plane_y, along_y)
            along_z = fma(wi, plane_z, along_z)
        take(
            p, start, value, along_x, along_y, along_z, v, x, x_next, gradient, dt, flip, move, differentiate
        )  # fmt: skip


@kernel
def mass_times(ax, ay, az, ny, nz, source, target, slabs, start, stop, pointer, order, x, mass, count):
    """Add M source to target in every lane, with the consistent mass M_ij = sum_g phi_i phi_j m_g.

    Of the first ``count`` points; those that follow are left out.
    """
    for q in range(start, stop):
        for r in range(pointer[slabs[q]], pointer[slabs[q] + 1]):
            p = order[r]
            if p >= count:
                continue
            value = scale(mass[p], value_at(ax, ay, az, ny, nz, source, x, p))
            spread(ax, ay, az, ny, nz, target, x, p, value)


@device
def _arms(w, first, coordinates, x):
    """w_i (x_i - x_p) along one axis, as a row."""
    arms = w
    for i in range(len(w)):
        arms = set_item(arms, i, w[i] * (coordinates[first + i] - x))
    return arms


@device
def _inverse_spread(arms, first, coordinates, x):
    """1 / sum w (x_i - x_p)^2 along one axis, or 0 where it vanishes (a missing axis, a hat at a node)."""
    spread = 0.0
    for i in range(len(arms)):
        spread += arms[i] * (coordinates[first + i] - x)
    return 1.0 / spread if spread > 0.0 else 0.0


@device
def _column(moment, p, a, factor):
    """Column ``a`` of a particle's B times a factor, in the lanes of momentum."""
    x, y, z = moment[p, 0, a], moment[p, 1, a], moment[p, 2, a]
    return pack(factor * x, factor * y, factor * z, 0.0, 0.0, 0.0, 0.0, 0.0)


@kernel
def affine_to_nodes(
    ax, ay, az, ny, nz, nodes, slabs, start, stop, pointer, order, x, half, mass, moment, cx, cy, cz
):
    """Add the affine momentum m B D^-1 (x_i - x_p) of APIC (Jiang et al. 2015, eq. 8).

    D = sum w (x_i - x_p)(x_i - x_p)^T is taken where the particle is now, so that angular momentum is
    kept by every basis; it is diagonal, since the rows of weights reproduce x_p. ``ux`` and its like are
    rows w (x_i - x_p): they stand where the gradients do in ``particles_to_nodes``.
    """
    for q in range(start, stop):
        for r in range(pointer[slabs[q]], pointer[slabs[q] + 1]):
            p = order[r]
            h = p if half.shape[0] > 1 else 0
            bx, wx, _ = row(ax, x[p, 0], half[h, 0])
            by, wy, _ = row(ay, x[p, 1], half[h, 1])
            bz, wz, _ = row(az, x[p, 2], half[h, 2])
            ux = _arms(wx, bx, cx, x[p, 0])
            uy = _arms(wy, by, cy, x[p, 1])
            uz = _arms(wz, bz, cz, x[p, 2])
            along_x = _column(moment, p, 0, mass[p] * _inverse_spread(ux, bx, cx, x[p, 0]))
            along_y = _column(moment, p, 1, mass[p] * _inverse_spread(uy, by, cy, x[p, 1]))
            along_z = _column(moment, p, 2, mass[p] * _inverse_spread(uz, bz, cz, x[p, 2]))
            for i in range(len(wx)):
                plane, plane_y, plane_z = scale(ux[i], along_x), scale(wx[i], along_y), scale(wx[i], along_z)
                for j in range(len(wy)):
                    line, slope = fma(uy[j], plane_y, scale(wy[j], plane)), scale(wy[j], plane_z)
                    n = (((bx + i) * ny + by + j) * nz + bz) * 8
                    for k in range(len(wz)):
                        store(nodes, n, fma(uz[k], slope, fma(wz[k], line, load(nodes, n))))
                        n += 8


@kernel
def nodes_to_affine(ax, ay, az, ny, nz, nodes, start, stop, x, half, moment, cx, cy, cz):
    """B = sum w v (x_i - x_p)^T (Jiang et al. 2015, eq. 10), by rows as in ``affine_to_nodes``."""
    for p in range(start, stop):
        h = p if half.shape[0] > 1 else 0
        bx, wx, _ = row(ax, x[p, 0], half[h, 0])
        by, wy, _ = row(ay, x[p, 1], half[h, 1])
        bz, wz, _ = row(az, x[p, 2], half[h, 2])
        ux = _arms(wx, bx, cx, x[p, 0])
        uy = _arms(wy, by, cy, x[p, 1])
        uz = _arms(wz, bz, cz, x[p, 2])
        moment_x, moment_y, moment_z = zero(), zero(), zero()
        for i in range(len(wx)):
            plane, plane_y, plane_z = zero(), zero(), zero()
            for j in range(len(wy)):
                n = (((bx + i) * ny + by + j) * nz + bz) * 8
                line, slope = zero(), zero()
                for k in range(len(wz)):
                    node = load(nodes, n)
                    line = fma(wz[k], node, line)
                    slope = fma(uz[k], node, slope)
                    n += 8
                plane = fma(wy[j], line, plane)
                plane_y = fma(uy[j], line, plane_y)
                plane_z = fma(wy[j], slope, plane_z)
            moment_x = fma(ux[i], plane, moment_x)
            moment_y = fma(wx[i], plane_y, moment_y)
            moment_z = fma(wx[i], plane_z, moment_z)
        for a in range(3):
            moment[p, a, 0] = lane(moment_x, a)
            moment[p, a, 1] = lane(moment_y, a)
            moment[p, a, 2] = lane(moment_z, a)

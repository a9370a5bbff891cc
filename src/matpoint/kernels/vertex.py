"""Transfers of the vertex family: particle -> corner -> node, and back.

Index letters: p particle, a vertex, c corner of a particle (``corners[p, c] = a``), n node. The
corner weights are ``weights[p, c] = (R, G_x, G_y, G_z)`` with R = (1/V) int N and
G = (1/V) int grad N over the particle's domain (S 24 and its gradient). Records of vertices have
the layout of node records. An enriched vertex is a node of its own: its record is that node's.
"""

from __future__ import annotations

from matpoint.jit import kernel
from matpoint.kernels.rows import row
from matpoint.kernels.vector import fma, lane, load, pack, scale, store, zero


@kernel
def particles_to_vertices(
    start, stop, pointer, slots, weights, v, mass, volume, stress, body, kinematic, dynamic, records
):  # fmt: skip
    """Form the records of vertices start:stop from all particles that share them (S 1, 2, 9, 23).

    Each vertex gathers through its list ``slots[pointer[a]:pointer[a + 1]]`` of p * K + c: no
    race, and one order of summation.
    """
    width = weights.shape[1]
    for a in range(start, stop):
        m, px, py, pz, fx, fy, fz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        for q in range(pointer[a], pointer[a + 1]):
            p, c = slots[q] // width, slots[q] % width
            g = p if body.shape[0] > 1 else 0
            share, pull = weights[p, c, 0] * mass[p], -dynamic * volume[p]
            gx, gy, gz = pull * weights[p, c, 1], pull * weights[p, c, 2], pull * weights[p, c, 3]
            push = dynamic * share
            share *= kinematic
            m += share
            px += share * v[p, 0]
            py += share * v[p, 1]
            pz += share * v[p, 2]
            fx += push * body[g, 0] + stress[p, 0] * gx + stress[p, 3] * gy + stress[p, 5] * gz
            fy += push * body[g, 1] + stress[p, 3] * gx + stress[p, 1] * gy + stress[p, 4] * gz
            fz += push * body[g, 2] + stress[p, 5] * gx + stress[p, 4] * gy + stress[p, 2] * gz
        store(records, 8 * a, pack(px, py, pz, m, fx, fy, fz, 0.0))


@kernel
def vertices_to_nodes(ax, ay, az, ny, nz, nodes, slabs, start, stop, pointer, order, x, records):
    """Each vertex hands its record to the nodes of its cell with S_i(x_a) (S 23, 25)."""
    for q in range(start, stop):
        for r in range(pointer[slabs[q]], pointer[slabs[q] + 1]):
            a = order[r]
            record = load(records, 8 * a)
            bx, wx, _ = row(ax, x[a, 0], 0.0)
            by, wy, _ = row(ay, x[a, 1], 0.0)
            bz, wz, _ = row(az, x[a, 2], 0.0)
            for i in range(len(wx)):
                for j in range(len(wy)):
                    line = scale(wx[i] * wy[j], record)
                    n = (((bx + i) * ny + by + j) * nz + bz) * 8
                    for k in range(len(wz)):
                        store(nodes, n, fma(wz[k], line, load(nodes, n)))
                        n += 8


@kernel
def nodes_to_vertices(ax, ay, az, ny, nz, nodes, start, stop, points, x, records):
    """The nodes' velocity and increment at vertices points[start:stop]: sum_i S_i(x_a) (S 17)."""
    for q in range(start, stop):
        a = points[q]
        bx, wx, _ = row(ax, x[a, 0], 0.0)
        by, wy, _ = row(ay, x[a, 1], 0.0)
        bz, wz, _ = row(az, x[a, 2], 0.0)
        value = zero()
        for i in range(len(wx)):
            for j in range(len(wy)):
                n = (((bx + i) * ny + by + j) * nz + bz) * 8
                line = zero()
                for k in range(len(wz)):
                    line = fma(wz[k], load(nodes, n), line)
                    n += 8
                value = fma(wx[i] * wy[j], line, value)
        store(records, 8 * a, value)


@kernel
def vertices_to_particles(
    start, stop, corners, count, weights, records, v, x, x_next, gradient, dt, flip, move, differentiate
):
    """Velocity and position (S 13, 14) if ``move``, velocity gradient (S 15) if ``differentiate``."""
    for p in range(start, stop):
        value, along_x, along_y, along_z = zero(), zero(), zero(), zero()
        for c in range(count[p]):
            record = load(records, 8 * corners[p, c])
            value = fma(weights[p, c, 0], record, value)
            along_x = fma(weights[p, c, 1], record, along_x)
            along_y = fma(weights[p, c, 2], record, along_y)
            along_z = fma(weights[p, c, 3], record, along_z)
        for a in range(3):
            if move:
                v[p, a] = flip * (v[p, a] + lane(value, a + 4)) + (1.0 - flip) * lane(value, a)
                x_next[p, a] = x[p, a] + dt * lane(value, a)
            if differentiate:
                gradient[p, a, 0] = lane(along_x, a)
                gradient[p, a, 1] = lane(along_y, a)
                gradient[p, a, 2] = lane(along_z, a)


@kernel
def move_vertices(start, stop, records, x, x_next, dt):
    """Corners move with the grid velocity: x_a += dt sum_i S_i(x_a) v_i (S, section 3)."""
    for a in range(start, stop):
        for k in range(3):
            x_next[a, k] = x[a, k] + dt * records[8 * a + k]

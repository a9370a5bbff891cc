"""The equation of motion at the nodes, and the conditions on it."""

from __future__ import annotations

from matpoint.jit import device, kernel
from matpoint.kernels.vector import store, zero


@device
def _sign(x):
    return 1.0 if x > 0.0 else (-1.0 if x < 0.0 else 0.0)


@kernel
def clear(nodes, start, stop, ny, nz, first, last):
    """Empty the records of planes start:stop, within the block of nodes from ``first`` to ``last``."""
    for i in range(start, stop):
        for j in range(first[1], last[1]):
            row = (i * ny + j) * nz
            for n in range(row + first[2], row + last[2]):
                store(nodes, 8 * n, zero())


@device
def _move(nodes, n, dt, mass_damping, local_damping):
    m = nodes[n + 3]
    if m > 0.0:
        inverse = 1.0 / m
        for a in range(n, n + 3):
            v, f = nodes[a] * inverse, nodes[a + 4]
            f -= local_damping * abs(f) * _sign(v)
            increment = (f * inverse - mass_damping * v) * dt
            nodes[a] = v + increment
            nodes[a + 4] = increment
    else:
        for a in range(n, n + 3):
            nodes[a] = 0.0
            nodes[a + 4] = 0.0


@kernel
def solve(nodes, start, stop, ny, nz, first, last, dt, mass_damping, local_damping):
    """Turn (momentum, mass, force) into (velocity at the end, mass, increment): S 2, 5, 11, 12.

    Of planes start:stop, within the block of nodes from ``first`` to ``last``. ``mass_damping`` [1/s] takes
    rate * v off the acceleration; ``local_damping`` (Cundall) takes that share of the unbalanced force,
    against the velocity. A node without mass stays at rest: exact zeros only, since a node that sees a
    sliver has mass and stiffness vanishing together.
    """
    for i in range(start, stop):
        for j in range(first[1], last[1]):
            row = (i * ny + j) * nz
            for n in range(row + first[2], row + last[2]):
                _move(nodes, 8 * n, dt, mass_damping, local_damping)


@kernel
def constrain(nodes, index, points, normal, before, after, flip, reaction):
    """Set the velocity along ``normal`` at the listed nodes to ``before`` and ``after`` the step.

    Both ends of the step obey the condition, so that the increment, which FLIP hands to the
    particles, is that of the prescribed motion. Normals of one node must be orthogonal; they are
    applied one after the other. ``reaction`` gathers the impulse [N s] (3) on the body, its work
    [J] (1) and the impulse of its moment about the origin [N m s] (3); ``points`` are the nodes'
    positions.
    """
    for c in range(index.shape[0]):
        n = index[c]
        m = nodes[n, 3]
        if m <= 0.0:
            continue
        gap_before, gap_after = -before[c], -after[c]
        for a in range(3):
            gap_before += (nodes[n, a] - nodes[n, a + 4]) * normal[c, a]
            gap_after += nodes[n, a] * normal[c, a]
        # FLIP particles feel the increment's change, PIC particles the velocity's.
        push = -m * (flip * (gap_after - gap_before) + (1.0 - flip) * gap_after)
        reaction[3] += push * 0.5 * (before[c] + after[c])
        for a in range(3):
            nodes[n, a] -= gap_after * normal[c, a]
            nodes[n, a + 4] -= (gap_after - gap_before) * normal[c, a]
            reaction[a] += push * normal[c, a]
            b, d = (a + 1) % 3, (a + 2) % 3
            reaction[4 + a] += push * (points[c, b] * normal[c, d] - points[c, d] * normal[c, b])

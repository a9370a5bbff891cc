"""What the loads have given to the particles: impulse, work and moment."""

from __future__ import annotations

from matpoint.jit import kernel


@kernel
def book_loads(mass, body, before, after, dt, external):
    """Add impulse (3) [N s], work (1) [J] and impulse of moments (3) [N m s] of one step.

    ``body`` is the force per mass, (n, 3) or (1, 3). One thread, in order: the sum is always the same.
    """
    px, py, pz, work, mx, my, mz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for p in range(mass.shape[0]):
        g = p if body.shape[0] > 1 else 0
        fx, fy, fz = mass[p] * body[g, 0], mass[p] * body[g, 1], mass[p] * body[g, 2]
        x, y, z = before[p, 0], before[p, 1], before[p, 2]
        px, py, pz = px + fx, py + fy, pz + fz
        work += fx * (after[p, 0] - x) + fy * (after[p, 1] - y) + fz * (after[p, 2] - z)
        mx, my, mz = mx + y * fz - z * fy, my + z * fx - x * fz, mz + x * fy - y * fx
    external[0] += dt * px
    external[1] += dt * py
    external[2] += dt * pz
    external[3] += work
    external[4] += dt * mx
    external[5] += dt * my
    external[6] += dt * mz

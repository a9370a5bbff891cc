"""Sums over particles for the ledger, block by block.

Blocks have a fixed number of particles and a row of partial sums each, so the result is the same to
the last bit however many threads there are.
"""

from __future__ import annotations

from matpoint.jit import summing_kernel


@summing_kernel
def sum_motion(start, stop, block, mass, position, velocity, sums):
    """Sum mass [kg], momentum (3), angular momentum (3) and m v.v (8 numbers) of particles start to stop.

    ``start`` is a multiple of ``block``; sums (blocks, 8) takes a row for each.
    """
    for first in range(start, stop, block):
        m, px, py, pz, mx, my, mz, twice = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        for p in range(first, min(first + block, stop)):
            x, y, z = position[p, 0], position[p, 1], position[p, 2]
            vx, vy, vz = velocity[p, 0], velocity[p, 1], velocity[p, 2]
            w = mass[p]
            m += w
            px, py, pz = px + w * vx, py + w * vy, pz + w * vz
            mx, my, mz = mx + w * (y * vz - z * vy), my + w * (z * vx - x * vz), mz + w * (x * vy - y * vx)
            twice += w * (vx * vx + vy * vy + vz * vz)
        row = first // block
        sums[row, 0], sums[row, 7] = m, twice
        sums[row, 1], sums[row, 2], sums[row, 3] = px, py, pz
        sums[row, 4], sums[row, 5], sums[row, 6] = mx, my, mz


@summing_kernel
def sum_moments(start, stop, block, mass, moment, sums):
    """Sum what APIC's B = sum w v (x_i - x_p)^T adds to the angular momentum: sums (blocks, 3)."""
    for first in range(start, stop, block):
        mx, my, mz = 0.0, 0.0, 0.0
        for p in range(first, min(first + block, stop)):
            w = mass[p]
            mx += w * (moment[p, 2, 1] - moment[p, 1, 2])
            my += w * (moment[p, 0, 2] - moment[p, 2, 0])
            mz += w * (moment[p, 1, 0] - moment[p, 0, 1])
        row = first // block
        sums[row, 0], sums[row, 1], sums[row, 2] = mx, my, mz


@summing_kernel
def sum_loads(block, mass, body, before, after, sums):
    """Sum force (3) [N], work (1) [J] and moment (3) [N m] of the loads: sums (blocks, 7).

    ``body`` is the force per mass [m/s^2], (n, 3) or (1, 3); ``before`` and ``after`` are positions at
    both ends of the step.
    """
    for first in range(0, mass.shape[0], block):
        px, py, pz, work, mx, my, mz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        for p in range(first, min(first + block, mass.shape[0])):
            g = p if body.shape[0] > 1 else 0
            fx, fy, fz = mass[p] * body[g, 0], mass[p] * body[g, 1], mass[p] * body[g, 2]
            x, y, z = before[p, 0], before[p, 1], before[p, 2]
            px, py, pz = px + fx, py + fy, pz + fz
            work += fx * (after[p, 0] - x) + fy * (after[p, 1] - y) + fz * (after[p, 2] - z)
            # In brackets, so that each sum waits for one addition a particle only.
            mx, my, mz = mx + (y * fz - z * fy), my + (z * fx - x * fz), mz + (x * fy - y * fx)
        row = first // block
        sums[row, 0], sums[row, 1], sums[row, 2], sums[row, 3] = px, py, pz, work
        sums[row, 4], sums[row, 5], sums[row, 6] = mx, my, mz

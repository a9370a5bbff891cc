"""Fields and kernels of the step in Taichi or Quadrants (see ``taichi_step``)."""

# Annotations must be objects: the packages read them. So no "from __future__ import annotations" here.

from collections.abc import Callable
from typing import Any

import numpy as np

from matpoint.bench.block import (
    COURANT,
    DENSITY,
    GRAVITY,
    MARGIN,
    MODULUS,
    OFFSET,
    PER_CELL,
    POISSON,
    WAVE,
    velocity,
)

_TASK = 128  # particles that one task takes


def particles(cells: int) -> tuple[np.ndarray, np.ndarray]:
    """Return positions [m] and velocities [m/s] of the block in order of cell, (n, 3) each."""
    side = cells * PER_CELL[3]
    line = (np.arange(side) + 0.5) / side
    x = np.stack([a.ravel() for a in np.meshgrid(line, line, line, indexing="ij")], axis=1)
    cell = np.floor(x * cells + MARGIN + OFFSET).astype(int)
    x = x[np.lexsort(cell.T[::-1])]
    return x, velocity(x)


class Block:
    """The block's fields, and the numbers that kernels take as constants.

    Parameters
    ----------
    ti
        The package, initialised.
    cells
        Along the block's side.
    """

    def __init__(self, ti: Any, cells: int) -> None:
        x, v = particles(cells)
        count, n, h = len(x), cells + 2 * MARGIN + 3, 1.0 / cells
        self.lower, self.inverse, self.dt = -(MARGIN + OFFSET) * h, 1.0 / h, COURANT * h / WAVE
        self.volume0, self.mass = 1.0 / count, DENSITY / count
        self.shear = MODULUS / (2 * (1 + POISSON))
        self.lame = MODULUS * POISSON / ((1 + POISSON) * (1 - 2 * POISSON))
        self.x, self.v = (ti.Vector.field(3, ti.f64, count) for _ in range(2))
        self.F, self.stress = (ti.Matrix.field(3, 3, ti.f64, count) for _ in range(2))
        self.volume = ti.field(ti.f64, count)
        # Momentum, then velocity; force, then increment; mass.
        self.grid_v, self.grid_a = (ti.Vector.field(3, ti.f64, (n, n, n)) for _ in range(2))
        self.grid_m = ti.field(ti.f64, (n, n, n))
        self.x.from_numpy(x)
        self.v.from_numpy(v)
        self.F.from_numpy(np.tile(np.eye(3), (count, 1, 1)))
        self.volume.fill(self.volume0)


def make_rows(ti: Any, b: Block) -> Any:
    """Return a function of x: first node, weights and slopes of three splines along each axis."""

    @ti.func
    def rows(x):
        r = (x - b.lower) * b.inverse
        base = r.cast(int)
        f = r - base
        w = ti.Matrix.rows([0.5 * (1 - f) ** 2, 0.5 + f * (1 - f), 0.5 * f**2])
        d = ti.Matrix.rows([(f - 1) * b.inverse, (1 - 2 * f) * b.inverse, f * b.inverse])
        return base, w, d

    return rows


def make_particles_to_nodes(ti: Any, b: Block, rows: Any) -> Any:
    """Return the kernel of mass, momentum and forces to the nodes."""

    @ti.kernel
    def particles_to_nodes():
        ti.loop_config(block_dim=_TASK)
        for p in b.x:
            base, w, d = rows(b.x[p])
            pull, weight_force = -b.volume[p] * b.stress[p], ti.Vector([0.0, -b.mass * GRAVITY, 0.0])
            for i, j, k in ti.static(ti.ndrange(3, 3, 3)):
                weight = w[i, 0] * w[j, 1] * w[k, 2]
                slope = ti.Vector(
                    [d[i, 0] * w[j, 1] * w[k, 2], w[i, 0] * d[j, 1] * w[k, 2], w[i, 0] * w[j, 1] * d[k, 2]]
                )
                node = base + ti.Vector([i, j, k])
                b.grid_m[node] += weight * b.mass
                b.grid_v[node] += weight * b.mass * b.v[p]
                b.grid_a[node] += pull @ slope + weight * weight_force

    return particles_to_nodes


def make_solve(ti: Any, b: Block) -> Any:
    """Return the kernel of the nodes' velocities and increments."""

    @ti.kernel
    def solve():
        for node in ti.grouped(b.grid_m):
            if b.grid_m[node] > 0:
                b.grid_a[node] *= b.dt / b.grid_m[node]
                b.grid_v[node] = b.grid_v[node] / b.grid_m[node] + b.grid_a[node]

    return solve


def make_nodes_to_particles(ti: Any, b: Block, rows: Any) -> Any:
    """Return the kernel of velocity, position, F and stress of the particles."""

    @ti.kernel
    def nodes_to_particles():
        ti.loop_config(block_dim=_TASK)
        for p in b.x:
            base, w, d = rows(b.x[p])
            new_v, gain, L = (
                ti.Vector.zero(ti.f64, 3),
                ti.Vector.zero(ti.f64, 3),
                ti.Matrix.zero(ti.f64, 3, 3),
            )
            for i, j, k in ti.static(ti.ndrange(3, 3, 3)):
                weight = w[i, 0] * w[j, 1] * w[k, 2]
                slope = ti.Vector(
                    [d[i, 0] * w[j, 1] * w[k, 2], w[i, 0] * d[j, 1] * w[k, 2], w[i, 0] * w[j, 1] * d[k, 2]]
                )
                node = base + ti.Vector([i, j, k])
                new_v += weight * b.grid_v[node]
                gain += weight * b.grid_a[node]
                L += b.grid_v[node].outer_product(slope)
            b.v[p] += gain
            b.x[p] += b.dt * new_v
            F = b.F[p] + b.dt * (L @ b.F[p])
            J = F.determinant()
            one = ti.Matrix.identity(ti.f64, 3)
            b.F[p], b.volume[p] = F, J * b.volume0
            b.stress[p] = (b.lame * ti.log(J) * one + b.shear * (F @ F.transpose() - one)) / J

    return nodes_to_particles


def make_step(ti: Any, b: Block) -> Callable[[], None]:
    """Return a function that makes one step."""
    rows = make_rows(ti, b)
    gather, solve = make_particles_to_nodes(ti, b, rows), make_solve(ti, b)
    scatter = make_nodes_to_particles(ti, b, rows)

    def step() -> None:
        for field in (b.grid_m, b.grid_v, b.grid_a):
            field.fill(0.0)
        gather()
        solve()
        scatter()

    return step

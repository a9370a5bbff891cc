"""Small runs that several tests share."""

from __future__ import annotations

import numpy as np

import matpoint as mp
from matpoint.materials import NeoHookean

RUBBER = NeoHookean(E=1e6, nu=0.3, density=1000.0)
SOFT = NeoHookean(E=5e5, nu=0.2, density=800.0)


def spinning_block(interpolation, dim=2, *, scheme=None, spin=5.0, drift=0.7, cells=8, **options):
    """A block that flies and spins freely in the middle of its grid."""
    size = 1.0 / cells
    grid = mp.Grid((-1.0,) * dim, (1.0,) * dim, size * 2)
    centre = np.zeros(3)

    def velocity(x):
        v = np.zeros_like(x)
        v[:, 0] = drift
        if dim > 1:
            v[:, 0] -= spin * (x[:, 1] - centre[1])
            v[:, 1] += spin * (x[:, 0] - centre[0])
        return v

    half = (0.5,) * dim
    body = mp.Body(mp.Box(tuple(-h for h in half), half), RUBBER, per_cell=2, velocity=velocity)
    options.setdefault("timestep", mp.FixedStep(2e-4))
    options.setdefault("threads", 1)
    return mp.Simulation(grid, [body], interpolation=interpolation, scheme=scheme, **options)


def two_blocks(interpolation, dim=2, *, scheme=None, speed=2.0, **options):
    """Two blocks of different stiffness that run into each other."""
    grid = mp.Grid((0.0,) * dim, (2.0,) + (1.0,) * (dim - 1), 0.125)
    low, high = (0.25,) * (dim - 1), (0.75,) * (dim - 1)
    bodies = [
        mp.Body(mp.Box((0.3125, *low), (0.875, *high)), RUBBER, velocity=(speed,), name="left"),
        mp.Body(mp.Box((1.0, *low), (1.5, *high)), SOFT, velocity=(-speed,), name="right"),
    ]
    options.setdefault("timestep", mp.FixedStep(2e-4))
    options.setdefault("threads", 1)
    return mp.Simulation(grid, bodies, interpolation=interpolation, scheme=scheme, **options)


def advance(sim, steps):
    """Make some steps of the simulation's own length."""
    for _ in range(steps):
        sim.advance(sim.dt)
    return sim

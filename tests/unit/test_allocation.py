"""A step makes no array of the particles' size."""

from __future__ import annotations

import tracemalloc

import pytest

import matpoint as mp
from matpoint.interpolation import METHODS
from runs import RUBBER


@pytest.mark.parametrize("method", ["mpm", "bspline2", "cpgimp", "cpdi1", "cpdi2"])
def test_a_step_allocates_nothing_large(method):
    grid = mp.Grid((-1.0, -1.0), (2.0, 2.0), 1.0 / 32)
    body = mp.Body(mp.Box((0.0, 0.0), (1.0, 1.0)), RUBBER, per_cell=4, velocity=(0.1, 0.0))
    sim = mp.Simulation(
        grid, [body], interpolation=METHODS[method], timestep=mp.CFL(0.2), threads=1,
        loads=[mp.Gravity((0.0, -1.0))], sort_every=1000, sample_every=1000,
    )  # fmt: skip
    sim.advance(sim.dt)
    tracemalloc.start()
    try:
        for _ in range(20):
            sim.advance(sim.dt)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert len(sim.particles) == 16384
    assert peak < 8 * len(sim.particles) / 2  # half of one number a particle

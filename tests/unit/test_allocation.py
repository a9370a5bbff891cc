"""A step makes no array of the particles' size, nor of the nodes' or of quadrature points'."""

from __future__ import annotations

import tracemalloc
from statistics import median

import pytest

import matpoint as mp
from matpoint.interpolation import METHODS
from runs import RUBBER


def _peak(dim, method, scheme, shape, cells, per_cell):
    """Bytes that a step has at once beyond what there was before it, and the number of particles.

    Of seven steps the median: whatever is made once, as when code is loaded, is no part of a step.
    """
    grid = mp.Grid((-1.0,) * dim, (2.0,) * dim, 1.0 / cells)
    body = mp.Body(shape, RUBBER, per_cell=per_cell, velocity=(0.1,) + (0.0,) * (dim - 1))
    sim = mp.Simulation(
        grid, [body], interpolation=method, scheme=scheme, timestep=mp.CFL(0.2), threads=1,
        loads=[mp.Gravity((0.0, -1.0, 0.0)[:dim])], sort_every=1000, sample_every=1000,
    )  # fmt: skip
    sim.advance(sim.dt)
    peaks = []
    tracemalloc.start()
    try:
        for _ in range(7):
            before = tracemalloc.get_traced_memory()[0]
            tracemalloc.reset_peak()
            sim.advance(sim.dt)
            peaks.append(tracemalloc.get_traced_memory()[1] - before)
    finally:
        tracemalloc.stop()
    return median(peaks), len(sim.particles)


SQUARE, CUBE, DISC = mp.Box((0.0, 0.0), (1.0, 1.0)), mp.Box((0.0,) * 3, (1.0,) * 3), mp.Ball((0.5, 0.5), 0.5)
SPACE = [mp.IMLS(degree=1, points=1), mp.SplineIMLS(degree=2)]
SERIES = [mp.USL(mp.XPIC(3)), mp.USL(mp.FMPM(3)), mp.MUSL(mp.FMPM(2))]


@pytest.mark.parametrize("method", ["mpm", "bspline2", "cpgimp", "cpdi1", "cpdi2"])
def test_a_step_allocates_nothing_large(method):
    peak, particles = _peak(2, METHODS[method], mp.USL(), SQUARE, 32, 4)
    assert particles == 16384
    assert peak < 8 * particles / 2  # half of one number a particle


@pytest.mark.parametrize("scheme", SERIES)
@pytest.mark.parametrize("method", ["mpm", "cpdi2", "imls"])
def test_neither_does_a_series(method, scheme):
    peak, particles = _peak(2, METHODS[method], scheme, SQUARE, 32, 4)
    assert peak < 8 * particles / 2


@pytest.mark.parametrize("shape", [SQUARE, DISC], ids=["whole cells", "cut cells"])
@pytest.mark.parametrize("method", ["imls", "mls", "spline-imls", "tls"])
def test_neither_does_a_reconstruction(method, shape):
    peak, particles = _peak(2, METHODS[method], mp.USL(), shape, 32, 4)
    assert particles > 12000
    assert peak < 8 * particles / 2


@pytest.mark.parametrize("method", SPACE, ids=lambda m: m.name)
def test_neither_does_a_reconstruction_in_space(method):
    peak, particles = _peak(3, method, mp.USL(), CUBE, 6, 4)
    assert particles == 13824
    assert peak < 8 * particles / 2

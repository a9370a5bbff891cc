"""Forecasts of memory against the arrays of real runs, and refusal of what is too large."""

from __future__ import annotations

import numpy as np
import pytest

import matpoint as mp
from matpoint import footprint, memory
from matpoint.case import build_forecast, build_simulation, load
from matpoint.errors import InputError
from matpoint.forecast import forecast
from matpoint.interpolation import METHODS
from runs import RUBBER


def _ball(method, cells, dim):
    """A ball, and a block beside it."""
    grid = mp.Grid((-0.25,) * dim, (1.75,) + (1.25,) * (dim - 1), 1.0 / cells)
    bodies = [
        mp.Body(mp.Ball((0.5,) * dim, 0.5), RUBBER),
        mp.Body(mp.Box((1.1,) + (0.0,) * (dim - 1), (1.4,) + (1.0,) * (dim - 1)), RUBBER),
    ]
    return mp.Simulation(grid, bodies, interpolation=METHODS[method], timestep=mp.CFL(), threads=1)


@pytest.mark.parametrize("method", ["mpm", "cpgimp", "cpdi1", "cpdi2", "imls"])
def test_forecast_agrees_with_the_arrays_of_a_run(method):
    sim = _ball(method, 48, 2)
    sim.advance(sim.dt)
    real = {"nodes": 0.0}
    for group, _, array in footprint.held(sim):
        real[group] = real.get(group, 0.0) + array.nbytes
    need = forecast(sim.grid, sim.bodies, sim.interpolation)
    assert need.particles.count == pytest.approx(len(sim.particles), rel=0.03)
    assert need.nodes.count == sim.engine.mapping.nodes.on_grid
    assert need.nodes.count * need.nodes.bytes_each["records"] == pytest.approx(real.pop("nodes"), rel=0.01)
    for group, size in real.items():
        found = need.particles.count * need.particles.bytes_each.get(group, 0.0)
        found += need.nodes.count * need.nodes.bytes_each.get(group, 0.0)
        assert found == pytest.approx(size, rel=0.06), group


def test_arrays_that_share_memory_count_once():
    sim = _ball("cpdi2", 8, 2)
    arrays = [array for _, _, array in footprint.held(sim)]
    assert len({id(a) for a in arrays}) == len(arrays)
    assert all(a.base is None or not isinstance(a.base, np.ndarray) for a in arrays)
    assert any(array is sim.particles.position for array in arrays)


def test_results_count_what_writing_them_takes():
    plain = build_forecast(load("cantilever", ["output={}"])).particles.bytes_each
    both = ["output={vtk={every_steps=10}, checkpoint={every_steps=10}}"]
    written = build_forecast(load("cantilever", both)).particles.bytes_each
    assert "results" not in plain
    assert written["results"] > 200
    assert {k: v for k, v in written.items() if k != "results"} == plain


def test_what_does_not_fit_is_refused_with_sizes_and_help(monkeypatch):
    monkeypatch.setattr("matpoint.forecast.free_memory", lambda: 1e5)
    with pytest.raises(InputError, match=r"particles of \d+ bytes .* 0.0001 GB free; use a smaller per_cell"):
        build_simulation(load("cantilever", []))


def test_free_memory_is_what_linux_says_or_all_that_there_is(monkeypatch):
    assert 1e6 < memory.free_memory() < 1e14

    def missing(*_, **__):
        raise FileNotFoundError

    monkeypatch.setattr("builtins.open", missing)
    assert 1e8 < memory.free_memory() < 1e14

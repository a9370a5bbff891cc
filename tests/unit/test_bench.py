"""The benchmark's parts: model, table, options, native program, rivals. Timings are never judged."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from matpoint import USL, BSpline, FixedStep, InputError, Simulation
from matpoint.bench import BenchOptions, run_bench, table
from matpoint.bench.block import METHODS, block, cells_for, enriched_layer
from matpoint.bench.measure import Row
from matpoint.bench.model import TABLES, bytes_per_stage, operations_per_stage
from matpoint.bench.native import Native, NativeError, parse, source_path
from matpoint.bench.results import ratio
from matpoint.bench.rivals import _measure, installed, measure_rivals
from matpoint.bench.scale import draw_scale, run_scale, scale_table
from matpoint.bench.taichi_kernels import particles
from matpoint.bench.triad import triad, triad_gbs


@pytest.fixture(scope="module")
def native(tmp_path_factory):
    try:
        return Native(tmp_path_factory.mktemp("native"))
    except NativeError as error:
        pytest.skip(str(error))


def test_cells_and_particles():
    # 58^3 and 447^2 particles are the cubes of whole cells nearest to 2e5
    assert (cells_for(200_000, 3), cells_for(200_000, 2)) == (29, 149)
    assert cells_for(1, 3) == 1
    rows = {dim: Row("linear", dim, 500, 1) for dim in (2, 3)}
    assert {dim: row.particles for dim, row in rows.items()} == {2: 441, 3: 512}


@pytest.mark.parametrize("dim", [2, 3])
def test_about_one_vertex_in_twenty_is_enriched(dim):
    cells = cells_for(200_000, dim)
    lower, upper = enriched_layer(dim, cells).bounds()
    side = cells * {2: 3, 3: 2}[dim]
    planes = np.arange(side + 1) / side
    inside = ((planes >= lower[0]) & (planes <= upper[0])).mean()
    assert 0.045 < inside < 0.055
    row = Row("enriched-cpdi2", dim, 2000, 1)
    assert 0.0 < row.enriched < 0.1


def test_model_names_stages_that_exist_and_every_method_but_the_reconstructions():
    stages = {stage.name for stage in USL().stages}
    assert set(METHODS) - set(TABLES) == {"imls", "imls-1-point", "imls-2-points"}
    for name in TABLES:
        idle = {"conditions"} | (
            {"advance"} if name in ("linear", "ugimp", "bspline2", "bspline3") else set()
        )
        assert set(bytes_per_stage(name, 3)) == stages - idle
    assert bytes_per_stage("imls", 3) == {}


def test_model_by_hand():
    # 24 B to look at the bounds and the slab; slab and order written, slab read
    linear = bytes_per_stage("linear", 3)
    assert linear["locate"] == 24 + 3 * 4
    assert linear["clear"] == 64 / 8
    assert linear["nodes to particles and stress"] == 4 * 24 + 8 + 64 / 8 + 4 + 72 + 8 + 72 + 8 + 48
    assert linear["particles to nodes"] == 4 + 24 + 24 + 8 + 8 + 48 + 2 * 64 / 8
    assert bytes_per_stage("bspline2", 2)["clear"] == pytest.approx(64 / 9)
    one, two = (bytes_per_stage(name, 3)["particles to nodes"] for name in ("cpdi1", "cpdi2"))
    assert one == linear["particles to nodes"] + 72
    assert two == 32 + 1 + 256 + 24 + 8 + 8 + 48 + 4 + 24 + 2 * 64 + 2 * 8


def test_operations_by_hand():
    # 27 nodes in nine lines of three planes: 3 x 4 + 9 x 3 + 27 x 2 records of eight lanes
    assert operations_per_stage("bspline2", 3)["particles to nodes"] == 8 * 93
    assert operations_per_stage("linear", 2)["particles to nodes"] == 8 * (4 * 2 + 3 * 4 + 2 * 4)
    assert operations_per_stage("cpdi2", 3)["particles to nodes"] == 8 * (4 + 8) + 32 * 8
    assert operations_per_stage("imls", 3) == {}
    for name in TABLES:
        assert set(operations_per_stage(name, 3)) <= set(bytes_per_stage(name, 3))


def test_triad_adds_and_measures():
    a, b, c = np.zeros(5), np.arange(5.0), np.full(5, 2.0)
    triad(a, b, c, 0.5, 1, 4)
    assert a.tolist() == [0.0, 2.0, 3.0, 4.0, 0.0]
    assert triad_gbs(2, elements=10_000, rounds=1) > 0.0


def test_stages_add_up_to_the_step():
    row = Row("linear", 3, 64, 1)
    for _ in range(3):
        row.measure()
    row.finish()
    stages = row.stages_ns()
    assert list(stages) == [*(s.name for s in USL().stages), "sort", "rest"]
    assert sum(stages.values()) == pytest.approx(float(np.median(row.steps_ns)))
    assert all(ns >= 0.0 for ns in stages.values())


def test_ratio_is_that_within_a_round():
    # a machine that is slow in the second round changes nothing
    assert ratio([2.0, 20.0, 2.2], [1.0, 10.0, 1.1]) == pytest.approx(2.0)


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        ({"particles": 0}, "particles"),
        ({"particles": True}, "particles"),
        ({"particles": 10**9}, "at most"),
        ({"methods": ("cpid2",)}, "did you mean 'cpdi2'"),
        ({"methods": ()}, "one or more"),
        ({"methods": ("linear", "linear")}, "each once"),
        ({"dims": (1,)}, "2 and 3"),
        ({"threads": (0,)}, "threads"),
        ({"threads": (5000,)}, "1024"),
        ({"rounds": 0}, "rounds"),
    ],
)
def test_options_refuse(wrong, words):
    with pytest.raises(InputError, match=words):
        BenchOptions(**wrong)


def test_source_is_there_and_parse_refuses():
    assert "particles_to_nodes" in source_path().read_text(encoding="utf-8")
    whole = {"particles": 8, "steps": 1, "seconds": [0.1], "stages": {}, "sum": {}}
    assert parse(json.dumps(whole)) == whole
    for text in ("", "no JSON", "[]", json.dumps(whole | {"seconds": [0.0]}), json.dumps({"particles": 8})):
        with pytest.raises(NativeError):
            parse(text)


def test_no_compiler_is_said(monkeypatch, tmp_path):
    monkeypatch.setenv("CXX", "no-such-compiler -O3")
    with pytest.raises(NativeError, match="no-such-compiler"):
        Native(tmp_path)
    monkeypatch.delenv("CXX")
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(NativeError, match=r"no C\+\+ compiler"):
        Native(tmp_path)


def final_state(cells: int, steps: int) -> np.ndarray:
    """x and v of the block after some steps of the package, in order of the lattice."""
    grid, body, gravity, dt = block(3, cells)
    sim = Simulation(
        grid, [body], interpolation=BSpline(2), timestep=FixedStep(dt), loads=[gravity], threads=1
    )
    for _ in range(steps):
        sim.advance(dt)
    p = sim.particles
    x0 = np.round(p.ordered("position0") * 2 * cells - 0.5).astype(int)
    order = np.lexsort(x0.T[::-1])
    return np.concatenate([p.ordered("position"), p.ordered("velocity")], axis=1)[order]


@pytest.mark.parametrize(("cells", "steps"), [(1, 3), (4, 60)])
def test_native_makes_the_same_steps(native, tmp_path, cells, steps):
    """Sums in another order, and fast-math: so to 1e-10, with velocities of 1 and stresses of 1e4."""
    dump = tmp_path / "state"
    found = native.run(cells, steps, 1, dump)
    state = np.fromfile(dump).reshape(-1, 6)
    ours = final_state(cells, steps)
    assert state.shape == ours.shape == (found["particles"], 6)
    assert np.abs(state - ours).max() < 1e-10
    assert found["sum"]["v"] == pytest.approx(ours[:, 3:].sum(), rel=1e-10)
    grid, body, _, _ = block(3, cells)
    start = body.initial_velocity(body.domains(grid).centroids(), 3)
    assert np.abs(ours[:, 3:].mean(axis=0) - start.mean(axis=0)).max() > 1e-4  # they have fallen meanwhile


def test_native_refuses_nonsense(native):
    with pytest.raises(NativeError, match="code 2"):
        native.run(0, 1)


def test_taichi_begins_with_the_same_block():
    x, v = particles(3)
    grid, body, _, _ = block(3, 3)
    sim = Simulation(grid, [body], interpolation=BSpline(2), timestep=FixedStep(1e-4), threads=1)
    p = sim.particles
    np.testing.assert_allclose(x, p.position, atol=1e-14)
    np.testing.assert_allclose(v, p.velocity, atol=1e-14)


@pytest.mark.skipif(not installed(), reason="neither taichi nor quadrants is installed")
def test_taichi_makes_the_same_steps(native):
    found = _measure(installed()[0], 3, 5, 1, 1)
    ours = native.run(3, 7)["sum"]  # two steps to compile, then five
    assert found["sum"] == pytest.approx({name: ours[name] for name in ("x", "v")}, rel=1e-10)


def test_absence_of_taichi_is_reported(monkeypatch):
    monkeypatch.setattr("matpoint.bench.rivals.PACKAGES", ("no_such_package",))
    found, notes = measure_rivals(2, 1, 1, [1])
    assert found is None
    assert len(notes) == 1
    assert "installed" in notes[0]


def test_a_whole_run_and_its_table():
    options = BenchOptions(64, ("linear", "bspline2"), (2, 3), (1, 2), 1, 10_000, rivals=False)
    said = []
    result = run_bench(options, said.append)
    assert [(r["interpolation"], r["dim"], r["threads"]) for r in result["rows"]] == [
        (name, dim, threads) for dim in (2, 3) for name in ("linear", "bspline2") for threads in (1, 2)
    ]
    for row in result["rows"]:
        assert row["mps_min"] <= row["mps"] <= row["mps_max"]
        assert sum(stage["share"] for stage in row["stages"].values()) == pytest.approx(1.0)
        assert (row["cost"] == 1.0) == (row["interpolation"] == "linear")
        assert (row["speed_up"] == 1.0) == (row["threads"] == 1)
    text = table(result)
    assert text.count("bspline2") >= 8
    assert "triad" in text
    assert any("setting up" in line for line in said)
    json.dumps(result, allow_nan=False)
    without = table({**result, "native": None, "taichi": None, "notes": ["native: no C++ compiler"]})
    assert "note: native: no C++ compiler" in without


def test_little_memory_makes_batches_with_the_reference(monkeypatch):
    monkeypatch.setattr("matpoint.bench.suite.free_memory", lambda: 1000)
    options = BenchOptions(27, ("bspline2", "linear", "ugimp"), (2,), (1,), 1, 1000, rivals=False)
    rows = run_bench(options)["rows"]
    assert [row["interpolation"] for row in rows] == ["bspline2", "linear", "ugimp"]
    assert all(row["cost"] > 0 for row in rows)
    alone = run_bench(replace(options, methods=("ugimp",)))["rows"]
    assert [row["cost"] for row in alone] == [None]


def test_scale_table_and_figure(tmp_path, monkeypatch):
    row = {
        "interpolation": "linear", "threads": 1, "ns": 50.0, "ns_min": 49.0, "ns_max": 52.0,
        "bytes_held": 400.0, "bytes_setup": 600.0, "bytes_peak": 600.0,
    }  # fmt: skip
    monkeypatch.setattr("matpoint.bench.scale._fresh", lambda m, n, t, r: {**row, "particles": n})
    monkeypatch.setattr("matpoint.bench.scale.free_memory", lambda: 100_000)
    result = run_scale((1000, 100, 10), ("linear",), (1,))
    assert [r["particles"] for r in result["rows"]] == [10, 100]
    assert "1000 particles left out" in scale_table(result)
    draw_scale(result, tmp_path / "scale.png")
    assert (tmp_path / "scale.png").stat().st_size > 1000
    monkeypatch.setattr("matpoint.bench.scale._fresh", lambda *_: "its process ended with code -9")
    assert "code -9" in scale_table(run_scale((10,), ("linear",), (1,)))
    with pytest.raises(InputError, match="at least one"):
        run_scale(())

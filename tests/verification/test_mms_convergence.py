"""What methods must show on manufactured solutions; numbers are measurements that are meant to stay."""

from __future__ import annotations

import json
import subprocess
import sys
from functools import cache

import numpy as np
import pytest

from matpoint.errors import InputError
from matpoint.interpolation import CPDI2, METHODS, Linear
from matpoint.problems import PROBLEMS, ExpandingRing, FullWave, Waves2D, Waves3D
from matpoint.problems.errors_track import NORMS, sampling
from matpoint.study import converge, fitted, neighbours, orders, tables
from matpoint.study.worker import entry


@cache
def norms(problem, method, cells, **choices):
    track = PROBLEMS[problem](cells=cells, **choices).track(METHODS[method], threads=1)
    return track.norms() | {"failed": track.failed}


def slope(problem, method, norm, sizes, **choices):
    errors = [norms(problem, method, n, **choices)[norm] for n in sizes]
    return -np.polyfit(np.log(sizes), np.log(errors), 1)[0]


def test_finer_grids_make_mpm_worse():
    coarse, fine = (norms("mms-1d", "mpm", n, scheme="usl") for n in (16, 64))
    assert coarse["velocity_quarter"] == pytest.approx(7.99, rel=0.01)
    assert fine["velocity_quarter"] > 3 * coarse["velocity_quarter"]
    assert fine["velocity_max"] > 2 * coarse["velocity_max"]
    coarse, fine = (norms("mms-1d", "mpm", n) for n in (16, 64))  # MUSL: USL turns a particle inside out
    assert fine["velocity"] > 3 * coarse["velocity"]  # 48.6 and 11.0 m/s


@pytest.mark.parametrize("method", ["cpdi1", "cpdi2"])
def test_corner_domains_keep_second_order_in_one_dimension(method):
    sizes = (16, 32, 64, 128)
    assert slope("mms-1d", method, "velocity", sizes) == pytest.approx(1.84, abs=0.03)
    assert slope("mms-1d", method, "displacement_quarter", sizes) == pytest.approx(2.02, abs=0.02)
    for cells, velocity in ((32, 0.495), (64, 0.124), (128, 0.0347)):  # methods, section 8
        assert norms("mms-1d", method, cells)["velocity"] == pytest.approx(velocity, rel=5e-3)


def test_staggered_velocities_leave_the_error_of_space_alone():
    early, late = (norms("mms-1d-half", "cpdi2", 64, staggered=s)["velocity_quarter"] for s in (True, False))
    assert early < 0.6 * late  # 0.0145 and 0.0285 m/s
    assert slope("mms-1d-half", "cpdi2", "velocity", (16, 32, 64), staggered=True) > 1.7


@pytest.mark.parametrize(
    ("problem", "sizes", "part", "least"),
    [
        ("mms-2d", (8, 16, 32), "", 1.8),
        ("mms-3d", (4, 8), "", 1.75),
        ("expanding-ring", (16, 32), "", 1.85),
        ("mms-1d-half", (16, 32, 64), "", 1.7),
    ],
)
def test_cpdi2_is_of_second_order(problem, sizes, part, least):
    for field in ("displacement", "velocity", "stress"):
        assert slope(problem, "cpdi2", field + part, sizes, staggered=True) > least


@pytest.mark.slow
def test_cpdi2_is_of_second_order_in_the_vortex_before_the_quarter():
    for field in ("displacement", "stress"):
        assert slope("vortex", "cpdi2", f"{field}_quarter", (32, 64), staggered=True) > 1.75
    assert norms("vortex", "cpdi2", 64, staggered=True)["displacement_quarter"] < 0.0038


def test_a_run_that_breaks_says_where_and_keeps_what_it_had():
    found = norms("mms-1d", "mpm", 96, scheme="usl")
    assert found["failed"].startswith("step ")
    assert np.isnan(found["velocity"])
    assert np.isfinite(found["velocity_quarter"])


def test_the_start_of_a_wave_in_three_dimensions_is_exact():
    problem = Waves3D(cells=4)
    sim = problem.simulation(METHODS["mpm"], threads=1)
    assert problem.errors(sim) == pytest.approx([0.0, 0.0, 0.0], abs=1e-8)
    assert np.abs(sim.particles.position - sim.particles.position0).max() > 0.01


def test_random_particles_fill_the_cells_and_run():
    problem = Waves2D(cells=8, random=3)
    sim = problem.simulation(Linear(), threads=1)
    p = sim.particles
    assert p.volume.sum() == pytest.approx(1.0)
    count = np.bincount(np.ravel_multi_index(tuple((8 * p.position0[:, :2]).astype(int).T), (8, 8)))
    assert count.min() >= 4
    assert count.max() <= 9
    np.testing.assert_array_equal(
        p.ordered("position0"), problem.simulation(Linear(), threads=1).particles.ordered("position0")
    )
    assert norms("mms-1d", "cpdi1", 32, random=7)["velocity"] < 0.5
    with pytest.raises(InputError, match="needs domains that share corners"):
        problem.simulation(CPDI2())


@pytest.mark.parametrize(
    "choices",
    [{"cells": 1}, {"amplitude": 0.0}, {"dt": 3e-4}, {"staggered": 1}, {"scheme": "best"}, {"random": -1}],
)
def test_choices_that_cannot_be_are_refused(choices):
    with pytest.raises(InputError):
        FullWave(**choices)


def test_samples_meet_the_quarter_and_the_end():
    assert [sampling(1.0, 1.0 / n) for n in (4, 100, 1000, 2000)] == [1, 1, 10, 25]
    ring = ExpandingRing(cells=80)
    assert ring.step == ExpandingRing.longest / 2


def test_orders_come_from_the_runs_that_reached_their_end():
    good = [entry(n, dict.fromkeys(NORMS, 1.0 / n**2)) for n in (8, 16, 32)]
    bad = [good[0], entry(16, failed="step 3: it broke"), entry(32, dict.fromkeys(NORMS, float("nan")))]
    assert fitted(good, "velocity") == pytest.approx(2.0)
    assert neighbours(good, "stress") == [None, pytest.approx(2.0), pytest.approx(2.0)]
    assert orders({"a": bad})["a"]["velocity"] is None
    assert bad[2]["velocity"] is None
    text = tables({"a": good, "b": bad})
    assert "b with 16 cells failed: step 3: it broke" in text


def test_a_study_keeps_what_it_ran(tmp_path, monkeypatch):
    monkeypatch.setattr("matpoint.study.store.folder", lambda: tmp_path)
    lines: list[str] = []
    problem = FullWave(dt=1e-4)
    first = converge(problem, ["cpdi2"], [4, 8], processes=1, announce=lines.append)
    again = converge(problem, ["cpdi2"], [4, 8, 16], processes=1, announce=lines.append)
    assert again.entries["cpdi2"][:2] == first.entries["cpdi2"]
    assert [("kept" in line) for line in lines] == [False, False, True, True, False]
    again = converge(problem, ["cpdi2"], [4], processes=1, fresh=True, announce=lines.append)
    assert "kept" not in lines[-1]
    assert again.entries["cpdi2"][0]["velocity"] == first.entries["cpdi2"][0]["velocity"]


def test_a_process_that_dies_takes_only_its_own_run_with_it(tmp_path, monkeypatch):
    monkeypatch.setattr("matpoint.study.store.folder", lambda: tmp_path)
    ask = "import sys, os, json\nfor line in sys.stdin:\n    g = json.loads(line)\n"
    ask += "    os._exit(7) if g['settings']['cells'] == 8 else print(json.dumps({'cells': 4,"
    ask += " 'velocity': 1.0, 'wall_s': 0.0, 'failed': None}), flush=True)"
    real = subprocess.Popen
    monkeypatch.setattr(
        "matpoint.study.pool.subprocess.Popen", lambda args, **k: real([sys.executable, "-c", ask], **k)
    )
    study = converge(FullWave(), ["mpm"], [4, 8], processes=1)
    assert study.entries["mpm"][0]["failed"] is None
    assert "ended with code 7" in study.entries["mpm"][1]["failed"]


def test_the_command_prints_one_json_object_and_draws(tmp_path):
    command = [sys.executable, "-m", "matpoint", "converge", "mms-1d", "--cells", "4,8", "--methods"]
    command += ["mpm,cpdi2", "--set", "problem.dt=1e-4", "--json", "--out", "study"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=True)
    found = json.loads(done.stdout)
    assert list(found) == ["mpm", "cpdi2", "order"]
    assert [e["cells"] for e in found["cpdi2"]] == [4, 8]
    assert {*NORMS, "cells", "particle_steps", "wall_s", "failed"} == set(found["cpdi2"][0])
    assert set(found["order"]["cpdi2"]) == set(NORMS)
    assert found["cpdi2"][1]["particle_steps"] == 200 * 24
    assert "[4/4]" in done.stderr
    names = {p.name for p in (tmp_path / "study").iterdir() if not p.name.startswith(".")}
    assert names == {"figure-size.png", "figure-cost.png", "table.txt", "converge.json", "settings.json"}
    for bad in (["--cells", "4,x"], ["--methods", "magic"], ["--cells", "1"]):
        wrong = [*command[:5], *bad, "--json"]
        refused = subprocess.run(wrong, cwd=tmp_path, capture_output=True, text=True, check=False)
        assert refused.returncode == 2
    wrong = [*command[:4], "bimaterial-bar", "--json"]
    other = subprocess.run(wrong, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert "no manufactured problem" in other.stderr

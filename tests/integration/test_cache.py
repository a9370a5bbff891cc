"""The cache of compiled kernels: announced when it is filled, safe for two at once, pruned with care."""

from __future__ import annotations

import os
import subprocess
import sys
import time

import numpy as np
import pytest

from matpoint import jit

_RUN = """
import sys, numpy as np, matpoint as mp
from matpoint.jit import on_first_compilation
on_first_compilation(lambda: print("compiles", file=sys.stderr))
grid = mp.Grid((0.0,) * 3, (6.0,) * 3, 1.0)
mesh = mp.mesh_box((1.0,) * 3, (5.0,) * 3, (8,) * 3)
bend = mesh.vertices + 0.05 * np.sin(3.0 * mesh.vertices[:, [1, 2, 0]])
rubber = mp.NeoHookean(1e3, 0.3, 1.0)
body = mp.Body(mp.Domains(bend, mesh.cells, "hex"), rubber, velocity=lambda x: 0.1 * np.sin(x))
sim = mp.Simulation(grid, [body], interpolation=mp.CPDI2(), timestep=mp.FixedStep(1e-3), threads=1)
for _ in range(5):
    sim.advance(1e-3)
np.save(sys.argv[1], sim.particles.ordered("position"))
"""


def _start(cache, result):
    environment = {k: v for k, v in os.environ.items() if k != "NUMBA_CACHE_DIR"}
    environment["MATPOINT_CACHE"] = str(cache)
    command = [sys.executable, "-c", _RUN, str(result)]
    return subprocess.Popen(command, env=environment, stderr=subprocess.PIPE, text=True)


@pytest.mark.slow
def test_two_processes_may_fill_an_empty_cache_at_once_and_a_third_compiles_nothing(tmp_path):
    results = [tmp_path / f"{k}.npy" for k in range(3)]
    pair = [_start(tmp_path / "cache", result) for result in results[:2]]
    for process in pair:
        assert process.communicate()[1] == "compiles\n"
        assert process.returncode == 0
    third = _start(tmp_path / "cache", results[2])
    assert third.communicate()[1] == ""
    assert third.returncode == 0
    first, *others = (np.load(result) for result in results)
    for other in others:
        np.testing.assert_array_equal(other, first)  # compiled here, or there, or loaded: to the last bit
    names = [path.name for path in (tmp_path / "cache").rglob("*.nbc")]
    assert len(names) == len(set(names)) > 3


def _cache(folder, age, *names):
    for name in names:
        path = folder / "kernels_1" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(b"")
    folder.mkdir(exist_ok=True)
    then = time.time() - 86400.0 * age
    os.utime(folder, (then, then))
    return folder


def test_only_old_caches_of_ours_are_pruned(tmp_path, monkeypatch):
    monkeypatch.setenv("MATPOINT_CACHE", str(tmp_path))
    monkeypatch.setattr(jit, "_OURS", True)
    present = _cache(tmp_path / jit.source_hash(), 99, "a.nbi")
    old = _cache(tmp_path / ("0" * 16), 40, "a.nbi", "a.1.nbc", "a.nbi.tmp.0f")
    young = _cache(tmp_path / ("1" * 16), 20, "a.nbi")
    foreign = _cache(tmp_path / ("2" * 16), 40, "a.nbi", "letter.txt")
    other = _cache(tmp_path / "results", 40, "a.nbi")
    linked = tmp_path / ("3" * 16)
    linked.symlink_to(other, target_is_directory=True)
    jit.prune_caches()
    assert not old.exists()
    for kept in (present, young, foreign, other):
        assert (kept / "kernels_1" / "a.nbi").exists()
    assert linked.is_symlink()

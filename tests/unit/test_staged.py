"""Changes to files that are staged in memory: the same as on disk, or nothing at all."""

from __future__ import annotations

import io
import os
import subprocess
import sys

import h5py
import numpy as np
import pytest
from test_output import _read_vtk

import matpoint as mp
from matpoint.output.staged import StagedFile, staged_hdf5
from runs import two_blocks


@pytest.mark.parametrize("seed", range(20))
def test_a_staged_file_is_a_file(tmp_path, seed):
    rng = np.random.default_rng(seed)
    path, size = tmp_path / "f", int(rng.integers(0, 30_000))
    path.write_bytes(rng.bytes(size))
    plain = io.BytesIO(path.read_bytes())
    with StagedFile(path) as staged:
        for _ in range(200):
            at, count = int(rng.integers(0, 40_000)), int(rng.integers(0, 9000))
            assert staged.seek(at) == plain.seek(at)
            if rng.random() < 0.5:
                data = rng.bytes(count)
                assert staged.write(data) == plain.write(data)
            else:
                assert staged.read(count) == plain.read(count)
            assert staged.seek(0, os.SEEK_END) == plain.seek(0, os.SEEK_END)
        assert path.stat().st_size == size  # nothing has reached the disk
        staged.commit()
    assert path.read_bytes() == plain.getvalue()


def test_what_fails_in_the_middle_changes_nothing(tmp_path):
    path = tmp_path / "f.h5"
    with staged_hdf5(path, "w") as file:
        file["a"] = np.arange(1000)
    before = path.read_bytes()

    def spoil():
        with staged_hdf5(path, "r+") as file:
            file["b"] = np.arange(10_000)
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        spoil()
    assert path.read_bytes() == before
    with h5py.File(path) as file:
        assert list(file) == ["a"]


FULL = """
import resource, sys
from pathlib import Path
sys.path[:0] = {paths!r}
import matpoint as mp
from runs import two_blocks

class Fill:
    trigger = mp.EverySteps(1)
    def open(self, sim): pass
    def close(self, sim, error): pass
    def write(self, sim):
        if sim.step == 4:
            resource.setrlimit(resource.RLIMIT_FSIZE, ({limit}, {limit}))

out, every = Path({out!r}), mp.EverySteps(1)
vtk = mp.VTKHDF(out / "r.vtkhdf", mp.EverySteps({vtk}))
writers = [Fill(), vtk, mp.History(out / "h.csv", every, ("mass",)),
           mp.Checkpoint(out / "c.h5", mp.EverySteps(2)), mp.Summary(out / "s.json")]
try:
    two_blocks(mp.CPDI2()).run(1.0, writers)
except mp.RunError as error:
    print(error)
    sys.exit(3)
"""


@pytest.mark.parametrize(
    ("limit", "vtk", "file"), [(200_000, 1, "r.vtkhdf"), (45_000, 1000, "c.h5"), (100, 1000, "h.csv")]
)
def test_a_full_disk_ends_the_run_and_leaves_the_steps_before(tmp_path, limit, vtk, file):
    pytest.importorskip("resource")
    paths = [p for p in sys.path if p.endswith("tests")]
    script = FULL.format(paths=paths, out=str(tmp_path), limit=limit, vtk=vtk)
    done = subprocess.run([sys.executable, "-c", script], check=False, capture_output=True, text=True)
    assert done.returncode == 3, (done.returncode, done.stderr)
    assert file in done.stdout
    assert "File too large" in done.stdout or "no space" in done.stdout
    steps = _read_vtk(tmp_path / "r.vtkhdf")
    assert len(steps) > (4 if vtk == 1 else 0)
    assert [s[0] for s in steps] == pytest.approx([2e-4 * k for k in range(len(steps))])
    assert not list(tmp_path.glob("*.tmp"))
    again = two_blocks(mp.CPDI2())
    mp.resume(again, tmp_path / "c.h5")
    assert again.step >= 2
    rows = (tmp_path / "h.csv").read_text().splitlines()
    assert all(row.count(",") == 2 and row.split(",")[2] for row in rows)

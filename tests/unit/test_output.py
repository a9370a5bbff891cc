"""Files that a run writes: read back, and readable after every kind of end."""

from __future__ import annotations

import csv
import json
import os
import signal
import subprocess
import sys
import textwrap

import numpy as np
import pytest

import matpoint as mp
from matpoint.output.figures import draw_particles
from matpoint.output.folder import claim, inside
from runs import advance, spinning_block, two_blocks

METHODS = [mp.Linear(), mp.BSpline(2), mp.CPDI1(), mp.CPDI2(), mp.EnrichedCPDI2()]


def _read_vtk(path):
    """All steps through VTK's own reader: (time, points, cells, cell type, arrays)."""
    from vtk import vtkHDFReader
    from vtk.util.numpy_support import vtk_to_numpy

    reader = vtkHDFReader()
    reader.SetFileName(str(path))
    reader.UpdateInformation()
    steps = []
    for k in range(reader.GetNumberOfSteps()):
        reader.SetStep(k)
        reader.Update()
        grid = reader.GetOutputDataObject(0)
        data = {}
        for part in (grid.GetPointData(), grid.GetCellData()):
            where = "point" if part is grid.GetPointData() else "cell"
            for a in range(part.GetNumberOfArrays()):
                data[where, part.GetArrayName(a)] = vtk_to_numpy(part.GetArray(a)).copy()
        points = vtk_to_numpy(grid.GetPoints().GetData()).copy()
        cells = vtk_to_numpy(grid.GetCells().GetConnectivityArray()).copy()
        steps.append((reader.GetTimeValue(), points, cells, grid.GetCellType(0), data))
    return steps


class _Keep:
    """A writer that keeps what the file should hold."""

    def __init__(self, trigger):
        self.trigger, self.kept = trigger, []

    def open(self, sim):
        pass

    def write(self, sim):
        names = ("position", "position0", "velocity", "stress", "deformation_gradient", "material", "body")
        state = {name: sim.particles.ordered(name) for name in names}
        state["corners"] = None if sim.vertices is None else sim.vertices.position.copy()
        self.kept.append((sim.time, state))

    def close(self, sim, error):
        pass


@pytest.mark.parametrize("dim", [1, 2, 3])
@pytest.mark.parametrize("interpolation", METHODS, ids=lambda m: m.name)
def test_vtkhdf_is_read_back_by_vtk(tmp_path, interpolation, dim):
    sim = two_blocks(interpolation, dim, sort_every=3)
    keep, path = _Keep(mp.EverySteps(4)), tmp_path / "r.vtkhdf"
    sim.run(16 * sim.dt, [mp.VTKHDF(path, mp.EverySteps(4)), keep])
    steps = _read_vtk(path)
    assert len(steps) == len(keep.kept) == 5
    where = "point" if sim.vertices is None else "cell"
    for (time, points, cells, cell_type, data), (expected_time, state) in zip(steps, keep.kept, strict=True):
        assert time == pytest.approx(expected_time)
        np.testing.assert_array_equal(data[where, "id"], np.arange(len(sim.particles)))
        for name in ("velocity", "stress", "material", "body"):
            np.testing.assert_array_equal(data[where, name], state[name])
        np.testing.assert_array_equal(
            data[where, "deformation_gradient"], state["deformation_gradient"].reshape(-1, 9)
        )
        np.testing.assert_allclose(data[where, "displacement"], state["position"] - state["position0"])
        if sim.vertices is None:
            assert cell_type == 1
            np.testing.assert_array_equal(points, state["position"])
        else:
            assert cell_type == {1: 3, 2: 9, 3: 12}[dim]
            np.testing.assert_array_equal(points, state["corners"])
            # Cells surround their particles, whatever order the particles have inside.
            centres = points[cells.reshape(len(sim.particles), -1)].mean(axis=1)
            np.testing.assert_allclose(centres, state["position"], atol=1e-6)


def test_triangles_and_a_mixed_mesh_are_written(tmp_path):
    grid = mp.Grid((0, 0), (3, 1), 0.5)
    quad = mp.mesh_box((0.5, 0.25), (1.0, 0.75), (2, 2))
    base = mp.mesh_box((1.5, 0.25), (2.0, 0.75), (2, 2))
    cells = np.concatenate([base.cells[:, [0, 1, 2]], base.cells[:, [0, 2, 3]]])
    triangles = mp.Domains(base.vertices, cells, mp.Kind.TRI)
    rubber = mp.NeoHookean(E=1e6, nu=0.3, density=1000.0)
    sim = mp.Simulation(
        grid, [mp.Body(quad, rubber), mp.Body(triangles, rubber)],
        interpolation=mp.CPDI2(), timestep=mp.FixedStep(1e-4),
    )  # fmt: skip
    path = tmp_path / "r.vtkhdf"
    sim.run(1e-3, [mp.VTKHDF(path, mp.EverySteps(5))])
    steps = _read_vtk(path)
    assert len(steps) == 3
    assert len(steps[0][2]) == 4 * 4 + 8 * 3


def test_a_killed_process_leaves_a_readable_file(tmp_path):
    script = textwrap.dedent(f"""
        import os, signal, sys
        sys.path[:0] = {[p for p in sys.path if p.endswith("tests")]!r}
        import matpoint as mp
        from pathlib import Path
        from runs import two_blocks
        class Kill:
            trigger = mp.EverySteps(1)
            def open(self, sim): pass
            def write(self, sim):
                if sim.step == 11: os.kill(os.getpid(), signal.SIGKILL)
            def close(self, sim, error): pass
        sim = two_blocks(mp.CPDI2())
        out = Path({str(tmp_path)!r})
        sim.run(1.0, [mp.VTKHDF(out / "r.vtkhdf", mp.EverySteps(2)),
                      mp.History(out / "h.csv", mp.EverySteps(2), ("mass",)), Kill()])
    """)
    done = subprocess.run([sys.executable, "-c", script], check=False, capture_output=True)
    assert done.returncode == -signal.SIGKILL, done.stderr.decode()
    assert len(_read_vtk(tmp_path / "r.vtkhdf")) == 6
    rows = list(csv.reader((tmp_path / "h.csv").open()))
    assert [int(r[0]) for r in rows[1:]] == [0, 2, 4, 6, 8, 10]


def test_history_has_units_quantities_and_probes(tmp_path):
    sim = two_blocks(mp.CPDI2(), sort_every=2)
    probe = mp.Probe("A", (0.35, 0.35), "displacement", "x")
    stress = mp.Probe("A", (0.35, 0.35), "stress", "yy")
    history = mp.History(tmp_path / "h.csv", mp.EverySteps(2), ("mass", "kinetic_energy"), (probe, stress))
    sim.run(10 * sim.dt, [history])
    rows = list(csv.reader((tmp_path / "h.csv").open()))
    assert rows[0] == [
        "step [-]", "time [s]", "mass [kg]", "kinetic_energy [J]", "A.displacement.x [m]", "A.stress.yy [Pa]",
    ]  # fmt: skip
    assert len(rows) == 7
    nearest = np.argmin(((sim.particles.ordered("position0") - [0.35, 0.35, 0]) ** 2).sum(axis=1))
    moved = (sim.particles.ordered("position") - sim.particles.ordered("position0"))[nearest, 0]
    assert float(rows[-1][4]) == moved == history.array("A.displacement.x")[-1]
    assert float(rows[-1][5]) == sim.particles.ordered("stress")[nearest, 1]


def test_unknown_quantity_probe_field_and_column():
    with pytest.raises(mp.InputError, match="'weight' does not exist"):
        mp.Recorder(mp.EverySteps(1), ("weight",))
    with pytest.raises(mp.InputError, match="field = 'colour'"):
        mp.Probe("A", (0.0,), "colour")
    with pytest.raises(mp.InputError, match="component = 'xx'"):
        mp.Probe("A", (0.0,), "velocity", "xx")
    with pytest.raises(mp.InputError, match="two columns"):
        mp.Recorder(mp.EverySteps(1), (), (mp.Probe("A", (0.0,)), mp.Probe("A", (1.0,))))
    with pytest.raises(mp.InputError, match="no column"):
        mp.Recorder(mp.EverySteps(1)).array("mass")


def test_summary_of_a_run_that_ends_well(tmp_path):
    sim = two_blocks(mp.EnrichedCPDI2())
    sim.run(20 * sim.dt, [mp.Summary(tmp_path / "summary.json", {"name": "two"}, {"tip": float("nan")})])
    found = json.loads((tmp_path / "summary.json").read_text())
    assert found["status"] == "finished"
    assert found["case"] == {"name": "two"}
    assert (found["method"], found["scheme"], found["dim"]) == ("enriched-cpdi2", "usl", 2)
    assert found["steps"] == 20
    assert found["dt"]["smallest"] == pytest.approx(2e-4)
    assert found["norms"] == {"tip": None}
    ledger = found["ledger"]
    assert ledger["start"]["mass"] == pytest.approx(ledger["end"]["mass"])
    assert ledger["worst_drift"]["momentum"] < 1e-9
    assert set(found["versions"]) >= {"python", "numpy", "numba", "matpoint"}
    assert not list(tmp_path.glob("*.tmp"))


def test_a_run_that_fails_says_where_and_keeps_its_files(tmp_path):
    grid = mp.Grid((0, 0), (1, 1), 0.125)
    body = mp.Body(
        mp.Box((0.5, 0.5), (0.75, 0.75)), mp.NeoHookean(E=1e5, nu=0.3, density=1000.0), velocity=(9.0,)
    )
    sim = mp.Simulation(grid, [body], interpolation=mp.CPDI2(), timestep=mp.FixedStep(1e-3), threads=1)
    writers = [mp.VTKHDF(tmp_path / "r.vtkhdf", mp.EverySteps(5)), mp.Summary(tmp_path / "summary.json")]
    with pytest.raises(mp.RunError) as caught:
        sim.run(1.0, writers)
    error = caught.value
    assert error.step == sim.step > 20
    assert error.particle is not None
    assert error.position[0] > 1.0
    assert "left the grid" in str(error)
    assert f"step {error.step}" in str(error)
    found = json.loads((tmp_path / "summary.json").read_text())
    assert found["status"] == "failed"
    assert found["error"]["particle"] == error.particle
    assert len(_read_vtk(tmp_path / "r.vtkhdf")) == 1 + (error.step) // 5


def test_interrupting_ends_after_the_step_with_closed_files(tmp_path):
    class Interrupt:
        trigger = mp.EverySteps(1)

        def open(self, sim):
            pass

        def write(self, sim):
            if sim.step == 5:
                os.kill(os.getpid(), signal.SIGINT)

        def close(self, sim, error):
            self.error = error

    sim, last = two_blocks(mp.Linear()), Interrupt()
    writers = [last, mp.Summary(tmp_path / "s.json"), mp.Checkpoint(tmp_path / "c.h5", mp.EverySteps(1000))]
    with pytest.raises(KeyboardInterrupt):
        sim.run(1.0, writers)
    assert sim.step == 5
    assert isinstance(last.error, KeyboardInterrupt)
    found = json.loads((tmp_path / "s.json").read_text())
    assert (found["status"], found["error"]["cause"]) == ("interrupted", "interrupted by the user")
    # The checkpoint of the interruption goes on to the same bits as an undisturbed run.
    again = two_blocks(mp.Linear())
    mp.resume(again, tmp_path / "c.h5")
    assert again.step == 5
    advance(again, 10)
    straight = advance(two_blocks(mp.Linear()), 15)
    np.testing.assert_array_equal(again.particles.position, straight.particles.position)


def test_checkpoints_of_other_cases_and_damaged_files_are_refused(tmp_path):
    path = tmp_path / "c.h5"
    sim = two_blocks(mp.CPDI2())
    sim.run(5 * sim.dt, [mp.Checkpoint(path, mp.EverySteps(5))])
    with pytest.raises(mp.InputError, match="another case"):
        mp.resume(two_blocks(mp.CPDI1()), path)
    path.write_bytes(path.read_bytes()[:2000])
    with pytest.raises(mp.InputError, match=r"can't be read|not a matpoint"):
        mp.resume(two_blocks(mp.CPDI2()), path)
    with pytest.raises(mp.InputError, match="can't be read"):
        mp.resume(two_blocks(mp.CPDI2()), tmp_path / "missing.h5")


def test_folders(tmp_path):
    folder = mp.prepare_folder(tmp_path / "a" / "b")
    assert folder.is_dir()
    mp.prepare_folder(folder)  # empty: fine
    claim(folder / "history.csv").write_text("old")
    (folder / "notes.md").write_text("mine")
    (folder / "measured.csv").write_text("mine")
    with pytest.raises(mp.InputError, match="--force"):
        mp.prepare_folder(folder)
    outside = tmp_path / "precious.csv"
    outside.write_text("keep")
    claim(folder / "link.csv").symlink_to(outside)
    mp.prepare_folder(folder, force=True)
    assert sorted(p.name for p in folder.iterdir()) == [".matpoint-files", "measured.csv", "notes.md"]
    assert outside.read_text() == "keep"
    with pytest.raises(mp.InputError, match=r"holds measured.csv, which no run"):
        mp.prepare_folder(folder, force=True, files=["measured.csv"])
    with pytest.raises(mp.InputError, match="is a file"):
        mp.prepare_folder(outside)
    with pytest.raises(mp.InputError, match="can't be used"):
        mp.prepare_folder(outside / "below")
    assert inside(folder, "x.csv") == folder / "x.csv"
    for name in ("../x.csv", "/etc/x", "", "sub/../../x"):
        with pytest.raises(mp.InputError, match="leads out"):
            inside(folder, name)
    (folder / "away").symlink_to(tmp_path)
    with pytest.raises(mp.InputError, match="leads out"):
        inside(folder, "away/x.csv")


@pytest.mark.parametrize(
    "line", ["notes.md", "../mine.csv", "sub/mine.csv", "/etc/x.csv", "sub", "..", "a\\b.csv"]
)
def test_a_list_of_files_that_names_what_is_not_matpoints_removes_nothing(tmp_path, line):
    folder = mp.prepare_folder(tmp_path / "out")
    (folder / "sub").mkdir()
    for place in (folder / "notes.md", tmp_path / "mine.csv", folder / "sub" / "mine.csv"):
        place.write_text("mine")
    with (folder / ".matpoint-files").open("a") as file:
        file.write(line + "\n")
    before = sorted(tmp_path.rglob("*"))
    mp.prepare_folder(folder, force=True)
    assert sorted(tmp_path.rglob("*")) == before


def test_a_list_of_files_that_is_a_link_or_something_else_is_not_believed(tmp_path):
    folder, other = mp.prepare_folder(tmp_path / "out"), tmp_path / "list"
    (folder / "mine.csv").write_text("mine")
    other.write_text((folder / ".matpoint-files").read_text() + "mine.csv\n")
    listing = other.read_text()
    (folder / ".matpoint-files").unlink()
    (folder / ".matpoint-files").symlink_to(other)
    mp.prepare_folder(folder, force=True)
    assert other.read_text() == listing
    (folder / ".matpoint-files").write_bytes(b"\xff mine.csv\nmine.csv\n")
    mp.prepare_folder(folder, force=True)
    assert (folder / "mine.csv").read_text() == "mine"


def test_unwritable_files_are_refused_before_the_first_step(tmp_path):
    for writer in (
        mp.VTKHDF(tmp_path / "no" / "r.vtkhdf", mp.EverySteps(1)),
        mp.History(tmp_path / "no" / "h.csv", mp.EverySteps(1)),
        mp.Summary(tmp_path / "no" / "s.json"),
        mp.Checkpoint(tmp_path / "no" / "c.h5", mp.EverySteps(1)),
    ):
        sim = two_blocks(mp.Linear())
        with pytest.raises(mp.InputError, match="can't be written"):
            sim.run(1.0, [writer])
        assert sim.step == 0


@pytest.mark.parametrize("dim", [1, 2, 3])
@pytest.mark.parametrize("interpolation", [mp.UGIMP(), mp.CPDI2()], ids=lambda m: m.name)
def test_figures_are_pictures(tmp_path, interpolation, dim):
    sim = spinning_block(interpolation, dim, cells=4)
    history = mp.Recorder(mp.EverySteps(1), ("kinetic_energy", "centre_x"))
    sim.run(
        5 * sim.dt,
        [
            history,
            mp.HistoryFigure(tmp_path / "h.png", history),
            mp.ParticleFigure(tmp_path, "p", "speed", mp.EverySteps(5)),
        ],
    )
    names = sorted(p.name for p in tmp_path.glob("*.png"))
    assert names == ["h.png", "p-000.png", "p-001.png"]  # the end is the last of them
    for path in tmp_path.glob("*.png"):
        assert path.read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"
        assert path.stat().st_size > 5000
    with pytest.raises(mp.InputError, match="colour"):
        draw_particles(sim, tmp_path / "q.png", "taste")


def test_the_end_is_drawn_once(tmp_path):
    sim = two_blocks(mp.Linear())
    sim.run(
        5 * sim.dt,
        [mp.ParticleFigure(tmp_path, "n", trigger=mp.EverySteps(3)), mp.ParticleFigure(tmp_path, "e")],
    )
    assert sorted(p.name for p in tmp_path.iterdir()) == ["e.png", "n-000.png", "n-001.png", "n-002.png"]
    for stem in ("", " ", "a/b", "a\nb"):
        with pytest.raises(mp.InputError, match="plain file name"):
            mp.ParticleFigure(tmp_path, stem)


def test_round_off_is_flat_and_axes_have_units(tmp_path, monkeypatch):
    from matpoint.output import curves

    drawn = []
    monkeypatch.setattr(curves, "save", lambda figure, path: drawn.append(figure))
    sim = two_blocks(mp.CPDI2())
    names = ("momentum_y", "kinetic_energy", "mass")
    history = mp.Recorder(mp.EverySteps(1), names)
    sim.run(40 * sim.dt, [history, curves.HistoryFigure(tmp_path / "h.png", history)])
    axes = drawn[0].axes
    assert [a.get_ylabel() for a in axes] == ["momentum_y\n[kg m/s]", "kinetic_energy\n[J]", "mass\n[kg]"]
    for axis, flat in zip(axes, (True, False, True), strict=True):
        values = axis.lines[0].get_ydata()
        low, high = axis.get_ylim()
        assert (np.ptp(values) < 0.01 * (high - low)) == flat


@pytest.mark.parametrize("interpolation", [mp.Linear(), mp.CPDI2()], ids=lambda m: m.name)
def test_a_probe_outside_every_body_is_refused(interpolation):
    sim = two_blocks(interpolation)
    assert mp.Probe("A", (0.3125, 0.25)).find(sim) >= 0  # a corner of the body
    with pytest.raises(
        mp.InputError, match=r"probe 'A': at = \[0.1, 0.1\] is outside .* at \[0.34375, 0.28125\], is 0.3"
    ):
        mp.Probe("A", (0.1, 0.1)).find(sim)


def test_the_ledger_has_the_last_step(tmp_path):
    sim = two_blocks(mp.Linear(), sample_every=1000)
    sim.run(7 * sim.dt, [mp.Summary(tmp_path / "s.json")])
    assert sim.ledger.latest.step == sim.step == 7
    assert json.loads((tmp_path / "s.json").read_text())["ledger"]["end"]["time"] == sim.time


def test_progress_writes_lines_where_there_is_no_terminal(capsys):
    sim = two_blocks(mp.Linear())
    sim.run(5 * sim.dt, progress=mp.Progress())
    shown = capsys.readouterr()
    assert "mpm: " in shown.err
    assert shown.out == ""
    sim = two_blocks(mp.Linear())
    sim.run(5 * sim.dt, progress=mp.Progress(quiet=True))
    assert capsys.readouterr().err == ""

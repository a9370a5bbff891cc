"""Every command as a user runs it: in a process of its own."""

from __future__ import annotations

import csv
import json
import os
import re
import signal
import subprocess
import sys
import time

import h5py
import numpy as np
import pytest

from cases import SMALL


def matpoint(*arguments, cwd, code=0, **options):
    """Run the command line; return what it printed. A traceback is always a failure."""
    done = subprocess.run(
        [sys.executable, "-m", "matpoint", *map(str, arguments)],
        check=False, capture_output=True, text=True, cwd=cwd, timeout=300, **options,
    )  # fmt: skip
    assert "Traceback" not in done.stderr, done.stderr
    assert done.returncode == code, (done.returncode, done.stdout, done.stderr)
    return done


@pytest.fixture
def case(tmp_path):
    path = tmp_path / "small.toml"
    path.write_text(SMALL)
    return path


def test_run_writes_what_the_case_asks_for(case, tmp_path):
    done = matpoint("run", case, cwd=tmp_path)
    out = tmp_path / "results" / "small"
    assert "results" in done.stdout
    assert sorted(p.name for p in out.iterdir()) == [
        ".matpoint-files", "history.csv", "results.vtkhdf", "summary.json",
    ]  # fmt: skip
    summary = json.loads((out / "summary.json").read_text())
    assert (summary["status"], summary["steps"], summary["method"]) == ("finished", 50, "cpdi2")
    rows = list(csv.reader((out / "history.csv").open()))
    assert rows[0][-1] == "foot.displacement.y [m]"
    assert len(rows) == 12
    assert float(rows[-1][-1]) < -1e-3
    assert "particles" in done.stderr  # progress goes where it does not mix with results


def test_set_threads_out_force_and_quiet(case, tmp_path):
    arguments = [
        "run",
        case,
        "--out",
        "here",
        "--set",
        "interpolation.method=bspline2",
        "--threads",
        "2",
        "--quiet",
    ]
    done = matpoint(*arguments, "--set", "bodies.0.per_cell=3", "--set", "time.end=0.01", cwd=tmp_path)
    assert done.stderr == ""
    summary = json.loads((tmp_path / "here" / "summary.json").read_text())
    assert (summary["method"], summary["particles"], summary["threads"]) == ("bspline2", 36, 2)
    before = (tmp_path / "here" / "summary.json").read_bytes()
    refused = matpoint(*arguments, cwd=tmp_path, code=2)
    assert "--force" in refused.stderr
    assert (tmp_path / "here" / "summary.json").read_bytes() == before
    matpoint(*arguments, "--force", cwd=tmp_path)
    assert (tmp_path / "here" / "summary.json").read_bytes() != before


def test_bundled_case_and_override_of_a_problem(tmp_path):
    settings = [
        "--set",
        "problem.stiff=below",
        "--set",
        "time.end=0.01",
        "--set",
        'interpolation.method="cpdi1"',
    ]
    matpoint("run", "bimaterial-bar", *settings, "--out", "bar", cwd=tmp_path)
    summary = json.loads((tmp_path / "bar" / "summary.json").read_text())
    assert (summary["method"], summary["particles"], summary["dim"]) == ("cpdi1", 18, 1)
    assert "E=5000000.0" in summary["materials"][1]


@pytest.mark.parametrize("name", ["two-discs", "cantilever", "vertical-bar", "inclusion", "sphere-inclusion"])
def test_bundled_cases_begin_well(name, tmp_path):
    matpoint("run", name, "--set", "time.end=0.02", "--set", "output.figures=[]", cwd=tmp_path)
    summary = json.loads((tmp_path / "results" / name / "summary.json").read_text())
    assert summary["status"] == "finished"
    ledger = summary["ledger"]
    assert ledger["worst_drift"]["mass"] < 1e-12 * ledger["start"]["mass"]


@pytest.mark.parametrize(
    ("name", "settings", "options"),
    [
        ("inclusion", [], "layers=2, where='interfaces', on_inversion='stop', hourglass=0.1"),
        (
            "inclusion",
            ["interpolation.layers=0", "interpolation.hourglass=0.0"],
            "layers=0, where='interfaces', on_inversion='stop', hourglass=0.0",
        ),
        (
            "sphere-inclusion",
            ["interpolation.hourglass=0.0"],
            "layers=2, where='interfaces', on_inversion='stop', hourglass=0.0",
        ),
    ],
)
def test_a_problem_keeps_the_interpolation_of_the_case(name, settings, options, tmp_path):
    given = [word for setting in settings for word in ("--set", setting)]
    shown = matpoint("explain", name, *given, cwd=tmp_path).stdout
    assert f"EnrichedCPDI2({options})" in shown
    assert "<lambda>" not in shown
    assert "<locals>" not in shown
    assert "a function" in shown


def test_help_says_where_results_go(tmp_path):
    assert "results/reproduce-PAPER" in " ".join(matpoint("reproduce", "--help", cwd=tmp_path).stdout.split())


def test_list_names_everything(tmp_path):
    shown = matpoint("list", cwd=tmp_path).stdout
    for name in (
        "bimaterial-bar",
        "two-discs",
        "cantilever",
        "vertical-bar",
        "inclusion",
        "sphere-inclusion",
        "enriched-cpdi2",
        "bspline3",
    ):
        assert name in shown
    for name in (
        "neo-hookean",
        "von-mises",
        "newtonian-fluid",
        "usl",
        "usf",
        "musl",
        "apic",
        "kinetic_energy",
    ):
        assert name in shown


def test_explain_prints_stages_in_order(case, tmp_path):
    shown = matpoint("explain", case, cwd=tmp_path).stdout
    names = [
        "locate",
        "clear",
        "particles to nodes",
        "solve",
        "conditions",
        "nodes to particles and stress",
        "advance",
    ]
    places = [shown.index(f". {name}:") for name in names]
    assert places == sorted(places)
    assert "reads position" in shown
    assert "16 particles" in shown
    musl = matpoint("explain", case, "--set", "scheme.order=musl", cwd=tmp_path).stdout
    assert "momentum to nodes" in musl


def test_explain_says_the_step_of_a_consistent_mass(tmp_path):
    shown = matpoint("explain", "mms-1d", "--set", "interpolation.method=spline-imls", cwd=tmp_path).stdout
    assert (
        "stable up to 0.0001341 s with its consistent mass; in long runs noise grows above 3.18e-05 s"
        in shown
    )


def test_info_cite_and_schema(case, tmp_path):
    shown = matpoint("info", cwd=tmp_path).stdout
    for word in ("numba", "threads", "vector width", "cache"):
        assert word in shown
    cited = matpoint("cite", case, cwd=tmp_path).stdout
    assert "@article{sadeghirad2013" in cited
    assert "@article{bardenhagen2004" not in cited  # no GIMP in this case
    schema = json.loads(matpoint("schema", cwd=tmp_path).stdout)
    assert set(schema["properties"]) >= {"grid", "materials", "bodies", "interpolation", "time", "output"}
    assert "neo-hookean" in json.dumps(schema)


def test_version_and_help(tmp_path):
    assert matpoint("--version", cwd=tmp_path).stdout.strip() == "0.1.0"
    shown = matpoint("--help", cwd=tmp_path).stdout
    for command in ("run", "verify", "list", "explain", "info", "cite", "schema"):
        assert command in shown


def test_verify_prints_one_json_object(tmp_path):
    done = matpoint(
        "verify", "bimaterial-bar", "--json", "--methods", "cpdi2,enriched-cpdi2,fem", cwd=tmp_path
    )
    result = json.loads(done.stdout)
    assert set(result) == {"cpdi2", "enriched-cpdi2", "fem"}
    assert set(result["cpdi2"]) == {"tip", "sigma_b", "sigma_c", "jump"}
    assert list(tmp_path.iterdir()) == []
    refused = matpoint("verify", "bimaterial-bar", "--methods", "magic", cwd=tmp_path, code=2)
    assert "magic" in refused.stderr
    refused = matpoint("verify", "cantilever", cwd=tmp_path, code=2)
    assert "[problem]" in refused.stderr


def test_verify_draws_the_figures_of_the_paper(tmp_path):
    shown = matpoint("verify", "bimaterial-bar", "--methods", "cpdi2,fem", "--out", "v", cwd=tmp_path).stdout
    assert "jump" in shown
    assert len(list((tmp_path / "v").glob("figure-*.png"))) == 3
    assert json.loads((tmp_path / "v" / "verify.json").read_text())["fem"]["tip"] == 0.0


PLUGIN = """
import matpoint as mp

def law(F, F_new, L, dt, state, params):
    # Linear in the small strain, written out.
    xx, yy, zz = F_new[0][0] - 1.0, F_new[1][1] - 1.0, F_new[2][2] - 1.0
    xy, yz, xz = (0.5 * (F_new[0][1] + F_new[1][0]), 0.5 * (F_new[1][2] + F_new[2][1]),
                  0.5 * (F_new[0][2] + F_new[2][0]))
    p, m = params.lam * (xx + yy + zz), 2.0 * params.mu
    return ((p + m * xx, m * xy, m * xz), (m * xy, p + m * yy, m * yz), (m * xz, m * yz, p + m * zz))

def make(lam, mu, density):
    return mp.UserMaterial(law, {"lam": lam, "mu": mu}, density, modulus=lam + 2 * mu)

mp.register_material("my-law", make)
"""


def test_a_users_law_needs_the_plugin_on_the_command_line(tmp_path):
    own = SMALL.replace('law = "neo-hookean"\nE = 1e5\nnu = 0.3', 'law = "my-law"\nlam = 6e4\nmu = 4e4')
    (tmp_path / "own.toml").write_text(own)
    (tmp_path / "law.py").write_text(PLUGIN)
    refused = matpoint("run", "own.toml", cwd=tmp_path, code=2)
    assert "--plugin" in refused.stderr
    matpoint("run", "own.toml", "--plugin", "law.py", cwd=tmp_path)
    assert json.loads((tmp_path / "results/own/summary.json").read_text())["status"] == "finished"
    (tmp_path / "bad.py").write_text("import matpoint\n1 / 0\n")
    refused = matpoint("run", "own.toml", "--plugin", "bad.py", "--out", "x", cwd=tmp_path, code=2)
    assert "ZeroDivisionError" in refused.stderr
    refused = matpoint("run", "own.toml", "--plugin", "none.py", "--out", "x", cwd=tmp_path, code=2)
    assert "no such file" in refused.stderr


def test_checkpoint_and_restart_give_the_same_end(case, tmp_path):
    more = ["--set", "output.checkpoint.every_steps=20"]
    matpoint("run", case, *more, "--out", "a", cwd=tmp_path)
    matpoint("run", case, *more, "--set", "time.end=0.04", "--out", "b", cwd=tmp_path)
    matpoint("run", case, "--restart", "b/checkpoint.h5", "--out", "c", cwd=tmp_path)
    last = [list(csv.reader((tmp_path / d / "history.csv").open()))[-1] for d in "ac"]
    assert last[0] == last[1]
    refused = matpoint("run", case, "--restart", "b/history.csv", "--out", "d", cwd=tmp_path, code=2)
    assert "restart" in refused.stderr
    assert not (tmp_path / "d").exists()
    for missing in ("b", "none.h5"):
        refused = matpoint("run", case, "--restart", missing, "--out", "d", cwd=tmp_path, code=2)
        assert f"restart: {missing} can't be read: it is not a file" in refused.stderr
    with h5py.File(tmp_path / "b" / "checkpoint.h5", "r+") as file:
        file["particles.velocity"][0, 0] = float("nan")  # type: ignore[index]
    refused = matpoint("run", case, "--restart", "b/checkpoint.h5", "--out", "d", cwd=tmp_path, code=2)
    assert "b/checkpoint.h5 is damaged: particles.velocity" in refused.stderr
    assert not (tmp_path / "d").exists()


@pytest.mark.parametrize(
    ("setting", "told"),
    [
        ("bodies.0.velocity=[1e308, 1e308]", "CFL finds no step above 0"),
        ("materials.rubber.density=1e308", "is too large for a number"),
        ("materials.rubber.density=1e-308", "the wave speed of its material is inf m/s"),
        (
            "bodies.0.region.centre=[0.25, 0.25, 0.25]",
            "region.centre: 3 components given; the grid has 2 axes",
        ),
        ('output.history.quantities=["momentum_x", "momentum_x"]', "two columns are named 'momentum_x'"),
    ],
)
def test_numbers_that_can_not_be_used_are_refused_before_anything_is_written(setting, told, tmp_path):
    done = matpoint("run", "two-discs", "--set", setting, "--quiet", "--out", "o", cwd=tmp_path, code=2)
    assert told in done.stderr
    assert [line.split()[0] for line in done.stderr.splitlines()] == ["error:"]
    assert not (tmp_path / "o").exists()


def test_a_run_that_fails_exits_3_with_readable_files(tmp_path):
    fast = SMALL.replace("per_cell = 2", "per_cell = 2\nvelocity = [8.0]").replace(
        "[[boundaries]]", "[[dropped]]"
    )
    fast = fast.replace('[[dropped]]\nkind = "fixed"\nplane = { axis = "y", at = 1.0, side = "upper" }\n', "")
    (tmp_path / "fast.toml").write_text(fast)
    done = matpoint("run", "fast.toml", cwd=tmp_path, code=3)
    assert done.stderr.strip().splitlines()[-1].startswith("error: step ")
    for word in ("particle", "at (", "left the grid"):
        assert word in done.stderr
    out = tmp_path / "results" / "fast"
    summary = json.loads((out / "summary.json").read_text())
    assert summary["status"] == "failed"
    assert summary["error"]["particle"] is not None
    from test_output import _read_vtk

    steps = _read_vtk(out / "results.vtkhdf")
    assert len(steps) == summary["error"]["step"] // 10 + 1
    assert len(list(csv.reader((out / "history.csv").open()))) >= 3


def test_an_unstable_run_says_so(tmp_path):
    wild = SMALL.replace("step = 1e-3", "step = 3e-2\nallow_unstable = true").replace(
        "end = 0.05", "end = 30.0"
    )
    (tmp_path / "wild.toml").write_text(wild)
    done = matpoint("run", "wild.toml", cwd=tmp_path, code=3)
    assert "over the stability limit" in done.stderr
    assert "error: step" in done.stderr


def test_ctrl_c_ends_cleanly(case, tmp_path):
    process = subprocess.Popen(
        [sys.executable, "-m", "matpoint", "run", str(case), "--set", "time.end=1e6", "--out", "long"],
        stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True, cwd=tmp_path,
    )  # fmt: skip
    history = tmp_path / "long" / "history.csv"
    for _ in range(600):
        if history.exists() and history.read_text().count("\n") > 5:
            break
        time.sleep(0.1)
    process.send_signal(signal.SIGINT)
    _, shown = process.communicate(timeout=60)
    assert process.returncode == 130
    assert "interrupted" in shown
    assert "Traceback" not in shown
    assert json.loads((tmp_path / "long" / "summary.json").read_text())["status"] == "interrupted"
    assert np.isfinite([float(v) for v in list(csv.reader(history.open()))[-1]]).all()


BAD = {
    "unknown key": (["grid.size=1"], "grid.size: unknown key"),
    "did you mean": (["time.stop=1"], "did you mean 'step'"),
    "unknown table": (["grids.lower=[0]"], "did you mean 'grid'"),
    "wrong type": (["time.end=soon"], "time.end = 'soon'"),
    "a number as text": (["materials.rubber.E=stiff"], "materials.rubber"),
    "negative cell": (["grid.cell=-0.25"], "cell"),
    "zero cell": (["grid.cell=0.0"], "cell"),
    "odd box": (["grid.cell=0.3"], "whole number"),
    "upper below lower": (["grid.upper=[-1.0, 1.0]"], "greater"),
    "E": (["materials.rubber.E=-1.0"], "E"),
    "E zero": (["materials.rubber.E=0.0"], "E"),
    "nu": (["materials.rubber.nu=0.5"], "nu"),
    "nu low": (["materials.rubber.nu=-1.0"], "nu"),
    "density": (["materials.rubber.density=0.0"], "density"),
    "law": (["materials.rubber.law=neo-hokean"], "did you mean 'neo-hookean'"),
    "law's parameter": (["materials.rubber.mu=1.0"], "mu"),
    "outside": (["bodies.0.region.upper=[0.75, 2.0]"], "outside the grid"),
    "no particles": (
        ["bodies.0.region.lower=[0.26, 0.51]", "bodies.0.region.upper=[0.27, 0.52]"], "no particles",
    ),
    "no bodies": (["bodies=[]"], "no bodies"),
    "per_cell": (["bodies.0.per_cell=0"], "per_cell"),
    "material": (["bodies.0.material=ruber"], "did you mean 'rubber'"),
    "two bodies in one place": (
        ['bodies=[{material="rubber", region={shape="box", lower=[0.25,0.5], upper=[0.75,1.0]}},'
         ' {material="rubber", region={shape="box", lower=[0.5,0.5], upper=[1.0,1.0]}}]'],
        "lie in one place",
    ),
    "method": (["interpolation.method=cpd2"], "did you mean 'cpdi2'"),
    "option of another method": (["interpolation.layers=1"], "layers"),
    "negative layers": (["interpolation.method=enriched-cpdi2", "interpolation.layers=-1"], "layers"),
    "stretch": (["interpolation.method=cpgimp", "interpolation.stretch=V"], "stretch"),
    "apic with vertices": (["scheme.transfer=apic"], "APIC"),
    "blend": (["scheme.blend=2.0"], "blend"),
    "order": (["scheme.order=uls"], "did you mean 'usl'"),
    "end before the start": (["time.end=-1.0"], "time.end"),
    "no step": (["time.cfl=0.4"], "step"),
    "long step": (["time.step=0.1"], "over the stability limit"),
    "zero step": (["time.step=0.0"], "dt"),
    "NaN": (["time.end=nan"], "time.end"),
    "NaN in the grid": (["grid.lower=[nan, 0.0]"], "grid.lower"),
    "inverted mesh": (
        ['bodies.0={material="rubber", mesh={shape="arrays", kind="quad", vertices=[[0.25,0.5],[0.5,0.5],'
         "[0.5,0.75],[0.25,0.75]], cells=[[0,3,2,1]]}}"],
        "inverted",
    ),
    "dangling cell": (
        ['bodies.0={material="rubber", mesh={shape="arrays", kind="tri", vertices=[[0.25,0.5],[0.5,0.5],'
         "[0.5,0.75]], cells=[[0,1,7]]}}"],
        "cell 0",
    ),
    "3-D mesh in 2-D": (
        ['bodies.0={material="rubber", mesh={shape="box", lower=[0.0,0.0,0.0], upper=[1.0,1.0,1.0],'
         " divisions=[2,2,2]}}"],
        "3-D",
    ),
    "plane off the grid lines": (["boundaries.0.plane.at=0.9"], "not on a line"),
    "axis that is not there": (["boundaries.0.plane.axis=z"], "does not exist"),
    "region without nodes": (
        ['boundaries.0={kind="fixed", region={shape="ball", centre=[0.1,0.1], radius=0.01}}'], "no node",
    ),
    "gravity": (["loads.0.value=[0.0, 0.0, -1.0]"], "gravity"),
    "expression": (['loads.0={kind="body-force", value=["__import__(1)"]}'], "expression"),
    "quantity": (['output.history.quantities=["heat"]'], "heat"),
    "trigger": (["output.vtk.every_time=0.1"], "give one of"),
    "colour": (['output.figures=[{colour="taste"}]'], "colour"),
    "escape": (['output.figures=[{name="../x"}]'], "leads out"),
    "shape": (['bodies.0.region={shape="cube"}'], "allowed are"),
    "bad override": (["time"], "table.key=value"),
}  # fmt: skip


@pytest.mark.parametrize("what", BAD, ids=str)
def test_bad_input_is_one_message_exit_2_and_nothing_written(what, case, tmp_path):
    settings, expected = BAD[what]
    arguments = [a for s in settings for a in ("--set", s)]
    done = matpoint("run", case, *arguments, "--out", "out", cwd=tmp_path, code=2)
    assert expected in done.stderr, done.stderr
    lines = done.stderr.strip().splitlines()
    assert len(lines) == 1, done.stderr
    assert lines[0].startswith("error: ")
    assert done.stdout == ""
    assert sorted(p.name for p in tmp_path.iterdir()) == ["small.toml"]


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (["run", "nowhere.toml"], "neither a file nor a bundled case"),
        (["run", "cantilver"], "did you mean 'cantilever'"),
        (["run", "broken.toml"], "not valid TOML"),
        (["run", "binary.toml"], "can't be read"),
        (["run", "small.toml", "--out", "small.toml"], "is a file"),
        (["run", "small.toml", "--out", "small.toml/below"], "can't be used"),
        (["run", "small.toml", "--threads", "0"], "threads"),
        (["run", "small.toml", "--speed", "9"], "--speed"),
        (["fly"], "fly"),
        (["run"], "run: CASE is missing"),
        (["explain", "nowhere"], "neither"),
    ],
)
def test_bad_commands(arguments, expected, case, tmp_path):
    (tmp_path / "broken.toml").write_text("[grid\nlower = ]")
    (tmp_path / "binary.toml").write_bytes(b"\xff\xfe\x00")
    before = sorted(p.name for p in tmp_path.iterdir())
    done = matpoint(*arguments, cwd=tmp_path, code=2)
    assert expected in done.stderr
    assert sorted(p.name for p in tmp_path.iterdir()) == before


def test_a_folder_that_cant_be_written(case, tmp_path):
    # Not even root can make folders in /proc.
    done = matpoint("run", case, "--out", "/proc/matpoint", cwd=tmp_path, code=2)
    assert "can't be used" in done.stderr


def test_import_is_light(tmp_path):
    heavy = ("numba", "h5py", "matplotlib", "scipy", "vtk")
    code = f"import sys, matpoint; print([m for m in {heavy} if m in sys.modules])"
    done = subprocess.run(
        [sys.executable, "-c", code], check=True, capture_output=True, text=True, cwd=tmp_path
    )
    assert done.stdout.strip() == "[]"


def test_reproduce_refuses_a_paper_that_it_does_not_know(tmp_path):
    refused = matpoint("reproduce", "cpdi3", cwd=tmp_path, code=2)
    assert "did you mean 'cpdi2'" in refused.stderr
    assert list(tmp_path.iterdir()) == []


STUDY = ("converge", "mms-1d", "--set", "problem.dt=1e-4")


def velocities(done):
    return {m: [e["velocity"] for e in es] for m, es in json.loads(done.stdout).items() if m != "order"}


def test_converge_takes_transfers_and_options_and_its_folder_says_so(tmp_path):
    sizes = ("--cells", "4,8", "--methods", "imls,mls")
    plain = velocities(matpoint(*STUDY, *sizes, "--json", cwd=tmp_path))
    transfer = ("--set", "scheme.transfer=xpic", "--set", "scheme.terms=3")
    options = ("--set", "interpolation.degree=1", "--set", "interpolation.basis=bspline2")
    done = matpoint(*STUDY, *sizes, *transfer, *options, "--json", "--out", "study", cwd=tmp_path)
    found = velocities(done)
    assert all(a != b for m in plain for a, b in zip(plain[m], found[m], strict=True))
    settings = json.loads((tmp_path / "study" / "settings.json").read_text())
    assert settings["transfer"] == "XPIC(order=3)"
    assert "basis=BSpline(degree=2), degree=1" in settings["interpolations"]["mls"]
    table = (tmp_path / "study" / "table.txt").read_text()
    assert "transfer: XPIC(order=3)" in table
    assert "imls: basis = BSpline(degree=2), degree = 1" in table
    again = matpoint(*STUDY, *sizes, *transfer, *options, "--json", cwd=tmp_path)
    assert again.stderr.count("(kept)") == 4
    order = matpoint(*STUDY, *sizes, "--set", "scheme.order=musl", "--json", cwd=tmp_path)
    assert velocities(order) != plain


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (
            ("--methods", "imls,cpdi2", "--set", "interpolation.degree=1"),
            "degree: cpdi2 has no",
        ),
        (("--methods", "imls,mls", "--set", "interpolation.raw=true"), "interpolation.raw: imls has no"),
        (("--methods", "imls", "--set", "interpolation.points=9"), "points = 9 must be from 1 to 4"),
        (("--methods", "imls", "--set", "interpolation.method=mls"), "--methods"),
        (("--set", "scheme.transfer=xpic"), "spline-imls with XPIC"),
        (("--set", "problem.random=3", "--methods", "cpdi1,cpdi2"), "cpdi2 needs domains that share corners"),
        (("--methods", "mpm", "--set", "scheme.terms=3"), "scheme.terms"),
        (("--methods", "mpm", "--set", "scheme.blend=2"), "scheme.blend"),
        (("--methods", "mpm", "--set", "scheme.transfer=best"), "allowed are flip"),
        (("--methods", "mpm", "--set", "scheme.kind=usl"), "scheme.kind: unknown key"),
        (("--methods", "mpm", "--set", "scheme.order=usl", "--set", "problem.scheme=musl"), "set one"),
        (("--methods", "mpm", "--set", "time.end=1"), "scheme.*"),
        (("--methods", "mpm", "--set", "problem.amplitude=5"), "the motion folds"),
        (("--cells", "4000000000", "--methods", "mpm"), "GB"),
        (("--cells", "1", "--methods", "mpm"), "cells = 1"),
        (("--cells", "8,x", "--methods", "mpm"), "--cells"),
        (
            ("--cells", "8,16", "--set", "problem.dt=0.005", "--methods", "mpm"),
            "mpm on 8 cells: time step: dt",
        ),
    ],
)
def test_converge_refuses_before_it_writes(arguments, told, tmp_path):
    done = matpoint(*STUDY, *arguments, "--out", "study", cwd=tmp_path, code=2)
    assert told in done.stderr
    assert done.stderr.count("\n") == 1
    assert not (tmp_path / "study").exists()


def test_converge_fails_if_no_run_finished_and_only_then(tmp_path):
    sparse = ("converge", "mms-2d", "--cells", "8", "--set", "problem.per_cell=1", "--out", "study")
    done = matpoint(*sparse, "--methods", "mls", cwd=tmp_path, code=3)
    assert "error: none of 1 runs reached its end" in done.stderr
    assert (tmp_path / "study" / "converge.json").is_file()
    done = matpoint(*sparse, "--methods", "mls,cpdi1", cwd=tmp_path)
    assert re.search(r"mls with 8 cells failed: step \d+, t = ", done.stdout)  # which one depends on rounding


def test_verify_names_the_method_that_failed_its_step_and_why(tmp_path):
    """As converge does: exit code 3 if no run reached its end, and only then."""
    sparse = ("verify", "mms-2d", "--set", "problem.cells=8", "--set", "problem.per_cell=1")
    done = matpoint(*sparse, "--methods", "mls", "--out", "v", cwd=tmp_path, code=3)
    assert re.search(r"mls failed: step \d+, t = [\d.]+ s, particle \d+ at", done.stdout)
    assert "nan" not in done.stdout
    assert "error: none of 1 runs reached its end; mls failed: step " in done.stderr
    kept = json.loads((tmp_path / "v" / "verify.json").read_text())["mls"]
    assert re.match(r"step \d+, ", kept["failed"])
    assert kept["velocity"] is None
    done = matpoint(*sparse, "--methods", "mls,cpdi1", "--json", cwd=tmp_path)
    found = json.loads(done.stdout)
    assert found["mls"]["failed"].startswith("step ")
    assert found["cpdi1"]["failed"] is None


@pytest.mark.parametrize(
    ("settings", "told"),
    [
        (("problem.random=3",), "mms-2d: cpdi2 needs domains that share corners"),
        (("problem.dt=0.005",), "mms-2d: cpdi2: time step: dt = 0.005 s is over"),
        (("problem.cells=4000000000",), "GB"),
    ],
)
def test_verify_refuses_before_it_writes(settings, told, tmp_path):
    given = [word for setting in settings for word in ("--set", setting)]
    done = matpoint("verify", "mms-2d", *given, "--methods", "cpdi2", "--out", "v", cwd=tmp_path, code=2)
    assert told in done.stderr
    assert "allow_unstable" not in done.stderr  # nothing sets it here
    assert [line.split()[0] for line in done.stderr.splitlines()] in (["error:"], ["compiling", "error:"])
    assert not (tmp_path / "v").exists()


def test_converge_extends_its_folder_without_force(tmp_path):
    arguments = (*STUDY, "--methods", "cpdi2", "--out", "study", "--cells")
    matpoint(*arguments, "4", cwd=tmp_path)
    (tmp_path / "study" / "notes.md").write_text("mine")
    matpoint(*arguments, "4,8", cwd=tmp_path)
    found = json.loads((tmp_path / "study" / "converge.json").read_text())
    assert [e["cells"] for e in found["cpdi2"]] == [4, 8]
    refused = matpoint(*arguments, "8", cwd=tmp_path, code=2)
    assert "cpdi2 on 4 cells; name these too" in refused.stderr
    refused = matpoint(*arguments, "4,8", "--set", "problem.amplitude=0.05", cwd=tmp_path, code=2)
    assert "amplitude = 0.1, here 0.05" in refused.stderr
    assert json.loads((tmp_path / "study" / "converge.json").read_text()) == found
    matpoint(*arguments, "8", "--force", cwd=tmp_path)
    assert (tmp_path / "study" / "notes.md").read_text() == "mine"


def test_a_cache_that_can_not_be_written_is_named_once(tmp_path):
    (tmp_path / "file").write_text("")
    blocked = os.environ | {"MATPOINT_CACHE": str(tmp_path / "file")}
    blocked.pop("NUMBA_CACHE_DIR", None)
    code = "import matpoint.jit; print(matpoint.jit._USABLE)"
    done = subprocess.run(
        [sys.executable, "-c", code], env=blocked, capture_output=True, text=True, check=True
    )
    assert done.stdout == "False\n"
    assert done.stderr.count("compiled code is not kept") == 1
    done = matpoint("list", cwd=tmp_path, env=blocked)
    warned = [
        line for line in done.stderr.splitlines() if line.startswith("warning: compiled code is not kept")
    ]
    assert len(warned) == len(done.stderr.splitlines()) == 1
    assert str(tmp_path / "file") in warned[0]

"""What runs leave in their folders, and what they leave alone; from the command line."""

from __future__ import annotations

import csv
import json
import signal
import subprocess
import sys
import time

import pytest
from test_cli import PLUGIN, matpoint

from cases import SMALL

BODY_FORCE = "loads.0={kind='body-force', value=['%s', '0']}"


@pytest.fixture
def case(tmp_path):
    path = tmp_path / "small.toml"
    path.write_text(SMALL)
    return path


def test_force_leaves_the_files_of_others(case, tmp_path):
    arguments = ["run", case, "--quiet", "--out", "here"]
    matpoint(*arguments, "--set", "output.checkpoint.every_steps=20", cwd=tmp_path)
    here = tmp_path / "here"
    for name in ("mine.csv", "mine.toml", "mine.png", "mine.json", "mine.bib", "mine.h5", "notes.md"):
        (here / name).write_text("mine")
    matpoint(*arguments, "--force", cwd=tmp_path)
    assert not (here / "checkpoint.h5").exists()  # of the earlier run
    assert sorted(p.name for p in here.iterdir() if not p.name.startswith("mine")) == [
        ".matpoint-files", "history.csv", "notes.md", "results.vtkhdf", "summary.json",
    ]  # fmt: skip
    assert all(p.read_text() == "mine" for p in here.glob("mine.*"))
    assert len(list(here.glob("mine.*"))) == 6
    shown = " ".join(matpoint("run", "--help", cwd=tmp_path).stdout.replace("│", " ").split())
    assert "no other file is removed or overwritten" in shown


@pytest.mark.parametrize("name", ["summary.json", "history.csv", "block-003.png"])
def test_files_of_others_that_a_run_would_overwrite_are_refused(case, tmp_path, name):
    (tmp_path / "here").mkdir()
    (tmp_path / "here" / name).write_text("mine")
    figure = 'output.figures=[{name="block", every_steps=10}]'
    done = matpoint("run", case, "--set", figure, "--out", "here", "--force", cwd=tmp_path, code=2)
    assert f"holds {name}, which no run is known to have written" in done.stderr
    assert [(p.name, p.read_text()) for p in (tmp_path / "here").iterdir()] == [(name, "mine")]


def test_verify_leaves_the_files_of_others(tmp_path):
    arguments = ["verify", "bimaterial-bar", "--methods", "cpdi2,fem", "--out", "v"]
    matpoint(*arguments, cwd=tmp_path)
    (tmp_path / "v" / "mine.png").write_text("mine")
    matpoint(*arguments, "--force", cwd=tmp_path)
    (tmp_path / "v" / ".matpoint-files").unlink()
    assert "would overwrite" in matpoint(*arguments, "--force", cwd=tmp_path, code=2).stderr
    assert (tmp_path / "v" / "mine.png").read_text() == "mine"


def test_help_of_verify_says_what_json_leaves_out(tmp_path):
    shown = " ".join(matpoint("verify", "--help", cwd=tmp_path).stdout.replace("│", " ").split())
    assert "without --out no figures are drawn" in shown


def test_a_restart_into_the_folder_of_its_checkpoint_is_refused(case, tmp_path):
    matpoint("run", case, "--set", "output.checkpoint.every_steps=20", "--out", "a", cwd=tmp_path)
    before = {p: p.read_bytes() for p in (tmp_path / "a").iterdir()}
    (tmp_path / "link").symlink_to(tmp_path / "a")
    more = ["--restart", "a/checkpoint.h5", "--force", "--set", "time.end=0.06"]
    for out in ("a", "./a/../a", "link"):
        done = matpoint("run", case, *more, "--out", out, cwd=tmp_path, code=2)
        assert "choose another folder with --out" in done.stderr
    assert {p: p.read_bytes() for p in (tmp_path / "a").iterdir()} == before
    matpoint("run", case, *more, "--out", "b", cwd=tmp_path)


def test_a_restart_with_a_users_material(tmp_path):
    own = SMALL.replace('law = "neo-hookean"\nE = 1e5\nnu = 0.3', 'law = "my-law"\nlam = 6e4\nmu = 4e4')
    (tmp_path / "own.toml").write_text(own)
    (tmp_path / "law.py").write_text(PLUGIN)
    more = ["--plugin", "law.py", "--set", "output.checkpoint.every_steps=20"]
    matpoint("run", "own.toml", *more, "--out", "a", cwd=tmp_path)
    matpoint("run", "own.toml", *more, "--out", "b", "--set", "time.end=0.06",
             "--set", "loads.0.value=[0.0, -5.0]", "--restart", "a/checkpoint.h5", cwd=tmp_path)  # fmt: skip
    done = matpoint("run", "own.toml", *more, "--out", "c", "--set", "materials.rubber.mu=3e4",
                    "--restart", "a/checkpoint.h5", cwd=tmp_path, code=2)  # fmt: skip
    assert "materials differ" in done.stderr
    shown = matpoint("explain", "own.toml", "--plugin", "law.py", cwd=tmp_path).stdout
    assert "UserMaterial(function=law, parameters={lam=60000.0, mu=40000.0}" in shown
    assert " at 0x" not in shown + (tmp_path / "a" / "summary.json").read_text()
    assert "mappingproxy" not in shown


@pytest.mark.parametrize(
    ("setting", "where"),
    [
        (BODY_FORCE % "1/(t-t)", "loads.0: "),
        (BODY_FORCE % "log(t)", "loads.0: "),
        ("loads.0.history=log(t)", "loads.0.history: "),
        (
            "boundaries.0={kind='velocity', plane={axis='y', at=1.0}, velocity=['sqrt(-1-t)', 'free']}",
            "boundaries.0.velocity: ",
        ),
    ],
)
def test_what_is_not_finite_at_the_start_leaves_no_folder(case, tmp_path, setting, where):
    done = matpoint("run", case, "--set", setting, "--out", "out", cwd=tmp_path, code=2)
    assert done.stderr.startswith(f"error: {where}")
    assert "not a finite number at t = 0 s" in done.stderr
    assert len(done.stderr.strip().splitlines()) == 1  # no warning of NumPy's
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    "setting",
    [
        BODY_FORCE % "1/step(0.0201-t)",
        "loads.0.history=1/step(0.0201-t)",
        "boundaries.0={kind='velocity', plane={axis='y', at=1.0}, velocity=['sqrt(0.0201-t)', 'free']}",
    ],
)
def test_what_is_not_finite_later_ends_the_run(case, tmp_path, setting):
    done = matpoint("run", case, "--set", setting, "--out", "out", "--quiet", cwd=tmp_path, code=3)
    assert done.stderr.startswith("error: step 2")
    assert "finite number at t = 0.02" in done.stderr
    assert len(done.stderr.strip().splitlines()) == 1
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert summary["status"] == "failed"
    assert summary["error"]["step"] in (20, 21)


def test_sigterm_ends_as_ctrl_c_does(case, tmp_path):
    process = subprocess.Popen(
        [sys.executable, "-m", "matpoint", "run", str(case), "--set", "time.end=1e6", "--out", "long"],
        stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True, cwd=tmp_path,
    )  # fmt: skip
    history = tmp_path / "long" / "history.csv"
    for _ in range(600):
        if history.exists() and history.read_text().count("\n") > 5:
            break
        time.sleep(0.1)
    process.send_signal(signal.SIGTERM)
    _, shown = process.communicate(timeout=60)
    assert process.returncode == 143
    assert "terminated" in shown
    assert "Traceback" not in shown
    summary = json.loads((tmp_path / "long" / "summary.json").read_text())
    assert (summary["status"], summary["error"]["cause"]) == (
        "interrupted",
        "terminated by a signal (SIGTERM)",
    )
    assert summary["ledger"]["end"]["time"] == summary["time"]
    assert len({len(row) for row in csv.reader(history.open())}) == 1


def test_a_plugin_that_exits_is_refused(case, tmp_path):
    (tmp_path / "leave.py").write_text("import sys\nsys.exit(0)\n")
    done = matpoint("run", case, "--plugin", "leave.py", "--out", "out", cwd=tmp_path, code=2)
    assert "leave.py: SystemExit" in done.stderr
    assert not (tmp_path / "out").exists()


def test_a_step_over_the_limit_is_told_once_and_again_where_it_ends(case, tmp_path):
    more = ["--set", "time={end=30.0, step=3e-2, allow_unstable=true}", "--quiet", "--out", "out"]
    done = matpoint("run", case, *more, cwd=tmp_path, code=3)
    *before, last = done.stderr.strip().splitlines()
    assert len([line for line in before if "is over the stability limit" in line]) == 1
    assert "error: step" in last
    assert "time step: dt = 0.03 s" in last
    assert "limit" in json.loads((tmp_path / "out" / "summary.json").read_text())["error"]["cause"]


def test_the_ledger_and_sorting_are_set_by_the_case(case, tmp_path):
    from matpoint.case import build_simulation, load

    sim = build_simulation(load(str(case), ["time.sample_every=7", "time.sort_every=3"]), threads=1)
    assert (sim.sample_every, sim.sort_every) == (7, 3)
    sim.run(0.01)
    assert sim.ledger.latest.step == sim.step == 10

"""``matpoint bench`` as a user runs it, tiny; and the asv benchmarks, so that they keep running."""

from __future__ import annotations

import importlib.util
import json
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


def matpoint(*arguments, cwd, code=0):
    """Run the command line; return what it printed. A traceback is always a failure."""
    done = subprocess.run(
        [sys.executable, "-m", "matpoint", *arguments],
        check=False, capture_output=True, text=True, cwd=cwd, timeout=600,
    )  # fmt: skip
    assert "Traceback" not in done.stderr, done.stderr
    assert done.returncode == code, (done.returncode, done.stdout, done.stderr)
    return done


def test_bench_prints_one_json_object_and_writes_nothing(tmp_path):
    done = matpoint(
        "bench", "--quick", "--json", "--particles", "64", "--threads", "1,2", "--methods",
        "linear,bspline2,cpdi2,enriched-cpdi2,imls-1-point", cwd=tmp_path,
    )  # fmt: skip
    assert list(tmp_path.iterdir()) == []
    result = json.loads(done.stdout)
    assert {"rows", "native", "triad_gbs", "taichi", "notes"} <= set(result)
    assert len(result["rows"]) == 5 * 2 * 2
    for row in result["rows"]:
        assert {"interpolation", "dim", "threads", "mps", "stages", "cost", "speed_up"} <= set(row)
        assert row["mps"] > 0
        assert row["cost"] > 0
        assert {"particles to nodes", "sort", "rest"} <= set(row["stages"])
    assert result["triad_gbs"] > 0
    for name in ("native", "taichi"):  # null only with a reason
        found = result[name]
        assert found["mps"] > 0 if found else any(note.startswith(f"{name}: ") for note in result["notes"])
    if result["native"]:
        (ratio,) = [r["against_native"] for r in result["rows"] if r["against_native"] is not None]
        assert ratio > 0


def test_bench_without_a_compiler(tmp_path, monkeypatch):
    monkeypatch.setenv("CXX", "no-such-compiler")
    done = matpoint(
        "bench", "--quick", "--particles", "8", "--methods", "bspline2", "--dims", "3", "--threads", "1",
        "--out", "here", cwd=tmp_path,
    )  # fmt: skip
    assert "no-such-compiler" in done.stdout
    assert json.loads((tmp_path / "here" / "bench.json").read_text())["native"] is None
    assert "bspline2" in (tmp_path / "here" / "bench-table.md").read_text()


def test_scale_writes_json_table_and_figure(tmp_path):
    arguments = ["bench", "--quick", "--scale", "64,500", "--threads", "1", "--out", "here"]
    done = matpoint(*arguments, cwd=tmp_path)
    result = json.loads((tmp_path / "here" / "scale.json").read_text())
    found = [(r["interpolation"], r["particles"]) for r in result["rows"]]
    assert found == [("linear", 64), ("linear", 512), ("cpdi2", 64), ("cpdi2", 512)]
    assert all(r["ns"] > 0 and r["bytes_peak"] >= 0 for r in result["rows"])
    assert (tmp_path / "here" / "scale.png").stat().st_size > 1000
    assert "cpdi2" in done.stdout
    matpoint(*arguments, cwd=tmp_path, code=2)
    matpoint(*arguments, "--force", cwd=tmp_path)


@pytest.mark.parametrize(
    ("arguments", "word"),
    [
        (["--particles", "-3"], "--particles"),
        (["--particles", "nan"], "--particles"),
        (["--methods", "cpid2"], "did you mean 'cpdi2'"),
        (["--dims", "4"], "dims"),
        (["--threads", "1,two"], "--threads"),
        (["--scale", "1e4,1e12"], "at most"),
    ],
)
def test_bench_refuses_in_one_line(arguments, word, tmp_path):
    done = matpoint("bench", *arguments, "--out", "here", cwd=tmp_path, code=2)
    (line,) = done.stderr.strip().splitlines()
    assert line.startswith("error: ")
    assert word in line
    assert list(tmp_path.iterdir()) == []


def asv_module(name: str):
    path = ROOT / "benchmarks" / "asv" / f"{name}.py"
    spec = importlib.util.spec_from_file_location(f"asv_{name}", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_asv_configuration_points_at_the_benchmarks():
    folder = ROOT / "benchmarks"
    settings = json.loads((folder / "asv.conf.json").read_text())
    assert (folder / settings["benchmark_dir"] / "stages.py").is_file()
    assert (folder / settings["repo"] / "pyproject.toml").is_file()


def test_asv_stages_and_steps_run(monkeypatch):
    module = asv_module("stages")
    for method in module.INTERPOLATIONS:
        for stage in module.STAGES:
            bench = module.Stages()
            bench.particles = 27
            bench.setup(method, stage)
            for _ in range(bench.number):
                bench.time_stage(method, stage)
        steps = module.Steps()
        steps.particles = 27
        steps.setup(method)
        steps.time_ten_steps(method)
        assert steps.simulation.step == 12


def test_asv_starts_run_with_a_warm_cache(monkeypatch):
    """The cold start takes a minute and is left out; it is the same run."""
    from matpoint.jit import cache_folder

    module = asv_module("start")
    bench = module.Warm()
    module._InFolder.setup(bench)
    bench.cache = str(cache_folder().parent)
    bench.time_run()
    assert (Path(bench.folder) / "out" / "summary.json").is_file()
    bench.teardown()
    started = module.Import()
    started.setup()
    started.time_python_alone()
    started.time_import()
    started.teardown()
    assert issubclass(module.Cold, module._InFolder)

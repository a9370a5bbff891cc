"""Studies: what they plan, how tasks travel, what is kept, and which folders they take."""

from __future__ import annotations

import dataclasses
import json
import re
import subprocess
import sys
import warnings

import pytest

import matpoint as mp
from matpoint import memory
from matpoint.cli.converging import settings_of, split_settings, whole_numbers
from matpoint.cli.study_folder import study_folder
from matpoint.errors import InputError, StudyError
from matpoint.interpolation import CPDI2, IMLS, METHODS, MLS, TLS, BSpline, EnrichedCPDI2, Linear
from matpoint.output.folder import claim, prepare_folder
from matpoint.output.summary import write_json
from matpoint.problems import PROBLEMS, FullWave, ManufacturedProblem, Vortex, Waves2D
from matpoint.problems.errors_track import NORMS
from matpoint.study import Study, converge, plan
from matpoint.study.choices import changed, packed, unpacked
from matpoint.study.store import _say_once, keep, key
from matpoint.study.worker import entry
from matpoint.transfers import APIC, FLIP, FMPM, PIC, XPIC

CHOICES = [
    *METHODS.values(), IMLS(BSpline(3), degree=1, points=1), MLS(raw=True), TLS(boxes=False),
    EnrichedCPDI2(where=mp.Ball((0.0, 1.0), 0.5) | mp.Box((0.0, 0.0), (1.0, 1.0))),
    FLIP(0.9), PIC(), APIC(), XPIC(4), FMPM(3),
]  # fmt: skip


@pytest.mark.parametrize("choice", CHOICES, ids=str)
def test_choices_come_back_from_json_as_they_were(choice):
    assert unpacked(json.loads(json.dumps(packed(choice)))) == choice


def test_choices_of_a_users_own_are_refused():
    @dataclasses.dataclass(frozen=True)
    class IMLS(CPDI2):  # the name of another
        pass

    with pytest.raises(InputError, match="can't be sent to the processes"):
        plan(FullWave(), {"mine": IMLS()})
    assert changed(MLS(raw=True, degree=1)) == "degree = 1, raw = True"
    assert changed(MLS()) == ""


def test_keys_tell_options_and_transfers_apart_but_not_labels():
    def keys(methods, **options):
        return {key(task) for task in plan(FullWave(), methods, [8], **options).tasks.values()}

    plain = keys(["imls"])
    assert keys({"another name": IMLS()}) == plain
    others = [
        keys({"imls": IMLS(degree=1)}), keys({"imls": IMLS(BSpline(2))}), keys(["imls"], transfer=XPIC(2)),
        keys(["imls"], transfer=XPIC(3)), keys(["imls"], transfer=FLIP(0.99)),
    ]  # fmt: skip
    assert len(set.union(plain, *others)) == 6


def test_what_can_not_go_together_is_refused_by_its_name():
    with pytest.raises(InputError, match=r"spline-imls with XPIC.*leave spline-imls out"):
        plan(FullWave(), ["imls", "spline-imls"], [8], XPIC(2))
    for method in ("cpdi2", "enriched-cpdi2"):
        with pytest.raises(InputError, match=f"{method} needs domains that share.*leave {method} out"):
            plan(FullWave(random=3), ["cpdi1", method], [8])
    plan(FullWave(random=3), ["cpdi1"], [8])
    with pytest.raises(InputError, match="cpdi2 with APIC"):
        plan(FullWave(), ["mpm", "cpdi2"], [8], APIC())
    with pytest.raises(InputError, match="printed: imls: reproject = true"):
        plan(FullWave(scheme="usl"), {"printed": IMLS(reproject=True)}, [8])
    with pytest.raises(InputError, match=re.escape("transfer = 'xpic'")):
        plan(FullWave(), ["imls"], [8], "xpic")  # type: ignore[arg-type]
    with pytest.raises(InputError, match="methods\\['a'\\]"):
        plan(FullWave(), {"a": "imls"}, [8])  # type: ignore[dict-item]
    for empty in ({}, []):
        with pytest.raises(InputError, match="no method given"):
            plan(FullWave(), empty, [8])


def test_the_scheme_of_a_method_takes_the_transfer_and_keeps_its_order():
    problem = Vortex()
    scheme = problem.scheme_for(Linear(), XPIC(3))
    assert (scheme.name, scheme.transfer) == ("musl", XPIC(3))
    assert problem.scheme_for(CPDI2()).name == "usl"
    text = plan(problem, {"mpm": Linear(), "coarse": MLS(degree=1)}, [16], FMPM(2)).heading()
    assert "FMPM(order=2)" in text
    assert "coarse: degree = 1" in text


def test_sizes_that_no_machine_holds_are_refused_with_the_reason(monkeypatch):
    monkeypatch.setattr(memory, "free_memory", lambda: 8e9)
    with pytest.raises(InputError, match=r"on 4000000 cells: 1.2e\+07 particles need about 24 GB.*8 GB"):
        plan(FullWave(), ["cpdi2"], [8, 4_000_000])
    with pytest.raises(InputError, match="nodes need about"):
        plan(Waves2D(), ["cpdi2"], [10**15])
    monkeypatch.setattr(memory, "free_memory", lambda: 1e15)
    with pytest.raises(InputError, match=r"particle-steps; up to 1e\+12"):
        plan(FullWave(), ["cpdi2"], [4_000_000])
    assert plan(FullWave(), ["cpdi2"], [100_000]).cells == (100_000,)
    for text in ("4,x", "-3", "8,,9", "9" * 30):
        with pytest.raises(InputError, match="--cells"):
            whole_numbers(text)


@pytest.mark.parametrize("name", [n for n, k in PROBLEMS.items() if issubclass(k, ManufacturedProblem)])
def test_particles_are_counted_without_making_them(name):
    kind = PROBLEMS[name]
    problem = kind(cells=6)
    assert problem.particle_count() == problem.mesh().n
    if hasattr(problem, "random"):
        problem = kind(cells=8, random=2)
        assert problem.particle_count() == pytest.approx(problem.mesh().n, rel=0.2)


def test_a_study_compares_variants_under_labels(tmp_path, monkeypatch):
    monkeypatch.setattr("matpoint.study.store.folder", lambda: tmp_path)
    methods = {"default": CPDI2(), "again": CPDI2(), "splines": BSpline(2)}
    study = converge(FullWave(dt=1e-4), methods, [4], transfer=XPIC(2), processes=1)
    flip = converge(FullWave(dt=1e-4), ["cpdi2"], [4], processes=1)
    found = {label: entries[0]["velocity"] for label, entries in study.entries.items()}
    assert found["default"] == found["again"] != found["splines"]
    assert flip.entries["cpdi2"][0]["velocity"] != found["default"]
    assert "XPIC(order=2)" in study.tables()
    study.refuse_failure()


def failing(*reasons):
    planned = plan(FullWave(), ["cpdi2"], range(8, 8 + len(reasons)))
    entries = [entry(8 + k, dict.fromkeys(NORMS, 1.0), failed=why) for k, why in enumerate(reasons)]
    return Study(planned, {"cpdi2": entries})


def test_only_a_study_without_any_result_fails():
    failing("step 3: it broke", None).refuse_failure()
    with pytest.raises(StudyError, match=r"none of 2 runs.*cpdi2 with 8 cells failed: step 3: it broke"):
        failing("step 3: it broke", "step 9: and so did this").refuse_failure()
    assert StudyError.exit_code == 3


def test_results_that_can_not_be_kept_are_named_once(tmp_path, monkeypatch):
    (tmp_path / "file").write_text("")
    monkeypatch.setattr("matpoint.study.store.folder", lambda: tmp_path / "file" / "studies")
    _say_once.cache_clear()
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        keep("a", {"cells": 8})
        keep("b", {"cells": 8})
    assert len(said) == 1
    assert "results of studies are not kept" in str(said[0].message)


def test_workers_end_with_their_study():
    code = "import os, threading; from matpoint.study.worker import leave_with as leave;"
    code += "threading.Thread(target=leave, args=(os.getppid(),), daemon=True).start();"
    code += "print('stays', flush=True); leave(-1); print('never')"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (1, "stays\n")


def written(folder, planned, sizes):
    """A folder as a study leaves it."""
    prepare_folder(folder)
    write_json(folder / "settings.json", settings_of(planned))
    content = {label: [{"cells": n} for n in sizes] for label in planned.methods}
    write_json(folder / "converge.json", {**content, "order": {}})
    claim(folder / "table.txt").write_text("old")
    return folder


def test_a_folder_is_extended_by_what_repeats_it(tmp_path):
    small, large = plan(FullWave(), ["imls"], [8]), plan(FullWave(), ["imls", "mls"], [8, 16])
    folder = written(tmp_path / "study", small, [8])
    (folder / "notes.md").write_text("mine")
    before = {p.name: p.read_bytes() for p in folder.iterdir()}
    study_folder(folder, False, large)
    assert {p.name: p.read_bytes() for p in folder.iterdir()} == before  # nothing is gone before the end
    for other, why in (
        (plan(FullWave(), ["mls"], [8]), "imls on 8 cells"),
        (plan(FullWave(), ["imls"], [16]), "imls on 8 cells"),
        (plan(FullWave(amplitude=0.05), ["imls"], [8]), "amplitude = 0.1, here 0.05"),
        (plan(FullWave(), ["imls"], [8], XPIC(2)), "transfer = FLIP"),
        (plan(FullWave(), {"imls": IMLS(degree=1)}, [8]), "imls = IMLS"),
        (plan(PROBLEMS["mms-1d-half"](), ["imls"], [8]), "problem = mms-1d"),
    ):
        with pytest.raises(InputError, match=re.escape(why)):
            study_folder(folder, False, other)
    assert {p.name: p.read_bytes() for p in folder.iterdir()} == before
    study_folder(folder, True, plan(FullWave(), ["mls"], [8]))
    assert {p.name for p in folder.iterdir()} == {".matpoint-files", "notes.md"}


def test_files_of_others_are_never_taken(tmp_path):
    planned = plan(FullWave(), ["imls"], [8])
    folder = written(tmp_path / "study", planned, [8])
    (folder / "figure-size.png").write_text("mine")
    with pytest.raises(InputError, match=r"holds figure-size.png, which no run"):
        study_folder(folder, False, planned)
    (folder / "figure-size.png").unlink()
    (tmp_path / "elsewhere").write_text("mine")
    (folder / "table.txt").unlink()
    (folder / "table.txt").symlink_to(tmp_path / "elsewhere")
    with pytest.raises(InputError, match=r"holds table.txt"):
        study_folder(folder, False, planned)
    for name in ("settings.json", "converge.json"):
        text = (folder / name).read_text()
        (folder / name).write_text("[]")
        with pytest.raises(InputError, match="use --force"):
            study_folder(folder, False, planned)
        (folder / name).write_text(text)
    other = tmp_path / "run"
    other.mkdir()
    for name in ("settings.json", "converge.json"):
        (other / name).write_text((folder / name).read_text())  # no list says that a run wrote them
    with pytest.raises(InputError, match="use --force"):
        study_folder(other, False, planned)


@pytest.mark.parametrize("text", ["time.end=1", "interpolation.method=mls", "scheme=musl", "grid.cell=1"])
def test_settings_that_a_study_would_pass_over_are_refused(text):
    with pytest.raises(InputError, match=r"--set"):
        split_settings([text])


def test_a_problem_that_workers_do_not_know_is_refused():
    class Mine(FullWave):
        pass

    with pytest.raises(InputError, match="Mine is no problem that a worker process knows"):
        plan(Mine(), ["cpdi2"], [8])

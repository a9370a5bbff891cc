"""Cases whose bodies are groups of mesh files."""

from __future__ import annotations

import re

import numpy as np
import pytest

import matpoint as mp
from cases import SMALL
from matpoint.case import CaseTable, build_simulation, load
from meshes import MSH22, write

_REGION = 'region = { shape = "box", lower = [0.25, 0.5], upper = [0.75, 1.0] }\nper_cell = 2'


def _case(tmp_path, first, second=""):
    write(tmp_path / "parts.msh", MSH22)
    text = SMALL.replace("upper = [1.0, 1.0]", "upper = [2.0, 2.0]").replace('name = "block"\n', "")
    text = text.replace(_REGION, f"mesh = {first}")
    if second:
        text = text.replace(
            "[interpolation]", f'[[bodies]]\nmaterial = "rubber"\nmesh = {second}\n\n[interpolation]'
        )
    return load(str(write(tmp_path / "case.toml", text)))


def _group(name, more="", path="parts.msh"):
    return f'{{ shape = "file", path = "{path}", group = "{name}"{more} }}'


def test_paths_begin_at_the_case_file(tmp_path, monkeypatch):
    count = []
    real = mp.read_mesh
    monkeypatch.setattr("matpoint.case.files.read_mesh", lambda path: count.append(path) or real(path))
    absolute = _group("soft", path=str(tmp_path / "parts.msh"))
    sim = build_simulation(_case(tmp_path, _group("stiff part"), absolute), threads=1)
    assert len(count) == 1  # two bodies, one file
    assert [body.name for body in sim.bodies] == ["stiff part", "soft"]
    assert sim.particles.volume.sum() == pytest.approx(2.0)
    assert sim.particles.mass.sum() == pytest.approx(2000.0)
    sim.run(0.002)
    assert np.isfinite(sim.particles.position).all()


def test_groups_may_be_ignored(tmp_path):
    case = _case(tmp_path, _group("soft", ', ignore = ["stiff part"]'))
    assert len(build_simulation(case, threads=1).particles) == 2


@pytest.mark.parametrize(
    ("first", "second", "message"),
    [
        (_group("soft"), "", "'stiff part' left out: give each group a body, or name it in ignore"),
        (_group("sofd"), "", "bodies.0: .*no group 'sofd'.*did you mean 'soft'"),
        (_group("soft"), _group("soft"), "bodies.1: .* 'soft' is taken"),
        (_group("soft", path="other.msh"), "", "bodies.0: mesh file .*other.msh: there is no such file"),
        (_group("soft", path="nul\\u0000.msh"), "", "bodies.0: "),
        (_group("soft", ', ignore = ["sstiff part"]'), "", "did you mean 'stiff part'"),
    ],
)
def test_refused(tmp_path, first, second, message):
    with pytest.raises(mp.InputError, match=message) as caught:
        build_simulation(_case(tmp_path, first, second), threads=1)
    assert "\n" not in str(caught.value)


def test_the_schema_has_the_table():
    text = str(CaseTable.model_json_schema())
    assert re.search("FileMesh", text)

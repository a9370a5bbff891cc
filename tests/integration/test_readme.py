"""The README's promises: its Python runs, its commands run, its files exist."""

from __future__ import annotations

import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")
DOCUMENTS = [
    "README.md",
    "ARCHITECTURE.md",
    "CONTRIBUTING.md",
    "docs/notation.md",
    "docs/units.md",
    "docs/manufactured.md",
]


def blocks(language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```$", README, flags=re.MULTILINE | re.DOTALL)


def commands() -> list[list[str]]:
    lines = [line for block in blocks("sh") for line in block.splitlines()]
    words = [shlex.split(line, comments=True) for line in lines]
    return [w for w in words if w]


OURS = [w[1:] for w in commands() if w[0] == "matpoint"]


def run(arguments: list[str], folder: Path) -> str:
    environment = os.environ | {"COLUMNS": "120", "NO_COLOR": "1"}
    done = subprocess.run(
        [sys.executable, *arguments], cwd=folder, env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_readme_begins_with_make_then_python_then_a_picture():
    first = [README.index(sign) for sign in ("make demo", "make test", "```python", "![")]
    assert first == sorted(first)
    assert len(blocks("python")[0].strip().splitlines()) <= 11  # ten lines and a blank one


@pytest.mark.slow
def test_python_that_does_the_same_as_the_demo(tmp_path):
    script = tmp_path / "demo.py"
    script.write_text(blocks("python")[0], encoding="utf-8")
    out = run([str(script)], tmp_path)
    assert "enriched-cpdi2" in out
    assert len(list((tmp_path / "results" / "bimaterial-bar").glob("figure-*.png"))) == 3


def test_python_that_builds_a_run(tmp_path):
    (script,) = blocks("python")[1:]
    path = tmp_path / "run.py"
    path.write_text(script, encoding="utf-8")
    rows = {line.split()[0]: line.split() for line in run([str(path)], tmp_path).splitlines()}
    above, below = (float(rows["enriched-cpdi2"][k]) for k in (1, 6))
    assert above == pytest.approx(below, rel=0.1)
    above, below = (float(rows["cpdi2"][k]) for k in (1, 6))
    assert above > 1.5 * below


@pytest.mark.slow
@pytest.mark.parametrize("words", OURS, ids=[" ".join(w) for w in OURS])
def test_every_command_runs(words, tmp_path):
    quick = ["--quick"] if words[0] == "reproduce" else []  # the same with longer steps
    assert run(["-m", "matpoint", *words, *quick], tmp_path).strip()


def test_other_commands_are_make_targets_or_pip():
    targets = re.findall(r"^([a-z]+):", (ROOT / "Makefile").read_text(encoding="utf-8"), flags=re.MULTILINE)
    for words in commands():
        if words[0] == "make":
            assert words[1] in targets
        else:
            assert words[0] in ("matpoint", "pip")


@pytest.mark.parametrize("document", DOCUMENTS)
def test_links_lead_somewhere(document):
    path = ROOT / document
    for target in re.findall(r"\]\(([^)#]+)\)", path.read_text(encoding="utf-8")):
        if not target.startswith("http"):
            assert (path.parent / target).exists(), target


def test_pictures_are_small():
    pictures = list((ROOT / "docs" / "images").glob("*.png"))
    assert pictures
    assert all(p.stat().st_size < 200_000 for p in pictures)

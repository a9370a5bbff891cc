"""Taichi and Quadrants, if installed: the same step in processes of their own."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path
from statistics import median
from typing import Any

PACKAGES = ("taichi", "quadrants")
_PATIENCE = 900  # seconds


def installed() -> list[str]:
    """Return those of the two packages that can be imported."""
    return [name for name in PACKAGES if find_spec(name) is not None]


def fresh_environment() -> dict[str, str]:
    """Return an environment in which a new interpreter finds this package."""
    root = str(Path(__file__).resolve().parents[2])
    return os.environ | {"PYTHONPATH": os.pathsep.join([root, *filter(None, [os.environ.get("PYTHONPATH")])])}


def _measure(package: str, cells: int, steps: int, rounds: int, threads: int) -> dict[str, Any]:
    numbers = map(str, (cells, steps, rounds, threads))
    command = [sys.executable, "-m", "matpoint.bench.taichi_step", package, *numbers]
    done = subprocess.run(
        command, check=False, capture_output=True, text=True, timeout=_PATIENCE, env=fresh_environment()
    )
    if done.returncode != 0 or not done.stdout.strip():
        last = (done.stderr.strip() or "nothing").splitlines()[-1]
        raise RuntimeError(f"{package} ended with code {done.returncode}: {last}")
    found = json.loads(done.stdout.strip().splitlines()[-1])
    ns = [1e9 * s / steps / found["particles"] for s in found["seconds"]]
    return {
        "package": package, "version": found["version"], "threads": threads, "particles": found["particles"],
        "mps": 1e3 / median(ns), "mps_min": 1e3 / max(ns), "mps_max": 1e3 / min(ns), "ns": median(ns),
        "sum": found["sum"],
    }  # fmt: skip


def measure_rivals(
    cells: int, steps: int, rounds: int, threads: list[int]
) -> tuple[dict[str, Any] | None, list[str]]:
    """Measure what is installed.

    Parameters
    ----------
    cells, steps, rounds
        The block's size, and steps of so many rounds.
    threads
        Numbers of threads to try.

    Returns
    -------
    dict or None
        The fastest, with all under ``"all"``; None if neither package is there or works.
    list of str
        Notes: what is not installed, what failed.
    """
    there = installed()
    notes = [] if there else ["taichi: neither taichi nor quadrants is installed"]
    found = []
    for package in there:
        for count in threads:
            try:
                found.append(_measure(package, cells, steps, rounds, count))
            except (RuntimeError, ValueError, KeyError, OSError, subprocess.SubprocessError) as error:
                notes.append(f"taichi: {error}")
    if not found:
        return None, notes
    return {**max(found, key=lambda one: one["mps"]), "all": found}, notes

"""The study of scale: time per particle-step and memory per particle over the number of particles, in 3-D."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from matpoint.bench.options import BenchOptions
from matpoint.bench.rivals import fresh_environment
from matpoint.bench.suite import free_memory
from matpoint.bench.table import aligned
from matpoint.errors import InputError

COUNTS = (10_000, 100_000, 500_000, 1_000_000, 2_000_000, 4_000_000, 8_000_000)
METHODS = ("linear", "cpdi2")
_SAFETY = 1.2  # on the memory that the size before needed


def run_scale(
    counts: Sequence[int] = COUNTS,
    methods: Sequence[str] = METHODS,
    threads: Sequence[int] = (),
    rounds: int = 3,
    announce: Callable[[str], None] = lambda text: None,
) -> dict[str, Any]:
    """Measure each method at each size, each in a fresh process.

    Parameters
    ----------
    counts
        Numbers of particles.
    methods, threads
        Rows of the benchmark; no threads means one and all.
    rounds
        Of ten steps each; the median counts.
    announce
        Told in a line what comes next.

    Returns
    -------
    dict
        ``rows`` with ``ns`` per particle-step, its smallest and largest, ``stages``, and bytes per
        particle: ``bytes_held`` by the run, ``bytes_setup`` at the peak of the setup, ``bytes_peak`` of all.
        ``notes`` tell which sizes were left out for want of memory.

    Raises
    ------
    InputError
        If a size, method or number of threads can't be.
    """
    if not counts:
        raise InputError("bench: scale needs at least one number of particles")
    checked = [
        BenchOptions(particles=n, methods=tuple(methods), threads=tuple(threads), rounds=rounds)
        for n in counts
    ]
    rows: list[dict[str, Any]] = []
    notes: list[str] = []
    for method in methods:
        per_particle = 0.0
        for count in sorted(option.particles for option in checked):
            need = _SAFETY * per_particle * count
            if need > free_memory():
                notes.append(f"{method}: {count} particles left out: they need about {need / 1e9:.0f} GB")
                continue
            for team in checked[0].threads:
                announce(f"{method}, {count} particles, threads: {team}")
                found = _fresh(method, count, team, rounds)
                if isinstance(found, str):
                    notes.append(f"{method}: {count} particles, threads: {team}: {found}")
                    continue
                rows.append(found)
                per_particle = max(found["bytes_peak"], found["bytes_setup"])
    return {"rows": rows, "notes": notes}


def _fresh(method: str, count: int, threads: int, rounds: int) -> dict[str, Any] | str:
    """Return what a fresh process measured, or what became of it."""
    words = [method, str(count), str(threads), str(rounds)]
    done = subprocess.run(
        [sys.executable, "-m", "matpoint.bench.scale_worker", *words],
        check=False, capture_output=True, text=True, env=fresh_environment(),
    )  # fmt: skip
    if done.returncode != 0:
        last = (done.stderr.strip() or "nothing said").splitlines()[-1]
        return f"its process ended with code {done.returncode}: {last}"
    return dict(json.loads(done.stdout))


def scale_table(result: dict[str, Any]) -> str:
    """Return the study as text."""
    head = ("method", "threads", "particles", "ns", "min", "max", "B held", "B setup", "B peak")
    lines = [
        (r["interpolation"], str(r["threads"]), str(r["particles"]),
         *(f"{r[k]:.0f}" for k in ("ns", "ns_min", "ns_max", "bytes_held", "bytes_setup", "bytes_peak")))
        for r in result["rows"]
    ]  # fmt: skip
    about = "3-D: ns per particle-step; bytes per particle, held by the run, at the peak of setup, of all"
    return "\n".join([about, aligned(head, lines), *(f"note: {note}" for note in result["notes"])])


def draw_scale(result: dict[str, Any], path: Path) -> None:
    """Draw time per particle-step and memory per particle over the number of particles to a PNG."""
    from matplotlib.figure import Figure  # noqa: PLC0415 (slow to import)

    figure = Figure(figsize=(9.0, 3.6), layout="constrained")
    left, right = figure.subplots(1, 2)
    rows = result["rows"]
    for name, threads in dict.fromkeys((r["interpolation"], r["threads"]) for r in rows):
        mine = [r for r in rows if (r["interpolation"], r["threads"]) == (name, threads)]
        n, ns = [r["particles"] for r in mine], [r["ns"] for r in mine]
        spread = [[r["ns"] - r["ns_min"] for r in mine], [r["ns_max"] - r["ns"] for r in mine]]
        label = f"{name}, {threads} thread" + ("s" if threads > 1 else "")
        left.errorbar(n, ns, yerr=spread, marker="o", capsize=3, label=label)
        right.plot(n, [r["bytes_peak"] for r in mine], marker="o", label=label)
    for axes, what in ((left, "time per particle-step [ns]"), (right, "peak memory per particle [bytes]")):
        axes.set_xscale("log")
        axes.set_ylim(0.0, 1.35 * axes.get_ylim()[1])  # room for the legend
        axes.set_xlabel("particles")
        axes.set_ylabel(what)
        axes.legend()
    figure.savefig(path, dpi=120)

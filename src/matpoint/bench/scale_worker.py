"""One size of the study of scale, in a process of its own, since peak memory is a process's.

python -m matpoint.bench.scale_worker METHOD PARTICLES THREADS ROUNDS
"""

from __future__ import annotations

import json
import resource
import sys
from pathlib import Path
from statistics import median
from typing import Any

from matpoint.bench.measure import Row

DIM = 3
_FEW = 512  # particles of the run that loads all compiled code


def memory() -> tuple[int, int]:
    """Return the bytes in use now and at their peak.

    Linux tells them of this process alone. ``ru_maxrss``, taken elsewhere, counts what the parent had when
    it started this one.
    """
    try:
        lines = Path("/proc/self/status").read_text(encoding="ascii").splitlines()
        found = {name: value for name, _, value in (line.partition(":") for line in lines)}
        return int(found["VmRSS"].split()[0]) * 1024, int(found["VmHWM"].split()[0]) * 1024
    except (OSError, KeyError, ValueError):
        unit = 1 if sys.platform == "darwin" else 1024
        peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit
        return peak, peak


def measure(method: str, particles: int, threads: int, rounds: int) -> dict[str, Any]:
    """Return time per particle-step [ns] and memory per particle [bytes], setup and results apart.

    Parameters
    ----------
    method, particles, threads
        As for :class:`~matpoint.bench.measure.Row`, in three dimensions.
    rounds
        Of ten steps each.
    """
    small = Row(method, DIM, _FEW, threads)
    small.measure()
    small.finish()
    now, before = memory()
    row = Row(method, DIM, particles, threads)
    held, setup = memory()
    for _ in range(rounds):
        row.measure()
    _, peak = memory()
    row.finish()
    ns = row.steps_ns
    return {
        "interpolation": method, "dim": DIM, "threads": threads, "particles": row.particles,
        "ns": median(ns), "ns_min": min(ns), "ns_max": max(ns), "stages": row.stages_ns(),
        # A few particles go where others were before.
        "bytes_held": max(held - now, 0) / row.particles,
        "bytes_setup": max(setup - before, 0) / row.particles,
        "bytes_peak": max(peak - before, 0) / row.particles,
    }  # fmt: skip


def main() -> None:
    """Measure and print."""
    method, *numbers = sys.argv[1:]
    print(json.dumps(measure(method, *map(int, numbers))))


if __name__ == "__main__":
    main()

"""What is reported of a row."""

from __future__ import annotations

from collections.abc import Sequence
from statistics import median
from typing import Any

from matpoint.bench.measure import Row
from matpoint.bench.model import bytes_per_stage, operations_per_stage
from matpoint.bench.native import Native


def row_result(row: Row, reference: Row | None, program: Native | None, gbs: float) -> dict[str, Any]:
    """Return a row as JSON holds it, against the reference, the native program and the bandwidth ``gbs``."""
    ns, moved = row.steps_ns, bytes_per_stage(row.name, row.dim)
    computed = operations_per_stage(row.name, row.dim)
    stages = {}
    for name, time in row.stages_ns().items():
        bandwidth = moved[name] / time if name in moved and time > 0 else None
        stages[name] = {
            "ns": time, "share": time / median(ns), "bytes": moved.get(name),
            "operations": computed.get(name), "gbs": bandwidth,
            "of_bandwidth": None if bandwidth is None else bandwidth / gbs,
        }  # fmt: skip
    compared = program is not None and row.name == "bspline2" and row.dim == 3 and row.threads == 1
    return {
        "interpolation": row.name, "dim": row.dim, "threads": row.threads, "mps": 1e3 / median(ns),
        "mps_min": 1e3 / max(ns), "mps_max": 1e3 / min(ns), "ns": median(ns), "rounds_ns": ns,
        "particles": row.particles, "enriched_share": row.enriched,
        "cost": None if reference is None else ratio(ns, reference.steps_ns),
        "against_native": ratio(program.rounds, ns) if compared and program is not None else None,
        "stages": stages,
    }  # fmt: skip


def ratio(above: Sequence[float], below: Sequence[float]) -> float:
    """The median over the rounds of the ratio within a round."""
    return median(a / b for a, b in zip(above, below, strict=False))


def compare_threads(rows: list[dict[str, Any]]) -> None:
    """Give each row its speed-up over the one on one thread."""
    single = {(r["interpolation"], r["dim"]): r for r in rows if r["threads"] == 1}
    for row in rows:
        one = single.get((row["interpolation"], row["dim"]))
        row["speed_up"] = None if one is None else ratio(one["rounds_ns"], row["rounds_ns"])

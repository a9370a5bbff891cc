"""What a step of enriched CPDI2 costs against one of CPDI2, on the bi-material ring.

    python benchmarks/ring_cost.py

Both runs are in one process, and take turns: the median of the ratios of five pairs is printed.
"""

from __future__ import annotations

import statistics
import time

from matpoint.interpolation import METHODS
from matpoint.problems import BimaterialRing

PAIRS, STEPS = 5, 500


def seconds(sim) -> float:
    """Return the wall time [s] of some steps."""
    begin = time.perf_counter()
    for _ in range(STEPS):
        sim.advance(sim.dt)
    return time.perf_counter() - begin


def main() -> None:
    """Measure and print."""
    runs = {
        name: BimaterialRing().simulation(METHODS[name], threads=1) for name in ("cpdi2", "enriched-cpdi2")
    }
    for sim in runs.values():
        seconds(sim)  # compiles
    pairs = [{name: seconds(sim) for name, sim in runs.items()} for _ in range(PAIRS)]
    ratios = [pair["enriched-cpdi2"] / pair["cpdi2"] for pair in pairs]
    for name in runs:
        print(f"{name}: {1e6 * statistics.median(pair[name] for pair in pairs) / STEPS:.0f} us per step")
    print(f"ratio: {statistics.median(ratios):.2f} (from {min(ratios):.2f} to {max(ratios):.2f})")


if __name__ == "__main__":
    main()

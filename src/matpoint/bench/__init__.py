"""How fast it is: ``matpoint bench``, its yardsticks, and the study of scale."""

from __future__ import annotations

from matpoint.bench.options import BenchOptions
from matpoint.bench.suite import run_bench
from matpoint.bench.table import table

__all__ = ["BenchOptions", "run_bench", "table"]

"""The same step in Taichi, or in Quadrants, its successor, when one of them is installed.

    python -m matpoint.bench.taichi_step PACKAGE CELLS STEPS ROUNDS THREADS

Written as users of these packages write it, after the examples that come with them: fields of vectors and
matrices, a loop over particles that the package runs in parallel, static loops over the 27 nodes, atomic
adds. Float64, CPU. It runs in a process of its own and prints one JSON object, as
``benchmarks/native/step.cpp`` does.
"""

from __future__ import annotations

import importlib
import json
import os
import sys
import time
from typing import Any

from matpoint.bench.taichi_kernels import Block, make_step


def start(package: str, threads: int) -> Any:
    """Import the package and make it ready for float64 on so many threads."""
    os.environ.setdefault("TI_LOG_LEVEL", "error")
    ti = importlib.import_module(package)
    ti.init(arch=ti.cpu, default_fp=ti.f64, cpu_max_num_threads=threads, offline_cache=True)
    return ti


def main() -> None:
    """Measure and print."""
    package, *numbers = sys.argv[1:]
    cells, steps, rounds, threads = map(int, numbers)
    ti = start(package, threads)
    block = Block(ti, cells)
    step = make_step(ti, block)
    seconds = []
    for k in range(rounds + 1):
        begin = time.perf_counter()
        for _ in range(2 if k == 0 else steps):  # the first round compiles
            step()
        ti.sync()
        seconds.append(time.perf_counter() - begin)
    final = block.x.to_numpy(), block.v.to_numpy()
    result = {
        "package": package,
        "version": ".".join(map(str, ti.__version__)),
        "particles": len(final[0]),
        "steps": steps,
        "seconds": seconds[1:],
        "sum": {"x": float(final[0].sum()), "v": float(final[1].sum())},
    }
    print(json.dumps(result))


if __name__ == "__main__":
    main()

"""The benchmark: rows in rounds that take turns, so that ratios come from the same conditions."""

from __future__ import annotations

import gc
import os
import platform
import tempfile
from collections.abc import Callable, Sequence
from itertools import product
from pathlib import Path
from typing import Any

from matpoint._version import __version__
from matpoint.bench.block import cells_for
from matpoint.bench.measure import STEPS, Row
from matpoint.bench.native import Native, NativeError
from matpoint.bench.options import BenchOptions
from matpoint.bench.results import compare_threads, row_result
from matpoint.bench.rivals import measure_rivals
from matpoint.bench.triad import BYTES, triad_gbs

Announce = Callable[[str], None]
REFERENCE = "linear"  # what costs are relative to
_ROW_BYTES = 2500  # a particle of the largest row, CPDI1 in 3-D, with what its setup needs
_SHARE = 0.4  # of the free memory that rows may hold at once


def run_bench(options: BenchOptions, announce: Announce = lambda text: None) -> dict[str, Any]:
    """Measure everything.

    Parameters
    ----------
    options
        What.
    announce
        Told in a line what comes next.

    Returns
    -------
    dict
        ``rows``, ``native``, ``triad_gbs``, ``taichi``, and what they were measured on; see
        ``matpoint.bench.table`` for the meaning of the columns. All times are per particle and step [ns].
    """
    announce(f"memory bandwidth on {', '.join(map(str, options.threads))} threads")
    triad = {count: triad_gbs(count, options.triad_elements) for count in options.threads}
    notes: list[str] = []
    rows: list[dict[str, Any]] = []
    native: dict[str, Any] | None = None
    with tempfile.TemporaryDirectory(prefix="matpoint-bench-") as folder:
        program = _build(Path(folder), notes, announce) if 3 in options.dims else None
        for dim in options.dims:
            for names in _batches(options, dim):
                own = program if dim == 3 and ("bspline2" in names or native is None) else None
                rows += _measure(options, dim, names, own, triad, notes, announce)
                if own is not None and own.rounds:
                    native = own.result()
    if 3 not in options.dims:
        notes.append("native: the program is three-dimensional; dims leaves that out")
    taichi = None
    if options.rivals and 3 in options.dims:
        announce("Taichi and Quadrants, if installed")
        cells = cells_for(options.particles, 3)
        taichi, more = measure_rivals(cells, STEPS, min(3, options.rounds), list(options.threads))
        notes += more
    compare_threads(rows)
    return {
        "rows": rows, "native": native, "triad_gbs": max(triad.values()), "taichi": taichi,
        "triad": {"gbs": {str(k): v for k, v in triad.items()}, "elements": options.triad_elements,
                  "bytes_per_element": BYTES},
        "particles": options.particles, "rounds": options.rounds, "steps_per_round": STEPS,
        "machine": _machine(), "notes": notes,
    }  # fmt: skip


def _build(folder: Path, notes: list[str], announce: Announce) -> Native | None:
    announce("building the native step")
    try:
        return Native(folder)
    except NativeError as error:
        notes.append(f"native: {error}")
        return None


def free_memory() -> int:
    """Return the bytes that are free, 4 GB where the system does not tell."""
    try:
        for line in Path("/proc/meminfo").read_text(encoding="ascii").splitlines():
            if line.startswith("MemAvailable:"):
                return int(line.split()[1]) * 1024
        return os.sysconf("SC_AVPHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    except (OSError, ValueError, AttributeError):
        return 4_000_000_000


def _batches(options: BenchOptions, dim: int) -> list[list[str]]:
    """Groups of methods that fit into memory together."""
    room = _SHARE * free_memory() / (_ROW_BYTES * options.particles * len(options.threads))
    width = max(1, int(room) - 1)  # the reference takes part in each batch
    names = list(options.methods)
    return [names[k : k + width] for k in range(0, len(names), width)]


def _measure(
    options: BenchOptions,
    dim: int,
    names: Sequence[str],
    program: Native | None,
    triad: dict[int, float],
    notes: list[str],
    announce: Announce,
) -> list[dict[str, Any]]:
    """Measure some methods side by side, with the reference among them."""
    guests = [REFERENCE] if REFERENCE in options.methods and REFERENCE not in names else []
    held: list[Row] = []
    for name, threads in product([*names, *guests], options.threads):
        announce(f"setting up {name}, {dim}-D, threads: {threads}")
        held.append(Row(name, dim, options.particles_of(name), threads))
    if program is not None:
        program.clear()
    for k in range(options.rounds):
        announce(f"{dim}-D: round {k + 1} of {options.rounds}")
        for row in held:
            row.measure()
        if program is not None:
            try:
                program.measure(cells_for(options.particles, 3), STEPS)
            except NativeError as error:
                notes.append(f"native: {error}")
                program = None
    for row in held:
        row.finish()
    gc.collect()
    found = {(row.name, row.threads): row for row in held}
    return [
        row_result(row, found.get((REFERENCE, row.threads)), program, triad[row.threads])
        for row in held
        if row.name in names
    ]


def _machine() -> dict[str, Any]:
    import llvmlite.binding as llvm  # noqa: PLC0415 (loaded already, by the kernels)

    return {
        "processor": llvm.get_host_cpu_name(), "system": platform.system(), "processors": os.cpu_count(),
        "matpoint": __version__, "python": platform.python_version(),
    }  # fmt: skip

"""What ``bench`` reads and writes."""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

from matpoint.bench import BenchOptions, run_bench, table
from matpoint.errors import InputError
from matpoint.output import prepare_folder
from matpoint.output.folder import claim
from matpoint.output.summary import plain, write_json

_FILES = ["bench.json", "bench-table.md", "scale.json", "scale-table.md", "scale.png"]
_QUICK: dict[str, Any] = {"particles": 20_000, "rounds": 4, "triad_elements": 8_000_000}


def number_of(what: str, text: str) -> int:
    """Return a whole number that may be written as 2e5.

    Raises
    ------
    InputError
        If it is none, or below 1.
    """
    try:
        value = float(text)
        whole = int(value)
    except (ValueError, OverflowError):
        value, whole = 0.5, 0
    if value != whole or whole < 1:
        raise InputError(f"{what} {text!r} must be a whole number >= 1")
    return whole


def numbers_of(what: str, text: str | None) -> tuple[int, ...]:
    """Return whole numbers separated by commas; none for None."""
    return () if text is None else tuple(number_of(what, part.strip()) for part in text.split(","))


def chosen(
    particles: str | None, methods: str | None, dims: str | None, threads: str | None, quick: bool
) -> BenchOptions:
    """Return the options of a command line.

    Raises
    ------
    InputError
        If one of them can't be.
    """
    given: dict[str, Any] = dict(_QUICK) if quick else {}
    if particles is not None:
        given["particles"] = number_of("--particles", particles)
    if methods is not None:
        given["methods"] = tuple(name.strip() for name in methods.split(","))
    if dims is not None:
        given["dims"] = numbers_of("--dims", dims)
    return BenchOptions(**given, threads=numbers_of("--threads", threads))


def bench(
    options: BenchOptions, counts: tuple[int, ...], methods_given: bool, folder: Path | None, force: bool
) -> tuple[dict[str, Any], str]:
    """Measure, write what there is into a folder, and return it, and as text.

    Parameters
    ----------
    options
        What to measure.
    counts
        Numbers of particles of a study of scale, which is then made in the place of the benchmark.
    methods_given
        Whether the user chose the methods; the study's own are linear and CPDI2.
    folder, force
        Where to write, if anywhere; as for ``prepare_folder``.
    """
    for count in counts:
        replace(options, particles=count)  # refused before a folder is made
    if folder is not None:
        prepare_folder(folder, force, _FILES)
    if counts:
        from matpoint.bench.scale import METHODS, draw_scale, run_scale, scale_table  # noqa: PLC0415

        methods = options.methods if methods_given else METHODS
        result = run_scale(counts, methods, options.threads, min(3, options.rounds), _announce)
        text, name = scale_table(result), "scale"
        if folder is not None and result["rows"]:
            draw_scale(result, claim(folder / "scale.png"))
    else:
        result = run_bench(options, _announce)
        text, name = table(result), "bench"
    if folder is not None:
        write_json(folder / f"{name}.json", result)
        claim(folder / f"{name}-table.md").write_text(f"```\n{text}\n```\n", encoding="utf-8")
    return plain(result), text


def _announce(text: str) -> None:
    print(text, file=sys.stderr, flush=True)

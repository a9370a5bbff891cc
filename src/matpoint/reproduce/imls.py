"""All figures of the IMLS paper, and what our runs say to its text."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from matpoint.output.figures import method_style, new_figure, save
from matpoint.problems import FullWave
from matpoint.problems.errors_track import FIELDS
from matpoint.reproduce.imls_reading import FIRST, reading, resolved
from matpoint.reproduce.polynomials import draw_polynomials
from matpoint.reproduce.tables import Announce, versions, write_all
from matpoint.study import Study, converge, fitted, neighbours, orders

if TYPE_CHECKING:
    from matpoint.interpolation import Interpolation

_METHODS = ("mpm", "cpdi1", "cpdi2", "mls", "imls", "spline-imls")
_SIZES = (8, 16, 32, 64, 128)
_STYLES: dict[str, dict[str, Any]] = {
    "imls-as-coded": {"color": "#4E9A06", "linestyle": "--", "marker": "v"},
    "imls-as-printed": {"color": "#4E9A06", "linestyle": ":", "marker": "^"},
    "mls-raw": {"color": "#C4A000", "linestyle": ":", "marker": "x"},
}


def variants() -> dict[str, Interpolation]:
    """Return IMLS as its authors coded it and as their paper prints it, and MLS as textbooks write it."""
    from matpoint.interpolation import IMLS, MLS  # noqa: PLC0415 (compiles)

    return {
        "imls-as-coded": IMLS(degree=1, points=1),
        "imls-as-printed": IMLS(reproject=True),
        "mls-raw": MLS(raw=True),
    }


def _study(sizes: Sequence[int], announce: Announce) -> Study:
    """All methods by the machinery of ``matpoint converge``, then the variants, one after the other."""
    from matpoint.study.worker import run_choice  # noqa: PLC0415

    study = converge(FullWave(), _METHODS, sizes, announce=announce)
    entries = dict(study.entries)
    for name, choice in variants().items():
        announce(f"{name} {', '.join(map(str, sizes))} cells")
        entries[name] = [run_choice(FullWave(cells=n), choice, name) for n in sizes]
    return dataclasses.replace(study, entries=entries)


def _draw(study: Study, field: str, title: str) -> Any:
    """Error against cell size at the end, as the paper draws it."""
    figure, axis = new_figure(6.4, 5.0)
    for name, entries in study.entries.items():
        good = [e for e in entries if e["failed"] is None]
        style = _STYLES.get(name) or method_style(name)
        axis.loglog([1.0 / e["cells"] for e in good], [e[field] for e in good], label=name, **style)
    h = [1.0 / entries["cells"] for entries in study.entries["imls"]]
    middle = study.entries["imls"][0][field]
    for order in (2, 3):
        axis.loglog(h, [0.5 * middle * (x / h[0]) ** order for x in h], color="#bbbbbb", linewidth=0.8)
        axis.annotate(f"h^{order}", (h[-1], 0.5 * middle * (h[-1] / h[0]) ** order), color="#777777")
    axis.set(xlabel="cell size [m]", ylabel=f"RMS error of {field} [{FIELDS[field]}]", title=title)
    axis.legend(frameon=False, fontsize="small")
    return figure


def _rows(entries: Mapping[str, Sequence[Mapping[str, Any]]], norm: str) -> Iterator[str]:
    for name, found in entries.items():
        pairs = zip(found, neighbours(found, norm), strict=True)
        cells = [
            "-" if e[norm] is None else f"{e[norm]:.3g}" + ("" if o is None else f" ({o:.2f})")
            for e, o in pairs
        ]
        slope = fitted(resolved(found), norm)
        yield f"| {name} | " + " | ".join(cells) + f" | {'-' if slope is None else f'{slope:.2f}'} |"


def _tables(study: Study) -> list[str]:
    """Errors with orders between neighbours, at the end and at a quarter, where fields are not zero."""
    lines: list[str] = []
    sizes = [e["cells"] for e in study.entries["imls"]]
    for part, when in (("", "at T"), ("_quarter", "at T/4")):
        for field, unit in FIELDS.items():
            lines += [f"## RMS error of {field} [{unit}] {when}, and orders", ""]
            lines += [f"| method | {' | '.join(map(str, sizes))} cells | fitted from {FIRST} |"]
            lines += ["|---" * (len(sizes) + 2) + "|", *_rows(study.entries, f"{field}{part}"), ""]
    lines += ["## Wall time of a run [s], one thread", ""]
    lines += [f"| method | {' | '.join(map(str, sizes))} cells |", "|---" * (len(sizes) + 1) + "|"]
    lines += [
        f"| {n} | {' | '.join(format(e['wall_s'], '.2f') for e in es)} |" for n, es in study.entries.items()
    ]
    failed = [(n, e) for n, es in study.entries.items() for e in es if e["failed"]]
    return [*lines, "", *(f"* {n} on {e['cells']} cells failed: {e['failed']}" for n, e in failed), ""]


def reproduce_imls(out: Path, announce: Announce, quick: bool = False) -> None:
    """Draw the polynomials and run the manufactured bar: figures 1 to 6 of the IMLS paper (T), and cost.

    Parameters
    ----------
    out
        A folder that exists.
    announce
        Told of every run.
    quick
        Cells to 32 instead of 128.
    """
    from matpoint.study.figures import write_study  # noqa: PLC0415 (loads matplotlib)

    sizes = _SIZES[:3] if quick else _SIZES
    sets = draw_polynomials(out)
    study = _study(sizes, announce)
    for number, field in enumerate(FIELDS, 4):
        title = f"Convergence of {field}, A = 0.1 m, t = 0.02 s"
        save(_draw(study, field, title), out / f"figure-{number}-{field}.png")
    write_study(study, out)
    lines = [
        "# The IMLS paper, recomputed", "",
        "Tran, Berzins, Solowski, 2019. Figures 1, 2, 3 show polynomials, 4, 5, 6 the manufactured bar;",
        "`figure-cost.png` draws error against cost, `figure-size.png` all times.", "",
        *_tables(study), *reading(study.entries),
    ]  # fmt: skip
    problem = study.problem
    settings = {
        "problem": problem.name, **dataclasses.asdict(problem), "end": problem.end,
        "cells": sizes, "fitted_from": FIRST, "methods": _METHODS,
        "steps": {n: dataclasses.replace(problem, cells=n).step for n in sizes},
        "variants": {name: repr(choice) for name, choice in variants().items()}, "versions": versions(),
    }  # fmt: skip
    slopes = orders({name: resolved(found) for name, found in study.entries.items()})
    write_all(out, settings, {**study.entries, "order": slopes, "polynomials": sets}, lines)

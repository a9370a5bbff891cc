"""Figures 3 to 8 of the CPDI2 paper: the bi-material bar and ring."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import TYPE_CHECKING, Any

from matpoint.output.folder import claim
from matpoint.problem import shown
from matpoint.problems import BimaterialBar, BimaterialRing
from matpoint.reproduce.tables import Announce, versions, write_all

if TYPE_CHECKING:
    from collections.abc import Mapping

    from matpoint.problem import Problem

_LAYERS = (2, 4, 8, 16)
_CONVERGING = ("cpdi1", "cpdi2", "enriched-cpdi2", "fem")


def _settings(problem: Problem) -> dict[str, Any]:
    return {
        "problem": problem.name, **dataclasses.asdict(problem),  # type: ignore[call-overload]
        "end": problem.end, "step": problem.step, "methods": list(problem.methods),
        "norms": problem.norms,
    }  # fmt: skip


def _run(problem: Problem, prefix: str, out: Path, announce: Announce) -> Mapping[str, Mapping[str, float]]:
    """Verify a problem; its files get a prefix, since all stand in one folder."""
    before = set(out.iterdir())
    result = problem.verify(
        out=out, progress=lambda name, number, count: announce(f"{prefix} {number + 1}/{count} {name}")
    )
    for path in set(out.iterdir()) - before:
        path.replace(claim(out / f"{prefix}-{path.name}"))
    return result


def _markdown(title: str, rows: Mapping[str, Mapping[str, float]]) -> list[str]:
    norms = list(next(iter(rows.values())))
    lines = [f"## {title}", "", "| method | " + " | ".join(norms) + " |", "|---" * (len(norms) + 1) + "|"]
    lines += [f"| {m} | " + " | ".join(shown(v[n]) for n in norms) + " |" for m, v in rows.items()]
    return [*lines, ""]


def _refine(
    ring: BimaterialRing, layers: tuple[int, ...], out: Path, announce: Announce
) -> tuple[dict[str, Any], list[str]]:
    """The ring at several resolutions: entries by method, and a table with orders between neighbours."""
    import numpy as np  # noqa: PLC0415

    from matpoint.output.figures import save  # noqa: PLC0415 (loads matplotlib)
    from matpoint.problems.ring_figures import draw_convergence  # noqa: PLC0415

    announce(f"ring, stiff {ring.stiff} part, {', '.join(map(str, layers))} layers")
    found = ring.convergence(_CONVERGING, layers, 2.0 * ring.dt)
    title = f"Ring, stiff {ring.stiff} part: errors over {', '.join(map(str, layers))} layers"
    save(draw_convergence(found, title), out / f"ring-{ring.stiff}-convergence.png")
    norms = list(ring.norms)
    lines = [
        f"## {title}, and orders between them",
        "",
        "| method | norm | errors | orders |",
        "|---|---|---|---|",
    ]
    for method, entries in found.items():
        for norm in norms:
            errors = np.array([entry[norm] for entry in entries])
            shown = ", ".join(f"{e:.3g}" for e in errors)
            if (errors > 0).all() and errors.max() > 1e-6:
                orders = np.log2(errors[:-1] / errors[1:]) / np.log2(
                    np.array(layers[1:]) / np.array(layers[:-1])
                )
                lines.append(f"| {method} | {norm} | {shown} | {', '.join(f'{o:.2f}' for o in orders)} |")
    return found, [*lines, ""]


def reproduce_cpdi2(out: Path, announce: Announce, quick: bool = False) -> None:
    """Run the bar and the ring in both orders: figures 3 to 8 of the CPDI2 paper (S), and tables.

    Parameters
    ----------
    out
        A folder that exists.
    announce
        Told of every run.
    quick
        Four times the paper's step for the ring, and three resolutions instead of four.
    """
    layers, dt = ((2, 4, 8), 4e-6) if quick else (_LAYERS, BimaterialRing.step)
    bars = {f"bar-{side}": BimaterialBar(side) for side in ("above", "below")}
    rings = {f"ring-{part}": BimaterialRing(part, dt=dt) for part in ("inner", "outer")}
    results: dict[str, Any] = {}
    lines = [
        "# The enriched CPDI2 paper, recomputed",
        "",
        "Sadeghirad, Brannon, Guilkey, 2013. Figures 3, 4, 5 show the bar, 6, 7, 8 the ring. File names say",
        "the order of the materials; `settings.json` holds every setting, `table.json` all numbers.",
        "",
    ]
    for prefix, problem in {**bars, **rings}.items():
        results[prefix] = _run(problem, prefix, out, announce)
        lines += _markdown(f"{problem.title}, stiff {prefix.split('-')[1]}", results[prefix])
    for prefix, ring in rings.items():
        results[f"{prefix}-convergence"], more = _refine(ring, layers, out, announce)
        lines += more
    for name, problem in (("bar", bars["bar-above"]), ("ring", rings["ring-inner"])):
        lines += [f"Norms of the {name}:", "", *(f"* `{k}`: {v}" for k, v in problem.norms.items()), ""]
    settings = {name: _settings(problem) for name, problem in {**bars, **rings}.items()}
    settings["convergence"] = {"layers": layers, "methods": _CONVERGING, "step": 2.0 * dt}
    settings["versions"] = versions()
    write_all(out, settings, results, lines)

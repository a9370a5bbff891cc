"""Figures and the table of inclusion problems: convergence, and stress on the domains."""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from matpoint.output.figures import method_style, new_figure, save, von_mises

if TYPE_CHECKING:
    from matpoint.problems.embedded import Embedded
    from matpoint.problems.fields import Field

_NORMS = {"inside": "inside, rms", "largest": "at the interface, largest", "outside": "outside, rms"}


def write_embedded(problem: Embedded, fields: Mapping[str, Sequence[Field]], out: Path) -> list[Path]:
    """Write ``convergence.csv``, ``stress.png`` and, with several levels, ``convergence.png``.

    Parameters
    ----------
    problem
        What was run.
    fields
        Method -> its fields, level by level.
    out
        A folder that exists.
    """
    errors = {name: [field.measure() for field in runs] for name, runs in fields.items()}
    paths = [_table(problem, fields, errors, out / "convergence.csv")]
    if len(problem.ladder) > 1:
        paths.append(save(_convergence(problem, errors), out / "convergence.png"))
    finest = {name: runs[-1] for name, runs in fields.items()}
    return [*paths, save(_stress(problem, finest), out / "stress.png")]


def _table(
    problem: Embedded,
    fields: Mapping[str, Sequence[Field]],
    errors: Mapping[str, Sequence[dict[str, float]]],
    path: Path,
) -> Path:
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(["method", "divisions", "domains", *_NORMS])
        for name, runs in errors.items():
            for divisions, field, found in zip(problem.ladder, fields[name], runs, strict=True):
                writer.writerow([name, divisions, len(field.body), *(found[norm] for norm in _NORMS)])
    return path


def _title(problem: Embedded) -> str:
    return f"{problem.title}, coated" if getattr(problem, "coated", False) else problem.title


def _convergence(problem: Embedded, errors: Mapping[str, Sequence[dict[str, float]]]) -> Any:
    figure, axes = new_figure(10.5, 4.2, 1, len(_NORMS))
    sizes = 0.25 * np.pi / np.array(problem.ladder)
    for axis, (norm, label) in zip(axes, _NORMS.items(), strict=True):
        for name, runs in errors.items():
            axis.loglog(sizes, [found[norm] for found in runs], label=name, **method_style(name))
        low = min(runs[-1][norm] for runs in errors.values())
        for order, line in ((1, ":"), (2, "--")):
            axis.loglog(
                sizes, 0.6 * low * (sizes / sizes[-1]) ** order,
                color="#999999", linestyle=line, linewidth=0.9, label=f"order {order}",
            )  # fmt: skip
        axis.set_xticks(sizes, [f"{size:.2g}" for size in sizes])
        axis.set_xticks([], minor=True)
        axis.set(title=label, xlabel="size of a domain at the interface [m]")
    axes[0].set_ylabel("relative error")
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=5, frameon=False)
    figure.suptitle(f"{_title(problem)}: errors of stress under refinement")
    return figure


def _stress(problem: Embedded, finest: Mapping[str, Field]) -> Any:
    """Von Mises stress on the domains, or on those that touch z = 0, beside the exact one."""
    from matplotlib.collections import PolyCollection  # noqa: PLC0415 (slow to import)
    from matplotlib.figure import Figure  # noqa: PLC0415

    some = next(iter(finest.values()))
    panels = {name: (field, field.stress) for name, field in finest.items()} | {"exact": (some, some.exact)}
    exact = von_mises(some.exact)
    figure = Figure(figsize=(3.1 * len(panels) + 0.9, 3.6), layout="constrained")
    axes = np.atleast_1d(figure.subplots(1, len(panels), sharey=True))
    for axis, (name, (field, stress)) in zip(axes, panels.items(), strict=True):
        rows, polygons = flat_polygons(field.corners)
        drawn = PolyCollection(polygons, array=von_mises(stress)[rows], edgecolor="face", linewidth=0.1)
        drawn.set_clim(0.0, 1.1 * exact.max())
        axis.add_collection(drawn)
        axis.autoscale()
        axis.set_aspect("equal")
        axis.set(title=name, xlabel="x [m]")
    axes[0].set_ylabel("y [m]")
    figure.colorbar(
        axes[-1].collections[0], ax=list(axes), label="von Mises stress [Pa]", shrink=0.85, extend="max"
    )
    figure.suptitle(_title(problem))
    return figure


def flat_polygons(corners: np.ndarray) -> tuple[np.ndarray, list[np.ndarray]]:
    """Return the domains to draw and their outlines in the x-y plane: in 3-D, their faces on z = 0.

    Parameters
    ----------
    corners
        Corners of the domains [m], shape (n, K, 3), in VTK's order.
    """
    down = np.abs(corners[:, :, 2]) < 1e-9
    if down.all():
        return np.arange(len(corners)), list(corners[:, :, :2])
    rows = np.flatnonzero(down.sum(axis=1) >= 3)
    outlines = []
    for row in rows:
        face = corners[row, down[row], :2]
        around = np.arctan2(*(face - face.mean(axis=0)).T[::-1])
        outlines.append(face[np.argsort(around)])
    return rows, outlines

"""Figures of the laminate: stress and strain through its thickness, and effective moduli."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from matpoint.output.figures import method_style, save
from matpoint.problems.laminate import COMPONENTS, COUNT, STRAIN

if TYPE_CHECKING:
    from matpoint.problems.laminate import Laminate, Strained

_TITLES = {"normal": "pulled across", "shear": "sheared along", "in_plane": "pulled along"}


def write_laminate(problem: Laminate, runs: Mapping[str, Mapping[str, Strained]], out: Path) -> list[Path]:
    """Write ``figure-profiles.png`` and ``figure-moduli.png``; return their paths.

    Parameters
    ----------
    problem
        The laminate that was run.
    runs
        Method -> load -> what it gave.
    out
        A folder that exists.
    """
    return [
        save(_profiles(problem, runs), out / "figure-profiles.png"),
        save(_moduli(problem, runs), out / "figure-moduli.png"),
    ]


def _panels(width: float, height: float, rows: int) -> tuple[Any, Any]:
    from matplotlib.figure import Figure  # noqa: PLC0415 (slow to import)

    figure = Figure(figsize=(width, height), layout="constrained")
    axes = figure.subplots(rows, len(COMPONENTS), squeeze=False)
    for axis in axes.ravel():
        axis.grid(True, color="#dddddd", linewidth=0.6)
        axis.spines[["top", "right"]].set_visible(False)
    return figure, axes


def _profiles(problem: Laminate, runs: Mapping[str, Mapping[str, Strained]]) -> Any:
    """Means over the width at each height, against the exact values."""
    figure, axes = _panels(10.0, 7.2, 2)
    edges = np.linspace(0.0, 1.0, COUNT + 1)
    for column, load in enumerate(COMPONENTS):
        strains = problem.layers.strains(load, STRAIN)
        exact = (problem.layers.modulus(load) * STRAIN * np.ones(COUNT), strains)
        if load == "in_plane":
            exact = (np.array(problem.layers.young) / (1 - problem.layers.poisson**2) * STRAIN, strains)
        upper, lower = axes[:, column]
        for axis, values in ((upper, exact[0]), (lower, exact[1] / STRAIN)):
            axis.stairs(
                values,
                edges,
                orientation="horizontal",
                baseline=None,
                color="#bbbbbb",
                linewidth=4.0,
                label="exact",
            )
            axis.set_ylim(0.0, 1.0)
        for name, loads in runs.items():
            run, style = loads[load], method_style(name) | {"label": name, "linewidth": 1.2, "markersize": 5}
            heights, row = np.unique(np.round(run.height, 6), return_inverse=True)
            count = np.bincount(row)
            upper.plot(np.bincount(row, run.stress) / count, heights, **style)
            lower.plot(np.bincount(row, run.strain) / count / STRAIN, heights, **style)
        upper.set(title=_TITLES[load], xlabel="stress [Pa]")
        lower.set(xlabel="strain over mean strain")
        low, high = lower.get_xlim()
        if high - low < 1e-3:  # uniform: round-off must not fill the panel
            lower.set_xlim(0.9, 1.1)
    for axis in axes[:, 0]:
        axis.set_ylabel("height over thickness")
    figure.suptitle(f"Ten layers in one cell, stiffness 1:{problem.contrast:g}", fontsize=12)
    handles = axes[0, 0].get_legend_handles_labels()
    figure.legend(*handles, loc="outside lower center", ncols=5, frameon=False)
    return figure


def _moduli(problem: Laminate, runs: Mapping[str, Mapping[str, Strained]]) -> Any:
    """Effective moduli over the exact ones."""
    figure, axes = _panels(9.0, 3.4, 1)
    for axis, load in zip(axes[0], COMPONENTS, strict=True):
        exact = problem.layers.modulus(load)
        values = [loads[load].modulus / exact for loads in runs.values()]
        bars = axis.bar(list(runs), values, color=[method_style(name)["color"] for name in runs], width=0.6)
        axis.set_axisbelow(True)
        axis.bar_label(bars, fmt="%.3f", padding=2, fontsize=9)
        axis.axhline(1.0, color="#777777", linewidth=1.0, linestyle=":")
        axis.set(title=f"{_TITLES[load]}: {exact:.4g} Pa", ylim=(0.0, 1.15 * max(*values, 1.0)))
        axis.tick_params(axis="x", labelsize=8)
    axes[0, 0].set_ylabel("effective over exact modulus")
    return figure

"""Figures of a study: error against cell size, and against cost."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from matpoint.output.figures import method_style, new_figure, save
from matpoint.problems.errors_track import FIELDS
from matpoint.study.converge import Study

_PARTS = {"": "at the end", "_quarter": "at a quarter", "_max": "largest"}
_COSTS = {"particle_steps": "particle-steps", "wall_s": "wall time [s]"}


def write_study(study: Study, out: Path) -> list[Path]:
    """Write ``figure-size.png`` and ``figure-cost.png``; return their paths.

    Parameters
    ----------
    study
        What was found.
    out
        A folder that exists.
    """
    return [save(_sizes(study), out / "figure-size.png"), save(_costs(study), out / "figure-cost.png")]


def _curve(axis: Any, study: Study, norm: str, abscissa: str) -> None:
    for name, entries in study.entries.items():
        good = [e for e in entries if e["failed"] is None and e[norm] and e[abscissa]]
        x = [1.0 / e["cells"] if abscissa == "cells" else e[abscissa] for e in good]
        axis.loglog(x, [e[norm] for e in good], label=name, **method_style(name))


def _sizes(study: Study) -> Any:
    """A row for each time, a column for each field."""
    figure, axes = new_figure(11.5, 9.0, 3, 3, share_y=False)
    for row, (part, when) in zip(axes, _PARTS.items(), strict=True):
        for axis, (field, unit) in zip(row, FIELDS.items(), strict=True):
            _curve(axis, study, f"{field}{part}", "cells")
            axis.set(title=f"{field} [{unit}], {when}")
    for axis in axes[-1]:
        axis.set(xlabel="1 / cells")
        axis.tick_params(labelbottom=True)
    return _finish(figure, axes, f"{study.problem.title}: RMS error against cell size")


def _costs(study: Study) -> Any:
    """A row for each cost, a column for each field; errors at a quarter, where fields are not near zero."""
    from matplotlib.figure import Figure  # noqa: PLC0415 (slow to import)

    figure = Figure(figsize=(11.5, 6.6), layout="constrained")
    axes = figure.subplots(2, 3)
    for row, (cost, label) in zip(axes, _COSTS.items(), strict=True):
        for axis, (field, unit) in zip(row, FIELDS.items(), strict=True):
            _curve(axis, study, f"{field}_quarter", cost)
            axis.set(title=f"{field} [{unit}]", xlabel=label)
            axis.grid(True, color="#dddddd", linewidth=0.6)
            axis.spines[["top", "right"]].set_visible(False)
    return _finish(figure, axes, f"{study.problem.title}: RMS error at a quarter against cost")


def _finish(figure: Any, axes: Any, title: str) -> Any:
    figure.suptitle(title)
    handles = axes.ravel()[0].get_legend_handles_labels()
    figure.legend(*handles, loc="outside lower center", ncols=5, frameon=False)
    return figure

"""A picture of histories over time: one panel for each column, with units, and round-off kept flat."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from matpoint.output.figures import new_figure, save
from matpoint.output.triggers import AtTimes, Trigger

if TYPE_CHECKING:
    from matpoint.output.history import Recorder
    from matpoint.simulation import Simulation

_SHARE = 1e-9  # of the largest value of the same unit: what is drawn as flat
_DIGITS = 1e-6  # of a column's own size: what is drawn as flat, since labels of ticks stand in full
_NATURAL = 1e-12  # of the run's own scale: what is drawn as flat if nothing else is there to compare


def natural_scales(sim: Simulation) -> dict[str, float]:
    """Return, by unit, what would be large in this run: bodies at the speed of sound, across the grid."""
    mass = float(sim.particles.mass.sum())
    size = max(b - a for a, b in zip(sim.grid.lower, sim.grid.upper, strict=True))
    speed = max(float(m.wave_speed(np.eye(3)[None])[0]) for m in sim.materials)
    pressure = max(m.density for m in sim.materials) * speed**2
    momentum = mass * speed
    return {
        "m": size, "m/s": speed, "Pa": pressure, "kg m/s": momentum, "N s": momentum,
        "kg m^2/s": momentum * size,
    }  # fmt: skip


def spans(history: Recorder, scales: dict[str, float]) -> dict[str, tuple[float, float] | None]:
    """Return for each column the limits of its axis, or None where matplotlib's own will do.

    A span below round-off, against the columns of the same unit or the run's scale, is widened to it; so
    is one below a millionth of the column's own values.
    """
    columns = history.columns[2:]
    largest: dict[str, float] = {}
    for column in columns:
        values = np.abs(history.array(column))
        unit, top = history.units[column], float(values[np.isfinite(values)].max(initial=0.0))
        largest[unit] = max(largest.get(unit, 0.0), top)
    limits: dict[str, tuple[float, float] | None] = {}
    for column in columns:
        unit, values = history.units[column], history.array(column)
        values = values[np.isfinite(values)]
        floor = max(_SHARE * largest[unit], _NATURAL * scales.get(unit, 0.0))
        floor = max(floor, _DIGITS * float(np.abs(values).max(initial=0.0)))
        low, high = (float(values.min()), float(values.max())) if len(values) else (0.0, 0.0)
        middle = 0.5 * (low + high)
        limits[column] = (middle - floor, middle + floor) if high - low < floor else None
    return limits


class HistoryFigure:
    """A picture of columns of a history over time, drawn at the end.

    Parameters
    ----------
    path
        The file.
    history
        A :class:`~matpoint.output.history.Recorder` of the same run.
    """

    trigger: Trigger = AtTimes((0.0,))

    def __init__(self, path: Path, history: Recorder) -> None:
        self.path, self.history, self.files = path, history, (path.name,)

    def open(self, sim: Simulation) -> None:
        """Nothing is needed before the end."""

    def write(self, sim: Simulation) -> None:
        """Nothing is drawn before the end."""

    def close(self, sim: Simulation, error: BaseException | None) -> None:
        """Draw one panel for each column."""
        columns = self.history.columns[2:]
        if error is not None or not columns or not self.history.rows:
            return
        figure, axes = new_figure(7.0, 1.2 + 1.8 * len(columns), len(columns), share_y=False)
        limits = spans(self.history, natural_scales(sim))
        for axis, column in zip(np.atleast_1d(axes), columns, strict=True):
            axis.plot(self.history.array("time"), self.history.array(column), color="#0F4C81")
            axis.set_ylabel(f"{column}\n[{self.history.units[column]}]")
            if (limit := limits[column]) is not None and limit[0] < limit[1]:
                axis.set_ylim(*limit)
            axis.ticklabel_format(axis="y", useOffset=False)
        np.atleast_1d(axes)[-1].set_xlabel("time [s]")
        figure.align_ylabels()
        save(figure, self.path)

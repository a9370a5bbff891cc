"""Samples of a run for a problem's norms."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from matpoint.simulation import Simulation


class Sampler:
    """A writer that keeps what a function makes of the state.

    Parameters
    ----------
    every
        Steps between two samples.
    function
        Takes the simulation, returns an array (or a number) of one shape.
    """

    def __init__(self, every: int, function: Callable[[Simulation], np.ndarray | float]) -> None:
        from matpoint.output.triggers import EverySteps  # noqa: PLC0415 (keeps the import of a case light)

        self.trigger, self._function = EverySteps(every), function
        self._times: list[float] = []
        self._values: list[np.ndarray | float] = []

    def open(self, sim: Simulation) -> None:
        """Nothing is needed before the first sample."""

    def write(self, sim: Simulation) -> None:
        """Take a sample."""
        self._times.append(sim.time)
        self._values.append(self._function(sim))

    def close(self, sim: Simulation, error: BaseException | None) -> None:
        """Nothing is left to do."""

    @property
    def times(self) -> np.ndarray:
        """Times of the samples [s], shape (t,)."""
        return np.array(self._times)

    @property
    def values(self) -> np.ndarray:
        """The samples, shape (t, ...)."""
        return np.array(self._values)


def relative(values: np.ndarray, reference: np.ndarray) -> float:
    """Return the L2 norm of a difference over that of the reference."""
    return float(np.linalg.norm(values - reference) / np.linalg.norm(reference))


def fitted_order(sizes: np.ndarray, errors: np.ndarray) -> float:
    """Return the slope of log(error) over log(size), by least squares."""
    return float(np.polyfit(np.log(sizes), np.log(errors), 1)[0])

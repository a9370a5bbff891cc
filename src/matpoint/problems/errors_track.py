"""Errors of a run over time, and the norms taken from them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

#: Fields whose errors are measured, and their units.
FIELDS = {"displacement": "m", "velocity": "m/s", "stress": "Pa"}
#: Names of all norms, in order.
NORMS = tuple(f"{field}{part}" for part in ("", "_quarter", "_max") for field in FIELDS)
_SAMPLES = 20  # at least so many in each quarter, if it has as many steps


def sampling(end: float, step: float) -> int:
    """Return the steps between two samples, so that both a quarter of the end and the end are met.

    Parameters
    ----------
    end, step
        [s]; a quarter of the end is a whole number of steps.
    """
    quarter = round(0.25 * end / step)
    return max(n for n in range(1, max(1, quarter // _SAMPLES) + 1) if quarter % n == 0)


@dataclass(frozen=True, eq=False)
class ErrorTrack:
    """RMS errors over all particles at times of a run.

    Attributes
    ----------
    times : ndarray, shape (k,) [s]
    values : ndarray, shape (k, 3)
        Of displacement [m], velocity [m/s] and stress [Pa].
    end
        When the run should end [s].
    failed
        What ended it before, or None.
    particle_steps
        Particles times steps made.
    wall
        Seconds of the run.
    """

    times: np.ndarray
    values: np.ndarray
    end: float
    failed: str | None
    particle_steps: int
    wall: float

    def at(self, time: float) -> np.ndarray:
        """Return the errors at a time [s], (3,); NaN if it was not reached."""
        found = np.flatnonzero(np.abs(self.times - time) < 1e-6 * self.end)
        return self.values[found[0]] if len(found) else np.full(3, np.nan)

    def norms(self) -> dict[str, float]:
        """Return the errors at the end, at a quarter of it, and the largest; NaN where there are none.

        The largest of a run that failed is that of its samples before it did.
        """
        largest = self.values.max(axis=0) if len(self.values) else np.full(3, np.nan)
        numbers = np.concatenate([self.at(self.end), self.at(0.25 * self.end), largest])
        return dict(zip(NORMS, numbers.tolist(), strict=True))

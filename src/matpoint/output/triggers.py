"""When a writer is due."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

from matpoint.errors import InputError

_HAIR = 1e-9  # of the time reached: what rounding may move an event by


class Trigger(Protocol):
    """Decides after each step whether something happens."""

    def due(self, step: int, time: float, previous: float) -> bool:
        """Return whether an event lies after ``previous`` and not after ``time`` [s].

        Before the first step ``step`` is 0 and ``previous`` is -inf.
        """
        ...


@dataclass(frozen=True)
class EverySteps:
    """Every n steps, step 0 included.

    Parameters
    ----------
    n
        A whole number >= 1.
    """

    n: int

    def __post_init__(self) -> None:
        if isinstance(self.n, bool) or not isinstance(self.n, int) or self.n < 1:
            raise InputError(f"output: every_steps = {self.n!r} must be a whole number >= 1")

    def due(self, step: int, time: float, previous: float) -> bool:
        """Return whether the step is a multiple of n."""
        return step % self.n == 0


@dataclass(frozen=True)
class EveryTime:
    """At the first step that reaches a multiple of an interval, time 0 included.

    Parameters
    ----------
    interval
        [s]
    """

    interval: float

    def __post_init__(self) -> None:
        if not (
            isinstance(self.interval, int | float) and math.isfinite(self.interval) and self.interval > 0
        ):
            raise InputError(f"output: every_time = {self.interval!r} must be a positive number of seconds")

    def due(self, step: int, time: float, previous: float) -> bool:
        """Return whether a multiple of the interval was reached by this step."""
        return self._count(time) > (self._count(previous) if math.isfinite(previous) else -1)

    def _count(self, time: float) -> int:
        return math.floor(time / self.interval * (1.0 + _HAIR) + _HAIR)


@dataclass(frozen=True)
class AtTimes:
    """At the first step that reaches each of some times.

    Parameters
    ----------
    times
        [s], not negative.
    """

    times: tuple[float, ...]

    def __init__(self, times: Sequence[float]) -> None:
        values = tuple(float(t) for t in times)
        if not values or not all(math.isfinite(t) and t >= 0 for t in values):
            raise InputError(f"output: at = {list(times)!r} must be one or more times >= 0")
        object.__setattr__(self, "times", values)

    def due(self, step: int, time: float, previous: float) -> bool:
        """Return whether one of the times was reached by this step."""
        return any(previous < t - _HAIR * max(t, 1e-300) <= time for t in self.times)

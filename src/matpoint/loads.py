"""Gravity, body forces and damping."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from matpoint.checks import function, not_negative, number, numbers
from matpoint.errors import InputError, NotFiniteError
from matpoint.particles import Particles

History = Callable[[float], float]
Field = Callable[[np.ndarray, np.ndarray, float], np.ndarray]


@dataclass(frozen=True)
class Gravity:
    """A uniform acceleration.

    Parameters
    ----------
    acceleration
        One number per axis [m/s^2].
    ramp
        Time [s] over which it grows linearly from zero; 0 switches it on at t = 0.
    history
        A function of time [s] that multiplies it.
    """

    acceleration: tuple[float, ...]
    ramp: float = 0.0
    history: History | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "acceleration", numbers("gravity: acceleration", self.acceleration))
        not_negative("gravity: ramp", self.ramp)
        if self.history is not None:
            function("gravity: history", self.history)

    def at(self, time: float) -> np.ndarray:
        """Return the acceleration [m/s^2] at a time [s], shape (3,)."""
        factor = 1.0 if self.ramp == 0.0 else min(time / self.ramp, 1.0)
        if self.history is not None:
            factor *= float(self.history(time))
        vector = np.zeros(3)
        vector[: len(self.acceleration)] = self.acceleration
        return factor * vector


@dataclass(frozen=True)
class BodyForce:
    """A force per mass b(X, x, t).

    Parameters
    ----------
    function
        ``function(X, x, t)`` with initial and current positions [m] of shape (n, 3) and the time
        [s] returns [m/s^2] of shape (n, 3); it is called once a step. A function compiled with
        ``numba.njit`` is called per particle with two tuples of three floats, and returns three.
    """

    function: Field

    def __post_init__(self) -> None:
        function("body force: function", self.function)


Load = Gravity | BodyForce


def _is_compiled(function: Any) -> bool:
    return hasattr(function, "py_func")


def _checked(values: np.ndarray, what: str, time: float) -> np.ndarray:
    """Return accelerations [m/s^2] that are numbers; name the load and the first particle if not."""
    bad = np.flatnonzero(~np.isfinite(values).all(axis=1))
    if len(bad):
        particle = int(bad[0]) if len(values) > 1 else None
        raise NotFiniteError(f"{what}: not a finite number at t = {time:g} s", particle)
    return values


class Loads:
    """The sum of all loads as the transfers take it."""

    def __init__(self, loads: Sequence[Load], dim: int) -> None:
        for load in loads:
            if isinstance(load, Gravity) and len(load.acceleration) > dim:
                raise InputError(f"gravity: {len(load.acceleration)} components for {dim} axes")
        self._uniform = [(k, load) for k, load in enumerate(loads) if isinstance(load, Gravity)]
        self._fields = [(k, load.function) for k, load in enumerate(loads) if isinstance(load, BodyForce)]

    def evaluate(self, particles: Particles, time: float) -> np.ndarray:
        """Return the body force per mass [m/s^2], shape (1, 3) if uniform, else (n, 3)."""
        total = np.zeros((1, 3))
        with np.errstate(all="ignore"):  # what is not finite is refused by name
            for k, gravity in self._uniform:
                total += _checked(gravity.at(time)[None], f"load {k} (gravity)", time)
            for k, field in self._fields:
                part = self._field(field, particles, time)
                total = total + _checked(part, f"load {k} (body force)", time)
        return np.ascontiguousarray(total)

    @staticmethod
    def _field(field: Any, particles: Particles, time: float) -> np.ndarray:
        if _is_compiled(field):
            from matpoint.kernels.fields import per_particle  # noqa: PLC0415 (compiles)

            values = np.empty_like(particles.position)
            per_particle(field, particles.position0, particles.position, time, values)
            return values
        values = np.asarray(field(particles.position0, particles.position, time), dtype=float)
        if values.shape != particles.position.shape:
            raise InputError(
                f"body force: it returned shape {values.shape}; {particles.position.shape} is needed"
            )
        return values


@dataclass(frozen=True)
class NoDamping:
    """No damping."""

    rate: float = 0.0
    factor: float = 0.0


@dataclass(frozen=True)
class MassDamping:
    """A force -rate * m * v at the nodes.

    Parameters
    ----------
    rate
        [1/s]; twice the damping ratio times the circular frequency of the mode to be damped.
    """

    rate: float

    def __post_init__(self) -> None:
        not_negative("mass damping: rate", self.rate)

    @property
    def factor(self) -> float:
        """The share of local damping."""
        return 0.0


@dataclass(frozen=True)
class LocalDamping:
    """Cundall's damping for quasi-static runs: a share of the unbalanced force against the velocity.

    Parameters
    ----------
    factor
        Share, 0 <= factor < 1; 0.7 or 0.8 is usual.
    """

    factor: float

    def __post_init__(self) -> None:
        if not 0 <= number("local damping: factor", self.factor) < 1:
            raise InputError(f"local damping: factor = {self.factor!r} must be from 0 to below 1")

    @property
    def rate(self) -> float:
        """The rate of mass-proportional damping [1/s]."""
        return 0.0


Damping = NoDamping | MassDamping | LocalDamping

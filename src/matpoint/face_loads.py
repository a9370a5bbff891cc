"""Loads on the faces of particle domains: pressure and traction, which move with the material."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from matpoint.checks import not_negative, number, numbers
from matpoint.errors import InputError, NotFiniteError
from matpoint.kernels.faces import face_forces
from matpoint.places import Surface

if TYPE_CHECKING:
    from matpoint.interpolation.contract import Setting
    from matpoint.vertices import Vertices

History = Callable[[float], float]


def _factor(ramp: float, history: History | None, time: float) -> float:
    factor = 1.0 if ramp == 0.0 else min(time / ramp, 1.0)
    return factor if history is None else factor * float(history(time))


@dataclass(frozen=True)
class Pressure:
    """A follower pressure: it stays normal to the deformed faces.

    Parameters
    ----------
    where
        The boundary set.
    value
        [Pa]; positive pushes into the body.
    ramp
        Time [s] over which it grows linearly from zero; 0 switches it on at t = 0.
    history
        A function of time [s] that multiplies it.
    """

    where: Surface
    value: float
    ramp: float = 0.0
    history: History | None = None

    def __post_init__(self) -> None:
        if not isinstance(self.where, Surface):
            raise InputError(f"pressure: where = {self.where!r} must be a Surface")
        number("pressure: value", self.value)
        not_negative("pressure: ramp", self.ramp)

    def parts(self, time: float) -> tuple[float, tuple[float, ...], bool]:
        """Return pressure [Pa], traction [Pa], and whether areas are the initial ones."""
        return self.value * _factor(self.ramp, self.history, time), (0.0, 0.0, 0.0), False


@dataclass(frozen=True)
class Traction:
    """A force per area with a direction that does not turn.

    Parameters
    ----------
    where
        The boundary set.
    value
        One number per axis [Pa].
    ramp, history
        As for :class:`Pressure`.
    per
        ``"initial"``: per initial area, so that the total force is given (a dead load); ``"current"``:
        per deformed area (a Cauchy traction).
    """

    where: Surface
    value: tuple[float, ...]
    ramp: float = 0.0
    history: History | None = None
    per: str = "initial"

    def __post_init__(self) -> None:
        if not isinstance(self.where, Surface):
            raise InputError(f"traction: where = {self.where!r} must be a Surface")
        numbers("traction: value", self.value)
        if self.per not in ("initial", "current"):
            raise InputError(f'traction: per = {self.per!r}; "initial" and "current" are allowed')
        not_negative("traction: ramp", self.ramp)

    def parts(self, time: float) -> tuple[float, tuple[float, ...], bool]:
        """Return pressure [Pa], traction [Pa], and whether areas are the initial ones."""
        factor = _factor(self.ramp, self.history, time)
        given = [factor * v for v in self.value]
        return 0.0, (*given, *(0.0,) * (3 - len(given))), self.per == "initial"


FaceLoad = Pressure | Traction


class FaceLoads:
    """All loads on faces, as forces on vertices."""

    def __init__(self, loads: Sequence[FaceLoad], setting: Setting) -> None:
        self._loads: list[tuple[FaceLoad, np.ndarray, np.ndarray, np.ndarray]] = []
        for load in loads:
            if isinstance(load, Traction) and len(load.value) > setting.grid.dim:
                raise InputError(f"traction: {len(load.value)} components for {setting.grid.dim} axes")
            corners, sign, outer = setting.faces_of(load.where)
            if not outer.all():
                raise InputError(
                    f"{type(load).__name__.lower()}: surface {load.where} lies between two bodies in part;"
                    " leave the body's name out to take its outside only"
                )
            self._loads.append((load, corners, sign, np.zeros((*corners.shape, 3))))

    def evaluate(self, vertices: Vertices, time: float) -> list[tuple[np.ndarray, np.ndarray]]:
        """Return vertices (m,) and the forces [N] (m, 3) on them, a pair for each load."""
        pushes = []
        for load, corners, sign, force in self._loads:
            pressure, traction, initial = load.parts(time)
            if not math.isfinite(pressure + sum(traction)):
                raise NotFiniteError(
                    f"{type(load).__name__.lower()}: its history is not a finite number at t = {time:g} s"
                )
            x = vertices.position0 if initial else vertices.position
            face_forces(corners, sign, x, pressure, *traction, force)
            pushes.append((corners.ravel(), force.reshape(-1, 3)))
        return pushes


def book_pushes(
    pushes: Sequence[tuple[np.ndarray, np.ndarray]],
    before: np.ndarray,
    after: np.ndarray,
    dt: float,
    external: np.ndarray,
) -> None:
    """Add impulse (3) [N s], work (1) [J] and impulse of moments (3) [N m s] of forces on vertices.

    ``before`` and ``after`` are the vertices' positions [m] at both ends of the step.
    """
    for vertices, force in pushes:
        start = before[vertices]
        external[:3] += dt * force.sum(axis=0)
        external[3] += float((force * (after[vertices] - start)).sum())
        external[4:] += dt * np.cross(start, force).sum(axis=0)

"""Loads and conditions evaluated once at the start, so that what can't be evaluated is refused in time."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from matpoint.boundary import PrescribedVelocity
from matpoint.errors import InputError
from matpoint.face_loads import FaceLoad
from matpoint.loads import BodyForce, Gravity, Loads

if TYPE_CHECKING:
    from matpoint.simulation import Simulation


def check_start(sim: Simulation) -> None:
    """Evaluate every load and prescribed velocity at the present time.

    Raises
    ------
    InputError
        If one fails or is not finite, with its number.
    """
    for number, load in enumerate(sim.loads):
        where = f"loads.{number}{'' if getattr(load, 'history', None) is None else '.history'}"
        _evaluate(where, lambda load=load: _load(sim, load))
    try:
        _evaluate("boundaries", lambda: sim.engine.constraints.velocities(sim.time))
    except InputError as error:
        moving = [k for k, c in enumerate(sim.boundaries) if isinstance(c, PrescribedVelocity)]
        bad = [k for k in moving if not _works(sim, k)] or moving
        where = ", ".join(f"boundaries.{k}.velocity" for k in bad)
        raise InputError(f"{where}: {str(error).removeprefix('boundaries: ')}") from None


def _load(sim: Simulation, load: Gravity | BodyForce | FaceLoad) -> None:
    if isinstance(load, FaceLoad):
        pressure, traction, _ = load.parts(sim.time)
        if not np.isfinite([pressure, *traction]).all():
            raise InputError(f"{type(load).__name__.lower()}: not a finite number at t = {sim.time:g} s")
        return
    Loads([load], sim.dim).evaluate(sim.particles, sim.time)


def _works(sim: Simulation, number: int) -> bool:
    """Whether the functions of a condition give finite values at the particles: only to name the culprit."""
    condition = sim.boundaries[number]
    assert isinstance(condition, PrescribedVelocity)
    with np.errstate(all="ignore"):
        try:
            functions = [v for v in condition.velocity if callable(v)]
            given = [np.asarray(v(sim.particles.position0, sim.time), dtype=float) for v in functions]
        except (ArithmeticError, ValueError, TypeError):
            return False
    return all(np.isfinite(values).all() for values in given)


def _evaluate(where: str, function: Callable[[], Any]) -> None:
    try:
        with np.errstate(all="ignore"):
            function()
    except InputError as error:
        raise InputError(f"{where}: {str(error).removeprefix('loads: ')}") from None
    except (ArithmeticError, ValueError, TypeError) as error:
        raise InputError(f"{where}: it fails at the start: {type(error).__name__}: {error}") from None

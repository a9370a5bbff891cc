"""Dynamic relaxation: a boundary moves slowly to its place, and damping brings the body to rest."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from matpoint.simulation import Simulation

Displacement = Callable[[np.ndarray], np.ndarray]


@dataclass(eq=False)
class Ramp:
    """A displacement u(X) that grows smoothly over a time: u(X) s(t), s = t/T - sin(2 pi t/T)/(2 pi).

    Velocity and acceleration vanish at both ends, so the waves that it sends out are small.

    Parameters
    ----------
    displacement
        Takes initial positions (m, 3) [m] and returns displacements (m, dim or more) [m].
    rise
        The time T [s].
    """

    displacement: Displacement
    rise: float
    _seen: tuple[np.ndarray, np.ndarray] | None = field(default=None, init=False, repr=False)

    def _values(self, x: np.ndarray) -> np.ndarray:
        """The displacements, evaluated once for the same array of positions."""
        if self._seen is None or self._seen[0] is not x:
            self._seen = x, np.asarray(self.displacement(x), dtype=float)
        return self._seen[1]

    def rate(self, time: float) -> float:
        """Return s' [1/s] at a time [s]."""
        if not 0.0 < time < self.rise:
            return 0.0
        return (1.0 - math.cos(2.0 * math.pi * time / self.rise)) / self.rise

    def velocities(self, dim: int) -> tuple[Callable[[np.ndarray, float], np.ndarray], ...]:
        """Return the velocity of each axis, as :class:`matpoint.PrescribedVelocity` takes them."""
        return tuple(lambda x, time, k=k: self._values(x)[:, k] * self.rate(time) for k in range(dim))


@dataclass(frozen=True)
class Rest:
    """How a run came to rest.

    Attributes
    ----------
    time
        [s]
    steps
        Made so far.
    share
        Kinetic over stored energy at the end.
    """

    time: float
    steps: int
    share: float


def settle(sim: Simulation, rise: float, pause: float, longest: float, share: float = 1e-9) -> Rest:
    """Run through a ramp, and on until the kinetic energy is a small share of the stored one.

    FLIP alone leaves what particles do below the grid undamped; a hundredth of PIC takes it away.

    Parameters
    ----------
    sim
        A damped simulation whose boundaries follow a :class:`Ramp`.
    rise
        The ramp's time [s].
    pause
        Time between two looks [s].
    longest
        The run ends here [s], at rest or not.
    share
        Kinetic over stored energy that counts as rest, at two looks on end: one alone may find the
        body at a turning point.
    """
    sim.run(rise)
    calm, now = 0, math.inf
    while calm < 2 and sim.time < longest * (1.0 - 1e-9):
        sim.run(min(sim.time + pause, longest))
        stored = sim.quantity("strain_energy")
        now = sim.quantity("kinetic_energy") / stored if stored > 0.0 else 0.0
        calm = calm + 1 if now < share else 0
    return Rest(sim.time, sim.step, now)

"""The ledger: mass, momentum and energy against what came in from outside."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from matpoint.kernels.ledger import sum_moments, sum_motion
from matpoint.materials import Material
from matpoint.particles import Particles, Rows

if TYPE_CHECKING:
    from matpoint.engine import Engine

_LARGEST = 1e150  # beyond it squares overflow


@dataclass(frozen=True)
class LedgerEntry:
    """The balance at one time.

    Attributes
    ----------
    step, time
        Step number and time [s].
    mass
        [kg]
    momentum, angular_momentum
        Linear [kg m/s] and about the origin [kg m^2/s], shape (3,).
    impulse, angular_impulse
        Impulse of loads and conditions [N s] and of their moments [N m s] since the start.
    kinetic, strain
        Kinetic and stored energy [J]; ``strain`` is NaN if a material has no energy function.
    external_work
        Work of loads and conditions since the start [J].
    """

    step: int
    time: float
    mass: float
    momentum: np.ndarray
    angular_momentum: np.ndarray
    impulse: np.ndarray
    angular_impulse: np.ndarray
    kinetic: float
    strain: float
    external_work: float

    @property
    def computable(self) -> bool:
        """Whether all are numbers whose squares are numbers too; the stored energy alone may be unknown."""
        known = [self.mass, self.kinetic, 0.0 if math.isnan(self.strain) else self.strain]
        return bool((np.abs(np.concatenate([self.momentum, self.angular_momentum, known])) < _LARGEST).all())

    @property
    def total(self) -> float:
        """Kinetic plus stored energy less external work [J]: constant for an exact run."""
        return self.kinetic + self.strain - self.external_work


def take_entry(engine: Engine) -> LedgerEntry:
    """Return the balance of an engine's particles now."""
    p, team = engine.particles, engine.team
    sums = team.sums(
        len(p), 8, lambda a, b, block, out: sum_motion(a, b, block, p.mass, p.position, p.velocity, out)
    )
    angular = sums[4:7]
    moment = getattr(p, "affine_moment", None)
    if moment is not None:  # APIC carries angular momentum in B as well
        angular = angular + team.sums(
            len(p), 3, lambda a, b, block, out: sum_moments(a, b, block, p.mass, moment, out)
        )
    return LedgerEntry(
        step=engine.step,
        time=engine.time,
        mass=float(sums[0]),
        momentum=sums[1:4],
        angular_momentum=angular,
        impulse=engine.external[:3].copy(),
        angular_impulse=engine.external[4:].copy(),
        kinetic=0.5 * float(sums[7]),
        strain=engine.mapping.stored_energy() + math.fsum(engine.over_materials(_stored)),
        external_work=float(engine.external[3]),
    )


def _stored(material: Material, p: Particles, rows: Rows) -> float:
    """The energy [J] that some particles store; NaN if their material has no energy function."""
    density = material.energy(p.deformation_gradient[rows], p.state[rows])
    return float("nan") if density is None else float(p.volume0[rows] @ density)


@dataclass
class Ledger:
    """The first and the latest balance, and the worst drifts between.

    Attributes
    ----------
    start, latest
        Entries.
    worst
        The largest drifts so far: ``mass`` [kg]; ``momentum`` [kg m/s] and ``angular_momentum``
        [kg m^2/s], the norm of the change less the external impulse; ``energy`` [J], the change of
        ``total``. Damping takes momentum and energy on purpose; the drift then shows how much.
    """

    start: LedgerEntry
    latest: LedgerEntry
    worst: dict[str, float] = field(
        default_factory=lambda: dict.fromkeys(("mass", "momentum", "angular_momentum", "energy"), 0.0)
    )

    def book(self, entry: LedgerEntry) -> None:
        """Take a new balance."""
        self.latest = entry
        for name, value in self.drift().items():
            # A NaN energy (no energy function) must not hide behind a comparison.
            if not value <= self.worst[name]:
                self.worst[name] = value

    def drift(self) -> dict[str, float]:
        """Return the drifts of the latest balance, by the names of ``worst``."""
        a, b = self.start, self.latest
        momentum = (b.momentum - b.impulse) - (a.momentum - a.impulse)
        angular = (b.angular_momentum - b.angular_impulse) - (a.angular_momentum - a.angular_impulse)
        return {
            "mass": abs(b.mass - a.mass),
            "momentum": float(np.linalg.norm(momentum)),
            "angular_momentum": float(np.linalg.norm(angular)),
            "energy": abs(b.total - a.total),
        }

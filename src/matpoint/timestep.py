"""The length of a step, and its limit."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from matpoint.checks import number, positive, whole
from matpoint.errors import InputError
from matpoint.interpolation import SplineIMLS
from matpoint.materials import Material
from matpoint.particles import Particles, Rows
from matpoint.transfers import FMPM

if TYPE_CHECKING:
    from matpoint.simulation import Simulation

# Methods, section 4: with USL, dt <= 0.7 l/c at enriched vertices. Cubes grow at exactly that, and are
# stable at 0.68.
VERTEX_SHARE = {1: 0.7, 2: 0.7, 3: 0.67}
# Degree of the splines -> (omega h/c)^2 of the stiffest mode of a bar between walls under their consistent
# mass, by eigenvalues: K a = omega^2 M a on four and more cells. The lumped mass of hats has 4.
_STIFFEST = {2: 10.0, 3: 17.1}
# Share of a cell that sound may cross in a step of a long run with a consistent mass (docs/imls.md).
_QUIET = 0.15


@dataclass(frozen=True)
class FixedStep:
    """One step length for the whole run.

    Parameters
    ----------
    dt
        [s]
    allow_unstable
        Turns the refusal of a step over the limit into a warning.
    """

    dt: float
    allow_unstable: bool = False

    def __post_init__(self) -> None:
        positive("time step: dt", self.dt)


@dataclass(frozen=True)
class CFL:
    """Steps that follow the limit.

    Parameters
    ----------
    fraction
        Share of the limit, 0 < fraction <= 1.
    every
        Steps between two looks at the limit.
    largest
        Upper bound of the step [s].
    """

    fraction: float = 0.4
    every: int = 1
    largest: float = math.inf

    def __post_init__(self) -> None:
        if not 0 < number("time step: CFL fraction", self.fraction) <= 1:
            raise InputError(f"time step: CFL fraction = {self.fraction!r} must be in (0, 1]")
        whole("time step: every", self.every)
        if self.largest != math.inf:
            positive("time step: largest", self.largest)


TimeStep = FixedStep | CFL


def stable_step(simulation: Simulation) -> float:
    """Return the largest stable step [s] where everything is now.

    A signal may cross no more than one cell, min_p h / (c_p + |v_p|), with c the wave speed in the
    deformed state; viscosity may spread no further, h^2 / (2 dim nu); and a signal may cross no more
    than 0.7 (in 3-D 0.67) of the height of a domain with enriched vertices, which move with the material,
    at its own c. FMPM(k) makes the lightest modes of the grid up to k times lighter, which divides all by
    sqrt(k). A consistent mass makes the grid stiffer: its limit is 2/omega of the stiffest mode, 0.63 of a
    cell for quadratic splines in 1-D, 0.45 in 2-D and 0.37 in 3-D.
    """
    spacing, finest = simulation.vertex_spacing(), simulation.grid.finest

    def rates(material: Material, p: Particles, rows: Rows) -> tuple[float, float]:
        speed = material.wave_speed(p.deformation_gradient[rows], p.state[rows])
        velocity = p.velocity[rows]
        rate = speed + np.sqrt(np.einsum("pa,pa->p", velocity, velocity))
        height = spacing[rows] if len(spacing) > 1 else spacing
        return float(rate.max()), float((speed / height).max())  # 1/inf = 0: no enriched vertex there

    fastest, crossing = np.array(simulation.engine.over_materials(rates)).max(axis=0)
    spread = max(material.diffusivity for material in simulation.materials)
    limit = finest / fastest if fastest > 0 else math.inf
    if spread > 0:
        limit = min(limit, finest**2 / (2 * simulation.dim * spread))
    if crossing > 0:
        limit = min(limit, VERTEX_SHARE[simulation.dim] / crossing)
    limit *= consistent_share(simulation)
    transfer = simulation.scheme.transfer
    return float(limit / math.sqrt(transfer.order) if isinstance(transfer, FMPM) else limit)


def consistent_share(simulation: Simulation) -> float:
    """Return the share that a consistent mass leaves of the limit; 1 where the mass is lumped."""
    choice = simulation.interpolation
    if not isinstance(choice, SplineIMLS):
        return 1.0
    return 2.0 / math.sqrt(_STIFFEST[choice.basis_degree] * simulation.dim)


def quiet_step(simulation: Simulation) -> float | None:
    """Return the step [s] up to which noise does not grow over long runs; None where the limit is enough.

    With a consistent mass noise grows before the limit is reached: sound should cross no more than 0.15 of
    a cell.
    """
    if not simulation.interpolation.consistent:
        return None
    return min(1.0, _QUIET / consistent_share(simulation)) * stable_step(simulation)

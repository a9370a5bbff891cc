"""Named numbers of a run that any writer can log."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from matpoint.ledger import take_entry
from matpoint.quality import aspect_ratios, corner_jacobians, warps

if TYPE_CHECKING:
    from matpoint.simulation import Simulation


@dataclass(frozen=True)
class Quantity:
    """A named number.

    Attributes
    ----------
    function
        Takes the simulation, returns a float.
    unit, description
        For headers and lists.
    """

    function: Callable[[Simulation], float]
    unit: str
    description: str


def _vector(name: str, unit: str, description: str, letter: str = "") -> dict[str, Quantity]:
    def component(k: int) -> Callable[[Simulation], float]:
        return lambda sim: float(getattr(take_entry(sim.engine), name)[k])

    return {
        f"{letter or name}_{axis}": Quantity(component(k), unit, f"{description}, component {axis}")
        for k, axis in enumerate("xyz")
    }


def _centre(k: int) -> Callable[[Simulation], float]:
    return lambda sim: float(sim.particles.mass @ sim.particles.position[:, k] / sim.particles.mass.sum())


def _smallest_volume_ratio(sim: Simulation) -> float:
    return float((sim.particles.volume / sim.particles.volume0).min())


def _domain_gap(sim: Simulation) -> float:
    return 0.0 if sim.vertices is None else float(domain_gaps(sim).max())


def _worst(sim: Simulation, name: str, choose: Callable[[np.ndarray], float]) -> float:
    """The worst of a reconstruction's diagnostics; 0 where a method has none."""
    values = getattr(sim.engine.mapping, name, None)
    return 0.0 if values is None or len(values) == 0 else float(choose(values))


def _smallest_corner_jacobian(sim: Simulation) -> float:
    return 1.0 if sim.vertices is None else float(corner_jacobians(sim.vertices).min())


def _largest_aspect_ratio(sim: Simulation) -> float:
    return 1.0 if sim.vertices is None else float(aspect_ratios(sim.vertices).max())


def _largest_warp(sim: Simulation) -> float:
    return 0.0 if sim.vertices is None else float(warps(sim.vertices).max())


def domain_gaps(sim: Simulation) -> np.ndarray:
    """Return |F by corner positions - F by rates| of each domain, in the particles' order, shape (n,)."""
    assert sim.vertices is not None
    gap = sim.vertices.deformation() - sim.particles.deformation_gradient
    return np.sqrt((gap**2).sum(axis=(1, 2)))


def _largest_speed(sim: Simulation) -> float:
    return float(np.sqrt((sim.particles.velocity**2).sum(axis=1).max()))


QUANTITIES: dict[str, Quantity] = {
    "mass": Quantity(lambda sim: take_entry(sim.engine).mass, "kg", "total mass"),
    **_vector("momentum", "kg m/s", "linear momentum"),
    **_vector("angular_momentum", "kg m^2/s", "angular momentum about the origin"),
    **_vector("impulse", "N s", "impulse of loads and conditions since the start"),
    "kinetic_energy": Quantity(lambda sim: take_entry(sim.engine).kinetic, "J", "kinetic energy"),
    "strain_energy": Quantity(lambda sim: take_entry(sim.engine).strain, "J", "stored energy"),
    "external_work": Quantity(
        lambda sim: take_entry(sim.engine).external_work, "J", "work of loads and conditions since the start"
    ),
    "total_energy": Quantity(
        lambda sim: take_entry(sim.engine).total, "J", "kinetic plus stored energy less external work"
    ),
    **{
        f"centre_{axis}": Quantity(_centre(k), "m", f"centre of mass, component {axis}")
        for k, axis in enumerate("xyz")
    },
    "smallest_volume_ratio": Quantity(_smallest_volume_ratio, "-", "smallest V / V0 of all particles"),
    "domain_gap": Quantity(_domain_gap, "-", "largest |F by corner positions - F by rates| of CPDI2 domains"),
    "largest_warp": Quantity(
        _largest_warp,
        "-",
        "largest distance of a corner from its domain's affine image, over an edge: hourglassing",
    ),
    "smallest_corner_jacobian": Quantity(
        _smallest_corner_jacobian, "-", "smallest corner Jacobian over the domain's mean; 0 turns over"
    ),
    "largest_aspect_ratio": Quantity(_largest_aspect_ratio, "-", "largest ratio of a domain's edges"),
    "fallen_domains": Quantity(
        lambda sim: float(len(sim.fallen)),
        "-",
        "domains that fell back to CPDI1",
    ),
    "grid_mass_error": Quantity(
        lambda sim: float(getattr(sim.engine.mapping, "grid_mass_error", 0.0)),
        "-",
        "mass on the nodes less that of the particles, over it: what a reconstruction does not conserve",
    ),
    "grid_momentum_error": Quantity(
        lambda sim: float(getattr(sim.engine.mapping, "grid_momentum_error", 0.0)),
        "-",
        "|momentum on the nodes less that of particles| over the sum of their |m v|, at the last transfer",
    ),
    "smallest_rank": Quantity(
        lambda sim: _worst(sim, "ranks", np.min),
        "-",
        "fewest columns kept by a reconstruction; 0 before the first step",
    ),
    "largest_condition": Quantity(
        lambda sim: _worst(sim, "conditions", np.max),
        "-",
        "largest condition number of a moment matrix (MLS)",
    ),
    "bad_points": Quantity(
        lambda sim: float(getattr(sim.engine.mapping, "bad_points", 0)),
        "-",
        "points whose moment matrix was too ill-conditioned, so that the degree was lowered (MLS)",
    ),
    "largest_speed": Quantity(_largest_speed, "m/s", "largest particle speed"),
    "dt": Quantity(lambda sim: sim.dt, "s", "length of the last step"),
}

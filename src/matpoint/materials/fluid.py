"""A Newtonian fluid with an equation of state."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, NamedTuple

import numpy as np

from matpoint.materials import checks
from matpoint.materials.contract import Array, Material, determinants, stress_law
from matpoint.tensor import det, sym


class NewtonianFluidParameters(NamedTuple):
    """What the law takes: K [Pa], γ, viscosity [Pa s], and the lowest pressure [Pa] that it carries."""

    bulk: float
    exponent: float
    viscosity: float
    lowest_pressure: float


@stress_law(NewtonianFluidParameters)
def newtonian_fluid(F, F_new, L, dt, state, params):
    """Return σ = -p I + 2η dev(D), p = (K/γ) (J^-γ - 1), D = sym(L)."""
    J = det(F_new)
    D = sym(L)
    pressure = params.bulk / params.exponent * (J ** (-params.exponent) - 1.0)
    pressure = max(pressure, params.lowest_pressure)
    viscosity = 2.0 * params.viscosity
    mean = -pressure - viscosity * (D[0][0] + D[1][1] + D[2][2]) / 3.0
    return (
        (mean + viscosity * D[0][0], viscosity * D[0][1], viscosity * D[0][2]),
        (viscosity * D[1][0], mean + viscosity * D[1][1], viscosity * D[1][2]),
        (viscosity * D[2][0], viscosity * D[2][1], mean + viscosity * D[2][2]),
    )


@dataclass(frozen=True)
class NewtonianFluid(Material):
    """Newtonian fluid: σ = -p I + 2η dev(D) with Tait's p = (K/γ) (J^-γ - 1).

    Parameters
    ----------
    density
        Density at zero pressure [kg/m³], > 0.
    viscosity
        Dynamic viscosity η [Pa s], ≥ 0.
    bulk_modulus
        K at zero pressure [Pa], > 0. Much less than a liquid's own will do if it keeps the
        speed of sound √(K/ρ) above ten times the flow's: the density then varies by 1 %.
    exponent
        γ of the equation of state, > 0; 7 for water, 1 for p = K (ρ/ρ0 - 1).
    tension_cutoff
        True if the fluid carries no tension (p ≥ 0): it parts instead.

    Raises
    ------
    InputError
        A parameter is out of its range.
    """

    citation: ClassVar[tuple[str, ...]] = ("monaghan1994",)

    density: float
    viscosity: float
    bulk_modulus: float
    exponent: float = 7.0
    tension_cutoff: bool = False

    def __post_init__(self) -> None:
        checks.positive(self, "density", "kg/m³")
        checks.not_negative(self, "viscosity", "Pa s")
        checks.positive(self, "bulk_modulus", "Pa")
        checks.positive(self, "exponent", "-")
        checks.boolean(self, "tension_cutoff")

    @property
    def params(self) -> NewtonianFluidParameters:
        """K, γ, η and the lowest pressure."""
        lowest = 0.0 if self.tension_cutoff else -np.inf
        return NewtonianFluidParameters(
            float(self.bulk_modulus), float(self.exponent), float(self.viscosity), lowest
        )

    @property
    def diffusivity(self) -> float:
        """Largest kinematic viscosity [m²/s]: (4/3) η/ρ0, that of a compression wave."""
        return 4.0 / 3.0 * self.viscosity / self.density

    def energy(self, F: Array, state: Array | None = None) -> Array:
        """Return the energy of the equation of state, W with -dW/dJ = p, W(1) = 0 [J/m³], (n,)."""
        J = determinants(F)
        if self.tension_cutoff:
            J = np.minimum(J, 1.0)
        power = 1.0 - self.exponent
        # (J^(1-γ) - 1)/(1-γ), which is ln J for γ = 1.
        integral = np.expm1(power * np.log(J)) / power if power else np.log(J)
        return self.bulk_modulus / self.exponent * (J - 1.0 - integral)

    def wave_speed(self, F: Array, state: Array | None = None) -> Array:
        """Return the speed of sound √(K J^(1-γ)/ρ0); exact but for the viscosity (see ``diffusivity``).

        With a tension cut-off it is the speed at J = 1 for all J > 1: an upper bound.
        """
        J = determinants(F)
        if self.tension_cutoff:
            J = np.minimum(J, 1.0)
        return np.sqrt(self.bulk_modulus * J ** (1.0 - self.exponent) / self.density)

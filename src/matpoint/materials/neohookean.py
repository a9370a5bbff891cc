"""Compressible neo-Hookean elasticity (S 27)."""

from __future__ import annotations

from dataclasses import dataclass
from math import log
from typing import ClassVar, NamedTuple

import numpy as np

from matpoint.materials.contract import Array, Elastic, determinants, largest_squares, stress_law
from matpoint.tensor import det, left_cauchy_green


class NeoHookeanParameters(NamedTuple):
    """What the law takes: λ and μ [Pa]."""

    lame: float
    shear: float


@stress_law(NeoHookeanParameters)
def neo_hookean(F, F_new, L, dt, state, params):
    """Return σ = (λ ln J / J) I + (μ/J) (F Fᵀ - I) (S 27)."""
    J = det(F_new)
    b = left_cauchy_green(F_new)
    shear = params.shear / J
    mean = params.lame * log(J) / J - shear
    return (
        (mean + shear * b[0][0], shear * b[0][1], shear * b[0][2]),
        (shear * b[1][0], mean + shear * b[1][1], shear * b[1][2]),
        (shear * b[2][0], shear * b[2][1], mean + shear * b[2][2]),
    )


@dataclass(frozen=True)
class NeoHookean(Elastic):
    """Compressible neo-Hookean elasticity: σ = (λ ln J / J) I + (μ/J) (F Fᵀ - I) (S 27).

    Parameters
    ----------
    E, nu, density
        Young's modulus [Pa] and Poisson's ratio at rest, density [kg/m³].
    """

    citation: ClassVar[tuple[str, ...]] = ("bonet2008",)

    @property
    def params(self) -> NeoHookeanParameters:
        """λ and μ."""
        return NeoHookeanParameters(self.lame, self.shear)

    def energy(self, F: Array, state: Array | None = None) -> Array:
        """Return W = (λ/2) ln²J - μ ln J + (μ/2) (F : F - 3) [J/m³], (n,)."""
        log_J = np.log(determinants(F))
        return (0.5 * self.lame * log_J - self.shear) * log_J + 0.5 * self.shear * (
            np.einsum("nij,nij->n", F, F) - 3.0
        )

    def wave_speed(self, F: Array, state: Array | None = None) -> Array:
        """Return c with ρ0 c² = max(λ (1 - ln J) + μ, 0) + μ s², s the largest stretch; exact.

        The acoustic tensor along n is (λ (1 - ln J) + μ) n⊗n + μ (n·F Fᵀ n) I.
        """
        log_J = np.log(determinants(F))
        normal = np.maximum(self.lame * (1.0 - log_J) + self.shear, 0.0)
        return np.sqrt((normal + self.shear * largest_squares(F)) / self.density)

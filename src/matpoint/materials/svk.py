"""Saint-Venant-Kirchhoff elasticity."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, NamedTuple

import numpy as np

from matpoint.materials.contract import Array, Elastic, principal_squares, stress_law
from matpoint.tensor import congruence, det, right_cauchy_green


class SaintVenantKirchhoffParameters(NamedTuple):
    """What the law takes: λ and μ [Pa]."""

    lame: float
    shear: float


@stress_law(SaintVenantKirchhoffParameters)
def saint_venant_kirchhoff(F, F_new, L, dt, state, params):
    """Return σ = (1/J) F S Fᵀ with S = λ tr(E) I + 2μ E and E = (Fᵀ F - I)/2."""
    C = right_cauchy_green(F_new)
    J = det(F_new)
    shear = params.shear / J
    mean = 0.5 * params.lame / J * (C[0][0] + C[1][1] + C[2][2] - 3.0) - shear
    S = (
        (mean + shear * C[0][0], shear * C[0][1], shear * C[0][2]),
        (shear * C[1][0], mean + shear * C[1][1], shear * C[1][2]),
        (shear * C[2][0], shear * C[2][1], mean + shear * C[2][2]),
    )
    return congruence(F_new, S)


@dataclass(frozen=True)
class SaintVenantKirchhoff(Elastic):
    """Saint-Venant-Kirchhoff elasticity: large rotations, moderate strains.

    S = λ tr(E) I + 2μ E with Green's strain E. The law softens in compression and loses its
    stiffness in uniaxial strain at a stretch of 1/√3: it is not for strong compression.

    Parameters
    ----------
    E, nu, density
        Young's modulus [Pa] and Poisson's ratio at rest, density [kg/m³].
    """

    citation: ClassVar[tuple[str, ...]] = ("bonet2008",)

    @property
    def params(self) -> SaintVenantKirchhoffParameters:
        """λ and μ."""
        return SaintVenantKirchhoffParameters(self.lame, self.shear)

    def energy(self, F: Array, state: Array | None = None) -> Array:
        """Return W = (λ/2) tr(E)² + μ E : E [J/m³], (n,)."""
        strain = 0.5 * (np.einsum("nki,nkj->nij", F, F) - np.eye(3))
        trace = np.einsum("nii->n", strain)
        return 0.5 * self.lame * trace**2 + self.shear * np.einsum("nij,nij->n", strain, strain)

    def wave_speed(self, F: Array, state: Array | None = None) -> Array:
        """Return c with ρ0 c² = (λ + 2μ) s⁴ + max(τ, 0), an upper bound, exact in tension.

        s is the largest principal stretch and τ the largest principal Kirchhoff stress: the
        acoustic tensor along n is (λ + μ) m⊗m + μ (n·m) b + (n·τ n) I, b = F Fᵀ, m = b n.
        """
        squares = principal_squares(F)
        strain = 0.5 * (squares - 1.0)
        tau = squares * (self.lame * strain.sum(axis=1, keepdims=True) + 2.0 * self.shear * strain)
        stiff = (self.lame + 2.0 * self.shear) * squares[:, 2] ** 2
        return np.sqrt((stiff + np.maximum(tau.max(axis=1), 0.0)) / self.density)

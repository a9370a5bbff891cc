"""Hencky elasticity: linear between Kirchhoff stress and logarithmic strain."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, NamedTuple

import numpy as np

from matpoint.materials.contract import Array, Elastic, principal_squares, stress_law
from matpoint.tensor import det, left_cauchy_green, log_sym


class HenckyParameters(NamedTuple):
    """What the law takes: λ and μ [Pa]."""

    lame: float
    shear: float


@stress_law(HenckyParameters)
def hencky(F, F_new, L, dt, state, params):
    """Return σ = (1/J) (λ ln J I + 2μ h) with h = ln(F Fᵀ)/2."""
    h = log_sym(left_cauchy_green(F_new))  # twice the strain
    J = det(F_new)
    shear = params.shear / J
    mean = 0.5 * params.lame / J * (h[0][0] + h[1][1] + h[2][2])
    return (
        (mean + shear * h[0][0], shear * h[0][1], shear * h[0][2]),
        (shear * h[1][0], mean + shear * h[1][1], shear * h[1][2]),
        (shear * h[2][0], shear * h[2][1], mean + shear * h[2][2]),
    )


@dataclass(frozen=True)
class Hencky(Elastic):
    """Hencky elasticity: J σ = λ ln J I + 2μ h with the logarithmic strain h = ln(F Fᵀ)/2.

    Parameters
    ----------
    E, nu, density
        Young's modulus [Pa] and Poisson's ratio at rest, density [kg/m³].
    """

    citation: ClassVar[tuple[str, ...]] = ("bonet2008",)

    @property
    def params(self) -> HenckyParameters:
        """λ and μ."""
        return HenckyParameters(self.lame, self.shear)

    def energy(self, F: Array, state: Array | None = None) -> Array:
        """Return W = (λ/2) ln²J + μ h : h [J/m³], (n,)."""
        strain = 0.5 * np.log(principal_squares(F))
        return 0.5 * self.lame * strain.sum(axis=1) ** 2 + self.shear * (strain**2).sum(axis=1)

    def wave_speed(self, F: Array, state: Array | None = None) -> Array:
        """Return c from :func:`wave_stiffness`: an upper bound, exact at rest."""
        stiffness = wave_stiffness(self.lame, self.shear, 0.5 * np.log(principal_squares(F)))
        return np.sqrt(stiffness / self.density)


def wave_stiffness(lame: float, shear: float, strain: Array) -> Array:
    """Return an upper bound of ρ0 c² over all directions for Hencky elasticity.

    In principal axes the acoustic tensor along n has, with τ_i = λ Σh + 2μ h_i,

        q_ii = n_i² (λ + 2μ - τ_i) + Σ_{j≠i} n_j² g_ji,   q_ik = n_i n_k (λ + g_ik - τ_i),

    g_ik = s_i² (τ_i - τ_k)/(s_i² - s_k²) = μ r/(1 - exp(-r)), r = 2 (h_i - h_k). With H the
    largest |λ + g_ik - τ_i|, Cauchy-Schwarz gives q ≤ max(λ + 2μ - τ_i, H + g_ik).

    Parameters
    ----------
    lame, shear
        λ and μ [Pa].
    strain
        Principal logarithmic (elastic) strains h_i, (n, 3).

    Returns
    -------
    array
        The bound [Pa], (n,); λ + 2μ at rest, which is exact.
    """
    tau = lame * strain.sum(axis=1, keepdims=True) + 2.0 * shear * strain
    first, second = np.array([0, 0, 1, 1, 2, 2]), np.array([1, 2, 0, 2, 0, 1])
    r = 2.0 * (strain[:, first] - strain[:, second])
    equal = np.abs(r) < 1e-12  # r/(1 - exp(-r)) → 1
    g = shear * np.where(equal, 1.0, r / np.where(equal, 1.0, -np.expm1(-r)))
    coupling = np.abs(lame + g - tau[:, first]).max(axis=1)
    return np.maximum((lame + 2.0 * shear - tau).max(axis=1), coupling + g.max(axis=1))

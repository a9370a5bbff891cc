"""Linear elasticity for small strains and small rotations."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, NamedTuple

import numpy as np

from matpoint.materials.contract import Array, Elastic, determinants, largest_squares, stress_law
from matpoint.tensor import sym


class LinearElasticParameters(NamedTuple):
    """What the law takes: λ and μ [Pa]."""

    lame: float
    shear: float


@stress_law(LinearElasticParameters)
def linear_elastic(F, F_new, L, dt, state, params):
    """Return σ = λ tr(ε) I + 2μ ε with ε = (F + Fᵀ)/2 - I."""
    e = sym(F_new)
    shear = 2.0 * params.shear
    mean = params.lame * (e[0][0] + e[1][1] + e[2][2] - 3.0) - shear
    return (
        (mean + shear * e[0][0], shear * e[0][1], shear * e[0][2]),
        (shear * e[1][0], mean + shear * e[1][1], shear * e[1][2]),
        (shear * e[2][0], shear * e[2][1], mean + shear * e[2][2]),
    )


@dataclass(frozen=True)
class LinearElastic(Elastic):
    """Linear elasticity with the small strain ε = (F + Fᵀ)/2 - I.

    Only for small strains *and* small rotations: it is not frame indifferent. A rigid rotation
    by the angle θ gives the false strain cos θ - 1 ≈ -θ²/2 across its axis: 4e-5 for half a degree.

    Parameters
    ----------
    E, nu, density
        Young's modulus [Pa] and Poisson's ratio, density [kg/m³].
    """

    citation: ClassVar[tuple[str, ...]] = ("bonet2008",)

    @property
    def params(self) -> LinearElasticParameters:
        """λ and μ."""
        return LinearElasticParameters(self.lame, self.shear)

    def energy(self, F: Array, state: Array | None = None) -> Array:
        """Return W = (λ/2) tr(ε)² + μ ε : ε [J/m³], (n,); it fits σ to first order in ε."""
        strain = 0.5 * (F + np.swapaxes(F, 1, 2)) - np.eye(3)
        trace = np.einsum("nii->n", strain)
        return 0.5 * self.lame * trace**2 + self.shear * np.einsum("nij,nij->n", strain, strain)

    def wave_speed(self, F: Array, state: Array | None = None) -> Array:
        """Return c with ρ0 c² = J s (|λ| + 2μ), s the largest stretch: an upper bound.

        A wave a⊗n changes ε by sym(a ⊗ Fᵀn) and hence the traction by at most
        (|λ| + 2μ) |Fᵀn| |a|. At rest, for ν ≥ 0, it is exact.
        """
        modulus = abs(self.lame) + 2.0 * self.shear
        stiffness = modulus * determinants(F) * np.sqrt(largest_squares(F))
        return np.sqrt(stiffness / self.density)

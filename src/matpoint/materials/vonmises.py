"""Von Mises plasticity with linear isotropic hardening at finite strain."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import exp, log, sqrt
from types import MappingProxyType
from typing import ClassVar, NamedTuple

import numpy as np

from matpoint.kernels.stretches import determinants, eigenvalues
from matpoint.materials import checks
from matpoint.materials.contract import Array, Elastic, stress_law
from matpoint.materials.hencky import wave_stiffness
from matpoint.tensor import congruence, det, dot, eigen, inverse, spectral

_STATE = MappingProxyType(
    dict(zip(("be_xx", "be_yy", "be_zz", "be_xy", "be_yz", "be_xz"), (1.0,) * 3 + (0.0,) * 3, strict=True))
    | {"plastic_strain": 0.0}
)


class VonMisesParameters(NamedTuple):
    """What the law takes: K, μ, yield stress and hardening modulus [Pa]."""

    bulk: float
    shear: float
    yield_stress: float
    hardening: float


@stress_law(VonMisesParameters)
def von_mises(F, F_new, L, dt, state, params):
    """Return σ after an exact return mapping in the principal axes of the trial state.

    b_e,trial = f b_e fᵀ with f = F_new F⁻¹; J σ = K ln J I + s with s = 2μ dev(ln b_e)/2 and
    q = √(3/2) |s| ≤ σ_y + H α. With logarithmic strains and the exponential map the return is
    that of small strains, Δα = (q_trial - σ_y - H α)/(3μ + H) (Simo and Hughes, chapter 9).
    """
    b = ((state[0], state[3], state[5]), (state[3], state[1], state[4]), (state[5], state[4], state[2]))
    b = congruence(dot(F_new, inverse(F)), b)
    J = det(F_new)
    values, axes = eigen(b)
    h0, h1, h2 = 0.5 * log(values[0]), 0.5 * log(values[1]), 0.5 * log(values[2])
    mean = (h0 + h1 + h2) / 3.0
    double = 2.0 * params.shear
    s0, s1, s2 = double * (h0 - mean), double * (h1 - mean), double * (h2 - mean)
    q = sqrt(1.5 * (s0 * s0 + s1 * s1 + s2 * s2))
    excess = q - params.yield_stress - params.hardening * state[6]
    if excess > 0.0:
        growth = excess / (3.0 * params.shear + params.hardening)
        shrink = 1.0 - 3.0 * params.shear * growth / q
        s0, s1, s2 = shrink * s0, shrink * s1, shrink * s2
        # Plastic flow keeps the volume: the mean is set from J, so that det(b_e) can't drift from J².
        mean = log(J) / 3.0
        b = spectral(
            (
                exp(2.0 * (mean + s0 / double)),
                exp(2.0 * (mean + s1 / double)),
                exp(2.0 * (mean + s2 / double)),
            ),
            axes,
        )
        state[6] += growth
    state[0], state[1], state[2] = b[0][0], b[1][1], b[2][2]
    state[3], state[4], state[5] = b[0][1], b[1][2], b[0][2]
    pressure = params.bulk * log(J)
    return spectral(((pressure + s0) / J, (pressure + s1) / J, (pressure + s2) / J), axes)


@dataclass(frozen=True)
class VonMises(Elastic):
    """Von Mises plasticity, finite strain, Hencky elasticity, linear isotropic hardening.

    Multiplicative, F = F_e F_p. The state is the elastic left Cauchy-Green tensor b_e and the
    equivalent plastic strain α. A body that starts deformed needs its b_e set to F Fᵀ.

    Parameters
    ----------
    E, nu, density
        Young's modulus [Pa] and Poisson's ratio at rest, density [kg/m³].
    yield_stress
        Kirchhoff equivalent stress at first yield σ_y [Pa], > 0.
    hardening
        Growth H of the yield stress with α [Pa], ≥ 0.

    Raises
    ------
    InputError
        A parameter is out of its range.
    """

    citation: ClassVar[tuple[str, ...]] = ("simo1998",)

    yield_stress: float
    hardening: float = 0.0

    def __post_init__(self) -> None:
        super().__post_init__()
        checks.positive(self, "yield_stress", "Pa")
        checks.not_negative(self, "hardening", "Pa")

    @property
    def params(self) -> VonMisesParameters:
        """K, μ, σ_y and H."""
        return VonMisesParameters(self.bulk, self.shear, float(self.yield_stress), float(self.hardening))

    @property
    def state_variables(self) -> Mapping[str, float]:
        """b_e (identity) and the equivalent plastic strain (0)."""
        return _STATE

    @property
    def plotted_strain(self) -> float:
        """Twenty times the strain at first yield in tension, at most 0.3."""
        return min(0.3, 20.0 * float(self.yield_stress) / float(self.E))

    def _elastic_strain(self, F: Array, state: Array | None) -> Array:
        """Return the principal logarithmic elastic strains, (n, 3), their sum set to ln J."""
        mean = np.log(determinants(F))[:, None] / 3.0
        if state is None:
            return np.repeat(mean, 3, axis=1)
        strain = 0.5 * np.log(eigenvalues(state[:, [0, 3, 5, 3, 1, 4, 5, 4, 2]].reshape(-1, 3, 3)))
        return strain - strain.mean(axis=1, keepdims=True) + mean

    def energy(self, F: Array, state: Array | None = None) -> Array:
        """Return W = (K/2) ln²J + μ |dev h_e|² + (H/2) α² [J/m³], (n,): elastic and hardening energy.

        What σ_y dissipates, σ_y α, is not stored and not in it. Without a state: the volumetric part.
        """
        strain = self._elastic_strain(F, state)
        volumetric = strain.sum(axis=1)
        deviator = strain - volumetric[:, None] / 3.0
        alpha = 0.0 if state is None else state[:, 6]
        elastic = 0.5 * self.bulk * volumetric**2 + self.shear * (deviator**2).sum(axis=1)
        return elastic + 0.5 * self.hardening * alpha**2

    def wave_speed(self, F: Array, state: Array | None = None) -> Array:
        """Return the elastic speed, an upper bound of the plastic one.

        Without a state the elastic stretch is taken as J^(1/3) I, which leaves out the deviatoric
        stress: a relative error of the order of σ_y/μ.
        """
        stiffness = wave_stiffness(self.lame, self.shear, self._elastic_strain(F, state))
        return np.sqrt(stiffness / self.density)

"""One line per material: what every test of materials runs over.

``elastic``: the stress is the derivative of the energy. ``indifferent``: a rotation only turns
the stress. ``exact_speed``: the wave speed is exact in every state, not just an upper bound.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from matpoint import tensor
from matpoint.kernels.laws import cauchy_stress
from matpoint.materials import (
    Hencky,
    LinearElastic,
    Material,
    NeoHookean,
    NewtonianFluid,
    SaintVenantKirchhoff,
    UserMaterial,
    VonMises,
)


@dataclass(frozen=True)
class Case:
    material: Material
    elastic: bool = True
    indifferent: bool = True
    exact_speed: bool = False


def user_neo_hookean(F, F_new, L, dt, state, params):
    J = tensor.det(F_new)
    shape = tensor.add(tensor.left_cauchy_green(F_new), tensor.scale(-1.0, tensor.identity()))
    mean = tensor.scale(params.lame * np.log(J) / J, tensor.identity())
    state[0] += dt
    return tensor.add(mean, tensor.scale(params.shear / J, shape))


_NEO = NeoHookean(1e6, 0.3, 1000.0)
USER = UserMaterial(
    user_neo_hookean,
    parameters={"lame": _NEO.lame, "shear": _NEO.shear},
    density=1000.0,
    state={"age": 0.0},
    speed=lambda F, state: _NEO.wave_speed(F),
    stored_energy=lambda F, state: _NEO.energy(F),
)

CASES: dict[str, Case] = {
    "neo-hookean": Case(_NEO, exact_speed=True),
    "neo-hookean-auxetic": Case(NeoHookean(1e6, -0.4, 1000.0), exact_speed=True),
    "hencky": Case(Hencky(1e6, 0.3, 1000.0)),
    "saint-venant-kirchhoff": Case(SaintVenantKirchhoff(1e6, 0.3, 1000.0)),
    "linear-elastic": Case(LinearElastic(1e6, 0.3, 1000.0), elastic=False, indifferent=False),
    "newtonian-fluid": Case(NewtonianFluid(1000.0, 0.0, 1e6), exact_speed=True),
    "newtonian-fluid-linear": Case(NewtonianFluid(1000.0, 0.0, 1e6, exponent=1.0), exact_speed=True),
    "newtonian-fluid-viscous": Case(NewtonianFluid(1000.0, 3.0, 1e6, tension_cutoff=True), elastic=False),
    "von-mises": Case(VonMises(1e6, 0.3, 1000.0, 5e4, 1e5), elastic=False),
    "von-mises-elastic": Case(VonMises(1e6, 0.3, 1000.0, 1e9)),
    "user": Case(USER, exact_speed=True),
}


def stress(material: Material, F: np.ndarray, start: np.ndarray | None = None) -> np.ndarray:
    """Cauchy stress (3, 3) after one step from ``start`` (undeformed) to F, without rate."""
    return stress_and_state(material, F, start)[0]


def stress_and_state(
    material: Material,
    F: np.ndarray,
    start: np.ndarray | None = None,
    state: np.ndarray | None = None,
    L: np.ndarray | None = None,
) -> tuple[np.ndarray, np.ndarray]:
    """Stress (3, 3) and state (S,) after one step, by the law in plain Python."""
    start = np.eye(3) if start is None else start
    L = np.zeros((3, 3)) if L is None else L
    state = material.initial_state(1)[0] if state is None else state.copy()
    tuples = [tuple(map(tuple, A.tolist())) for A in (start, F, L)]
    return np.array(cauchy_stress(*tuples, 1e-3, state, material.params)), state

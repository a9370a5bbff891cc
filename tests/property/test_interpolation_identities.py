"""The identities of a good interpolation, for every interpolation, dimension and kind of domain."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from matpoint import CPDI1, CPDI2, CPGIMP, TLS, UGIMP, BSpline, EnrichedCPDI2, Linear
from support import KIND_OF_DIM, bind, deformed_mesh, gather_field, setting_of

INTERPOLATIONS = [
    Linear(),
    UGIMP(),
    CPGIMP(),
    CPGIMP(stretch="U"),
    BSpline(2),
    BSpline(3),
    CPDI1(),
    CPDI2(),
    EnrichedCPDI2(),
    EnrichedCPDI2(layers=1, hourglass=0.3),
    EnrichedCPDI2(where="all"),
]
# Fields at Gauss points: mass, momentum and force are kept, first moments and work are not.
CONSERVATIVE = [TLS(), TLS(boxes=False), TLS(BSpline(2), degree=2, points=3)]


def _cases(choices):
    return [
        pytest.param(choice, dim, kind, id=f"{choice.name}-{dim}d-{kind.name.lower()}")
        for choice in choices
        for dim in (1, 2, 3)
        for kind in KIND_OF_DIM[dim]
    ]


CASES = _cases(INTERPOLATIONS)
SEEDS = st.integers(0, 2**32 - 1)


def _bound(choice, dim, kind, seed):
    rng = np.random.default_rng(seed)
    setting = setting_of(deformed_mesh(dim, kind, rng), rng)
    return setting, bind(choice, setting), rng


@pytest.mark.parametrize(("choice", "dim", "kind"), CASES + _cases(CONSERVATIVE))
@given(seed=SEEDS)
def test_reproduces_constant_and_linear_fields(choice, dim, kind, seed):
    setting, mapping, rng = _bound(choice, dim, kind, seed)
    x_i = mapping.points()
    constant, slope = gather_field(mapping, setting, np.ones_like(x_i))
    np.testing.assert_allclose(constant, 1.0, rtol=0, atol=1e-12)
    np.testing.assert_allclose(slope, 0.0, rtol=0, atol=1e-10)
    position, unit = gather_field(mapping, setting, x_i)
    np.testing.assert_allclose(position, setting.particles.position, rtol=0, atol=1e-11)
    expected = np.zeros((3, 3))
    expected[:dim, :dim] = np.eye(dim)
    np.testing.assert_allclose(unit, np.broadcast_to(expected, unit.shape), rtol=0, atol=1e-10)
    A, b = rng.normal(size=(3, 3)), rng.normal(size=3)
    value, L = gather_field(mapping, setting, x_i @ A.T + b)
    np.testing.assert_allclose(value, setting.particles.position @ A.T + b, rtol=0, atol=1e-10)
    np.testing.assert_allclose(L[:, :, :dim], np.broadcast_to(A[:, :dim], L[:, :, :dim].shape), atol=1e-9)


@pytest.mark.parametrize(("choice", "dim", "kind"), CASES + _cases(CONSERVATIVE))
@given(seed=SEEDS)
def test_conserves_mass_momentum_and_balances_forces(choice, dim, kind, seed):
    setting, mapping, rng = _bound(choice, dim, kind, seed)
    p, records = setting.particles, mapping.nodes.records
    body = rng.normal(size=(len(p), 3))
    mapping.nodes.clear(mapping.team)
    mapping.to_nodes(body, kinematic=True, dynamic=True)
    np.testing.assert_allclose(records[:, 3].sum(), p.mass.sum(), rtol=1e-12)
    np.testing.assert_allclose(records[:, :3].sum(axis=0), p.mass @ p.velocity, rtol=0, atol=1e-11)
    np.testing.assert_allclose(records[:, 4:7].sum(axis=0), p.mass @ body, rtol=0, atol=1e-9)
    if choice in CONSERVATIVE:
        return
    # First moments of mass, and of momentum about the origin, are kept as well.
    x_i = mapping.points()
    np.testing.assert_allclose(records[:, 3] @ x_i, p.mass @ p.position, rtol=0, atol=1e-10)


@pytest.mark.parametrize(("choice", "dim", "kind"), CASES)
@given(seed=SEEDS)
def test_stress_makes_no_net_force_or_moment_and_is_work_conjugate(choice, dim, kind, seed):
    setting, mapping, rng = _bound(choice, dim, kind, seed)
    p, records = setting.particles, mapping.nodes.records
    p.stress[:] = rng.normal(size=6)  # constant stress
    mapping.nodes.clear(mapping.team)
    mapping.to_nodes(np.zeros((1, 3)), kinematic=False, dynamic=True)
    force, x_i = records[:, 4:7].copy(), mapping.points()
    np.testing.assert_allclose(force.sum(axis=0), 0.0, atol=1e-9)
    moment = np.cross(x_i, force).sum(axis=0)
    # Moments about axes that the run does not have are not carried by it.
    active = {1: (), 2: (2,), 3: (0, 1, 2)}[dim]
    np.testing.assert_allclose(moment[list(active)], 0.0, atol=1e-8)
    p.stress[:] = rng.normal(size=p.stress.shape)
    mapping.nodes.clear(mapping.team)
    mapping.to_nodes(np.zeros((1, 3)), kinematic=False, dynamic=True)
    force = records[:, 4:7].copy()
    velocity = rng.normal(size=force.shape)
    _, L = gather_field(mapping, setting, velocity)
    s = p.stress[:, [[0, 3, 5], [3, 1, 4], [5, 4, 2]]]
    power = -np.einsum("p,pab,pab->", p.volume, s, L)
    np.testing.assert_allclose((force * velocity).sum(), power, rtol=1e-10, atol=1e-9)

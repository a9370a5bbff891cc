"""The stable step of a consistent mass, against eigenvalues and runs on both sides of it."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

import matpoint as mp
from matpoint.timestep import quiet_step, stable_step
from runs import advance


@pytest.mark.parametrize(("degree", "stiffest"), [(2, 10.0), (3, 17.1)])
def test_a_consistent_mass_shortens_the_stable_step(degree, stiffest):
    """2/omega of the stiffest mode between walls; a tenth above it such a bar blows up, below it does not."""
    lumped, full = mp.IMLS(mp.BSpline(degree)), mp.SplineIMLS(basis_degree=degree)
    share = stable_step(bar(full)) / stable_step(bar(lumped))
    assert share == pytest.approx(2.0 / np.sqrt(stiffest))
    limit = stable_step(bar(full))
    noise = [np.abs(advance(bar(full, f * limit), 100).particles.velocity).max() for f in (0.01, 0.95)]
    assert noise[1] < 3 * noise[0]
    with pytest.raises(mp.RunError):
        advance(bar(full, 1.25 * limit), 200)
    assert quiet_step(bar(lumped)) is None
    assert quiet_step(bar(full)) == pytest.approx(0.15 * stable_step(bar(lumped)))


def bar(interpolation, dt=1e-5):
    soft = mp.LinearElastic(E=1e4, nu=0.3, density=1e3)
    body = mp.Body(mp.mesh_box((0.0,), (1.0,), (48,)), soft, velocity=shaken)
    walls = [mp.Roller(mp.Plane("x", at)) for at in (0.0, 1.0)]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return mp.Simulation(
            mp.Grid((0.0,), (1.0,), 1 / 16), [body], interpolation=interpolation, boundaries=walls,
            timestep=mp.FixedStep(dt, allow_unstable=True), threads=1,
        )  # fmt: skip


def shaken(x):
    return 1e-8 * np.random.default_rng(1).standard_normal(x.shape)

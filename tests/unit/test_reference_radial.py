"""The spinning ring along its radius: closed form, modes and explicit finite elements."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from matpoint.errors import InputError
from matpoint.reference.radial import radial_fem
from matpoint.reference.radial_operators import RadialOperators, radial_frequencies
from matpoint.reference.ring import LayeredRing, StaticRing

STIFF_INSIDE = LayeredRing()
STIFF_OUTSIDE = LayeredRing(youngs=(5e8, 1e9))
ORDERS = pytest.mark.parametrize("ring", [STIFF_INSIDE, STIFF_OUTSIDE], ids=["inside", "outside"])
UNEVEN = LayeredRing((1.0, 1.3, 1.4, 2.0), (3e6, 1e5, 8e6), (0.1, 0.45, 0.3), (900.0, 1500.0, 1100.0), 2.0)


@pytest.mark.parametrize(
    ("ring", "period", "largest", "static", "low", "high"),
    [
        (STIFF_INSIDE, 0.021339, 7.2527e-5, 119.35, 0.0, 238.9),
        (STIFF_OUTSIDE, 0.021553, 7.4012e-5, -87.13, -188.4, 13.6),
    ],
    ids=["inside", "outside"],
)
def test_ring_gives_the_known_figures(ring, period, largest, static, low, high):
    run = radial_fem(ring, end=0.02, step=2e-6, elements=20, every=4)
    assert 2 * np.pi / radial_frequencies(ring)[0] == pytest.approx(period, abs=6e-7)
    assert run.displacement_at(3.0).max() == pytest.approx(largest, rel=5e-5)
    assert StaticRing(ring).stress(3.1)[0] == pytest.approx(static, abs=0.01)
    traction = run.traction()
    assert traction.min() == pytest.approx(low, abs=0.3)
    assert traction.max() == pytest.approx(high, abs=0.3)


@pytest.mark.parametrize("ring", [STIFF_INSIDE, UNEVEN], ids=["two", "three"])
def test_static_solution_is_in_equilibrium_and_bonded(ring):
    static = StaticRing(ring, inner_pressure=700.0, outer_pressure=-200.0)
    first, last = static.stress(ring.radii[0])[0], static.stress(ring.radii[-1])[0]
    np.testing.assert_allclose([first, last], [-700.0, 200.0], atol=1e-6)
    e = 1e-4
    lam, mu = ring.lame()
    for k, (low, high) in enumerate(zip(ring.radii[:-1], ring.radii[1:], strict=True)):
        R = np.linspace(low + 2 * e, high - 2 * e, 7)
        u, s = static.displacement(R), static.stress(R)
        strain = (static.displacement(R + e) - static.displacement(R - e)) / (2 * e)
        expected = (lam[k] + 2 * mu[k]) * strain + lam[k] * u / R
        np.testing.assert_allclose(s[:, 0], expected, atol=1e-5 * np.abs(s).max())
        np.testing.assert_allclose(s[:, 2], ring.poissons[k] * (s[:, 0] + s[:, 1]), rtol=1e-9)
        slope = (static.stress(R + e) - static.stress(R - e))[:, 0] / (2 * e)
        residual = slope + (s[:, 0] - s[:, 1]) / R + ring.densities[k] * ring.omega**2 * R
        assert np.abs(residual).max() < 1e-4 * np.abs(s[:, 1] / R).max()
    for R in ring.radii[1:-1]:
        sides = static.stress(R, "inner"), static.stress(R, "outer")
        assert sides[0][0] == pytest.approx(sides[1][0], rel=1e-9)
        assert abs(sides[0][1] - sides[1][1]) > 1.0
        above = static.displacement(R * (1 + 1e-9))
        assert static.displacement(R) == pytest.approx(above, rel=1e-6)


def test_thick_cylinder_under_pressure_is_that_of_lame():
    """sigma = p a^2/(b^2 - a^2) (1 -+ b^2/r^2), whatever the number of equal layers."""
    for layers in (1, 3):
        ring = LayeredRing(
            np.linspace(1.0, 2.0, layers + 1), [1e6] * layers, [0.3] * layers, [1.0] * layers, omega=0.0
        )
        static, R = StaticRing(ring, inner_pressure=5.0), np.linspace(1.0, 2.0, 9)
        s = static.stress(R)
        np.testing.assert_allclose(s[:, 0], 5.0 / 3.0 * (1 - 4 / R**2), atol=1e-12)
        np.testing.assert_allclose(s[:, 1], 5.0 / 3.0 * (1 + 4 / R**2), atol=1e-12)
        np.testing.assert_allclose(s[:, 2], 1.0, atol=1e-12)
        u = 1.3 / 1e6 * 5.0 / 3.0 * ((1 - 0.6) * R + 4 / R)
        np.testing.assert_allclose(static.displacement(R), u, rtol=1e-12)


@pytest.mark.parametrize("ring", [STIFF_INSIDE, UNEVEN], ids=["two", "three"])
def test_finite_elements_at_rest_converge_to_the_closed_form(ring):
    static, errors = StaticRing(ring), []
    for elements in (8, 16, 32):
        operators = RadialOperators(ring, elements)
        diagonal, off = operators.stiffness()
        K = np.diag(diagonal) + np.diag(off, 1) + np.diag(off, -1)
        u = np.linalg.solve(K, operators.mass * ring.omega**2 * operators.nodes)
        small = 1e-5 / np.abs(u).max() * u  # differences of forces are linear in these
        force = 0.5 * (operators.forces(small) - operators.forces(-small))
        np.testing.assert_allclose(force, K @ small, atol=1e-5 * np.abs(K @ small).max())
        errors.append(np.abs(u - static.displacement(operators.nodes)).max() / np.abs(u).max())
    assert (np.log2(np.array(errors[:-1]) / errors[1:]) > 1.9).all(), errors


@ORDERS
def test_first_period_is_the_motion_of_the_run(ring):
    run = radial_fem(ring, end=0.025, step=4e-6, elements=10, every=1)
    mean = StaticRing(ring).displacement(3.0)
    u = run.displacement_at(3.0)[:, 0] - mean
    rising = np.flatnonzero((u[:-1] < 0) & (u[1:] >= 0))
    falling = np.flatnonzero((u[:-1] > 0) & (u[1:] <= 0))
    half = run.times[falling[0]] - run.times[rising[0]]
    assert 2 * half == pytest.approx(2 * np.pi / radial_frequencies(ring)[0], rel=2e-3)
    # Sides agree, and more so with smaller elements.
    fine = radial_fem(ring, end=0.01, step=2e-6, elements=20, every=50)
    gaps = [np.abs(r.stress_at(3.1) - r.stress_at(3.1, "outer"))[:, 0, 0].max() for r in (run, fine)]
    assert gaps[0] < 0.4
    assert gaps[1] < 0.35 * gaps[0]


def test_stress_is_that_of_the_law_at_finite_strain():
    """A uniform stretch of the radius, u = c R: F_rr = F_tt = 1 + c."""
    operators, c = RadialOperators(STIFF_INSIDE, 4), 0.3
    lam, mu = STIFF_INSIDE.lame()
    s = operators.stress(c * operators.nodes)
    J = (1 + c) ** 2
    plane = (lam * np.log(J) + mu * ((1 + c) ** 2 - 1)) / J
    np.testing.assert_allclose(s[:, 0], np.repeat(plane, 4))
    np.testing.assert_allclose(s[:, 1], s[:, 0])
    np.testing.assert_allclose(s[:, 2], np.repeat(lam * np.log(J) / J, 4))
    # No net force inside a layer: sigma_r = sigma_t, uniform.
    assert np.abs(operators.forces(c * operators.nodes)[1:4]).max() < 1e-6 * plane[0]
    assert operators.mass.sum() == pytest.approx(1000.0 * (3.2**2 - 3.0**2) / 2)


def test_histories_interpolate_linearly_within_a_layer():
    run = radial_fem(STIFF_INSIDE, end=1e-3, step=1e-5, elements=4, every=10)
    assert run.times[-1] == pytest.approx(1e-3)
    np.testing.assert_allclose(run.displacement_at(run.nodes), run.displacement)
    np.testing.assert_allclose(run.stress_at(run.centres), run.stress, atol=1e-9)
    last, before = run.stress[:, 3], run.stress[:, 2]
    np.testing.assert_allclose(run.stress_at(3.1)[:, 0], 1.5 * last - 0.5 * before, atol=1e-9)


@pytest.mark.parametrize(
    ("change", "word"),
    [
        ({"radii": (3.0, 3.2)}, "youngs"),
        ({"radii": (3.0, 3.3, 3.2)}, "increase"),
        ({"radii": (0.0, 3.1, 3.2)}, "positive"),
        ({"youngs": (1.0, -1.0)}, "youngs"),
        ({"poissons": (0.3, 0.5)}, "poissons"),
        ({"densities": (1.0, float("nan"))}, "densities"),
        ({"omega": float("inf")}, "omega"),
    ],
)
def test_bad_rings_are_refused(change, word):
    with pytest.raises(InputError, match=word):
        replace(STIFF_INSIDE, **change)


@pytest.mark.parametrize(
    ("change", "word"),
    [
        ({"step": 1.0}, "at most"),
        ({"end": 0.0}, "one step"),
        ({"every": 0}, "every"),
        ({"elements": 1}, "2 in"),
    ],
)
def test_bad_radial_runs_are_refused(change, word):
    with pytest.raises(InputError, match=word):
        radial_fem(STIFF_INSIDE, **{"end": 1e-3, "step": 1e-6, **change})


def test_bad_questions_are_refused():
    run = radial_fem(STIFF_INSIDE, end=1e-4, step=1e-5, elements=2)
    for ask, word in (
        (lambda: run.displacement_at(2.9), "radii"),
        (lambda: run.stress_at(3.1, "left"), "side"),
        (lambda: run.traction(1), "interface"),
        (lambda: radial_frequencies(STIFF_INSIDE, 4, 0), "count"),
    ):
        with pytest.raises(InputError, match=word):
            ask()

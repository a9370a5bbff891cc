"""The reference solutions: finite elements and modes, each against the other and by hand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from matpoint.errors import InputError
from matpoint.reference.bar import LayeredBar
from matpoint.reference.fem_bar import assemble_bar, fem_bar
from matpoint.reference.modal import ModalBar, natural_frequencies

ABOVE = LayeredBar()
BELOW = LayeredBar(lower=1e7, upper=5e6)
ORDERS = pytest.mark.parametrize("bar", [ABOVE, BELOW], ids=["above", "below"])


@pytest.mark.parametrize(
    ("bar", "period", "tip", "when", "stress"),
    [(ABOVE, 0.34736, 0.08030, 0.1674, 95.2e3), (BELOW, 0.42957, 0.11151, 0.2187, 79.0e3)],
    ids=["above", "below"],
)
def test_modal_solution_gives_the_known_figures(bar, period, tip, when, stress):
    modal = ModalBar(bar)
    times = np.linspace(0.0, 0.5, 5001)
    sag = -modal.displacement(np.array([0.0]), times)[:, 0]
    assert modal.period == pytest.approx(period, abs=6e-6)
    assert sag.max() == pytest.approx(tip, abs=6e-6)
    assert times[sag.argmax()] == pytest.approx(when, abs=1.1e-4)
    interface = modal.stress(np.array([bar.interface]), np.array([0.14]))[0, 0]
    assert interface == pytest.approx(stress, abs=60.0)


@ORDERS
def test_frequencies_solve_the_equation_and_none_is_missed(bar):
    w = natural_frequencies(bar, 60)
    below, above = bar.wave_speed(np.array([0.0, bar.length]))
    theta, phi = w * bar.interface / below, w * (bar.length - bar.interface) / above
    # tan(phi) tan(theta) = c_t/c_b, without the poles
    residual = np.sin(phi) * np.sin(theta) * below - np.cos(phi) * np.cos(theta) * above
    np.testing.assert_allclose(residual, 0.0, atol=1e-8 * above)
    fine = np.linspace(1.0, w[-1] * 1.0001, 400_000)
    theta, phi = fine * bar.interface / below, fine * (bar.length - bar.interface) / above
    residual = np.sin(phi) * np.sin(theta) * below - np.cos(phi) * np.cos(theta) * above
    assert np.count_nonzero(np.diff(np.sign(residual))) == 60


@ORDERS
def test_frequencies_are_those_of_a_finite_element_eigenproblem(bar):
    nodes, mass, G = assemble_bar(bar, 360)
    lengths = np.diff(nodes)
    lam, mu = bar.lame(nodes[:-1] + 0.5 * lengths)
    stiffness = G.T @ np.diag((lam + 2 * mu) / lengths) @ G
    root = 1.0 / np.sqrt(mass[:-1])
    squares = np.linalg.eigvalsh(root[:, None] * stiffness[:-1, :-1] * root)
    np.testing.assert_allclose(np.sqrt(squares[:8]), natural_frequencies(bar, 8), rtol=1e-3)


@ORDERS
def test_modal_solution_starts_at_rest_and_is_continuous(bar):
    modal = ModalBar(bar)
    x = np.linspace(0.0, bar.length, 37)
    assert np.abs(modal.displacement(x, np.array([0.0]))).max() < 1e-7
    assert np.abs(modal.stress(x, np.array([0.0]))).max() < 300.0  # Gibbs, of 1e5 Pa
    times = np.array([0.05, 0.14, 0.31])
    sides = bar.interface + np.array([-1e-9, 1e-9])
    for field in (modal.displacement, modal.stress):
        low, high = field(sides, times).T
        np.testing.assert_allclose(low, high, rtol=1e-6)
    assert np.abs(modal.displacement(np.array([bar.length]), times)).max() < 1e-12


@ORDERS
def test_finite_elements_and_modes_agree_under_a_tiny_load(bar):
    """Both solve the same small-strain problem, by nothing in common.

    Symplectic Euler kicks by a whole step at the start: it runs half a step ahead.
    """
    light, step = replace(bar, gravity=-1e-3), 1e-4
    run = fem_bar(light, end=0.5, step=step, elements=360, every=10)
    modal, times = ModalBar(light), run.times + 0.5 * step
    tip = modal.displacement(np.array([0.25]), times)[:, 0]
    assert np.linalg.norm(run.at(0.25) - tip) < 5e-5 * np.linalg.norm(tip)
    stress = modal.stress(run.centres, times)
    assert np.linalg.norm(run.stress - stress) < 2e-3 * np.linalg.norm(stress)


def test_finite_elements_converge_to_the_modes():
    light = replace(ABOVE, gravity=-1e-3)
    modal = ModalBar(light)
    errors = []
    for elements in (18, 54, 162):
        run = fem_bar(light, end=0.4, step=2e-5, elements=elements, every=50)
        tip = modal.displacement(np.array([0.0]), run.times + 1e-5)[:, 0]
        errors.append(np.linalg.norm(run.at(0.0) - tip) / np.linalg.norm(tip))
    orders = np.log(np.array(errors[:-1]) / errors[1:]) / np.log(3.0)
    assert (orders > 1.2).all(), (errors, orders)


def test_assembled_operators_are_those_of_linear_elements():
    nodes, mass, G = assemble_bar(ABOVE, 18)
    np.testing.assert_allclose(nodes, np.linspace(0.0, 9.0, 19))
    np.testing.assert_allclose(mass, 1050.0 * 0.5 * np.r_[0.5, np.ones(17), 0.5])
    expected = np.eye(18, 19, 1) - np.eye(18, 19)
    np.testing.assert_allclose(G, expected, atol=1e-13)


def test_finite_strain_stress_of_one_step_by_hand():
    run = fem_bar(ABOVE, end=1e-3, step=1e-3, elements=2, every=1)
    # Free fall of the two free nodes, v = g dt and u = g dt^2; only the upper element stretches.
    fall = -10.0 * 1e-6
    np.testing.assert_allclose(run.displacement[1], [fall, fall, 0.0])
    F = 1.0 - fall / 4.5
    lam, mu = 1e7 * 0.3 / (1.3 * 0.4), 1e7 / 2.6
    np.testing.assert_allclose(run.stress[1], [0.0, lam * np.log(F) / F + mu * (F - 1 / F)], atol=1e-9)


def test_history_interpolates_and_finds_profiles():
    run = fem_bar(ABOVE, end=0.02, step=5e-5, every=10)
    assert run.times[0] == 0.0
    assert run.times[-1] == pytest.approx(0.02)
    np.testing.assert_allclose(run.at(0.25), 0.5 * (run.displacement[:, 0] + run.displacement[:, 1]))
    np.testing.assert_allclose(run.at(9.0), 0.0)
    np.testing.assert_array_equal(run.profile(0.0101), run.stress[20])


@pytest.mark.parametrize(
    ("change", "word"),
    [
        ({"length": -1.0}, "length"),
        ({"upper": 0.0}, "upper"),
        ({"density": float("nan")}, "density"),
        ({"interface": 9.0}, "interface"),
        ({"poisson": 0.5}, "poisson"),
        ({"gravity": float("inf")}, "gravity"),
    ],
)
def test_bad_bars_are_refused(change, word):
    with pytest.raises(InputError, match=word):
        replace(ABOVE, **change)


@pytest.mark.parametrize(
    ("choices", "word"),
    [
        ({"elements": 17}, "interface"),
        ({"step": 0.1}, "at most"),
        ({"step": -1.0}, "positive"),
        ({"end": 0.0}, "one step"),
        ({"every": 0}, "every"),
    ],
)
def test_bad_finite_element_runs_are_refused(choices, word):
    with pytest.raises(InputError, match=word):
        fem_bar(ABOVE, **{"end": 0.1, "step": 5e-5, **choices})


def test_no_modes_are_refused():
    with pytest.raises(InputError, match="0 modes"):
        natural_frequencies(ABOVE, 0)

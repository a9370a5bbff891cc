"""The elastica: known figures, the linear limit, and the differential equation."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_bvp

from matpoint.errors import InputError
from matpoint.reference.elastica import Elastica


@pytest.mark.parametrize(
    ("number", "w", "u"), [(1, 0.30172, 0.05643), (2, 0.49346, 0.16064), (10, 0.81061, 0.55500)]
)
def test_tip_is_that_of_the_tables(number, w, u):
    """Mattiasson 1981, scaled: length 2 and stiffness 3."""
    bar = Elastica(2.0, 3.0, number * 3.0 / 4.0)
    assert bar.number == pytest.approx(number)
    np.testing.assert_allclose(np.array(bar.tip()) / 2.0, [w, u], atol=6e-6)


def test_a_small_load_gives_the_linear_deflection():
    w, u = Elastica(2.0, 3.0, 1e-3).tip()
    assert w == pytest.approx(1e-3 * 8 / (3 * 3.0), rel=1e-6)
    assert 0 < u < 1e-3 * w


@pytest.mark.parametrize("number", [0.5, 10.0, 60.0])
def test_shape_solves_the_equation(number):
    def slopes(s, y):
        return np.stack([y[1], -number * np.cos(y[0]), np.cos(y[0]), np.sin(y[0])])

    def ends(a, b):
        return np.array([a[0], b[1], a[2], a[3]])

    s = np.linspace(0.0, 1.0, 201)
    guess = np.stack([1.5 * s, 1 - s, s, s])
    solution = solve_bvp(slopes, ends, s, guess, tol=1e-9, max_nodes=20_000)
    assert solution.success
    bar = Elastica(1.0, 1.0, number)
    np.testing.assert_allclose(bar.shape(s).T, solution.sol(s)[2:], atol=1e-7)
    assert bar.tip_angle == pytest.approx(solution.sol(1.0)[0], abs=1e-7)
    steps = np.linalg.norm(np.diff(bar.shape(np.linspace(0, 1, 20_001)), axis=0), axis=1)
    assert steps.sum() == pytest.approx(1.0, abs=1e-6)  # inextensible


@pytest.mark.parametrize(
    ("change", "word"),
    [
        ({"length": 0.0}, "length"),
        ({"stiffness": np.inf}, "stiffness"),
        ({"load": -1.0}, "load"),
        ({"load": 101.0}, "100"),
    ],
)
def test_bad_bars_are_refused(change, word):
    with pytest.raises(InputError, match=word):
        Elastica(**{"length": 1.0, "stiffness": 1.0, "load": 1.0, **change})


def test_bad_arc_lengths_are_refused():
    with pytest.raises(InputError, match="arc"):
        Elastica(1.0, 1.0, 1.0).shape(np.array([1.1]))

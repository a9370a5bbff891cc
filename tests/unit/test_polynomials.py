"""Orthogonal polynomials of a few particles, as figures 1 to 3 of the IMLS paper draw them."""

from __future__ import annotations

import numpy as np
import pytest

from matpoint.reproduce.polynomials import SETS, polynomials, weights


@pytest.mark.parametrize("name", SETS)
def test_polynomials_are_orthogonal_over_the_particles(name):
    points = np.array(SETS[name][0])
    coefficients, norms = polynomials(points)
    values = coefficients @ points ** np.arange(3)[:, None]
    gram = (values * weights(points)) @ values.T
    scale = np.sqrt(np.outer(np.diag(gram), np.diag(gram))) + 1e-14
    assert (np.abs(gram - np.diag(np.diag(gram))) < 1e-10 * scale + 1e-16).all()
    assert norms == pytest.approx(np.diag(gram), abs=1e-14)


@pytest.mark.parametrize("name", SETS)
def test_polynomials_keep_their_leading_monomial(name):
    """Gram-Schmidt takes lower ones off only: T 16."""
    coefficients, _ = polynomials(np.array(SETS[name][0]))
    assert np.diag(coefficients) == pytest.approx(1.0)
    assert np.triu(coefficients, 1) == pytest.approx(0.0)


def test_the_third_vanishes_at_two_particles():
    """x^2 - 1/4 for particles at -1/2 and 1/2."""
    coefficients, norms = polynomials(np.array([-0.5, 0.5]))
    assert coefficients[2] == pytest.approx([-0.25, 0.0, 1.0])
    assert norms[2] == 0.0
    assert (norms[:2] > 0.0).all()


def test_three_symmetric_particles_by_hand():
    """Weights 1/8, 3/4, 1/8 at -2/3, 0, 2/3: p3 = x^2 - <x^2, 1>/<1, 1> = x^2 - 1/9."""
    coefficients, norms = polynomials(np.array([-2 / 3, 0.0, 2 / 3]))
    assert coefficients[2] == pytest.approx([-1 / 9, 0.0, 1.0], abs=1e-14)
    assert norms == pytest.approx([1.0, 1 / 9, 4 / 81 - 1 / 81])


def test_the_weight_ends_with_the_interval():
    assert weights(np.array([-1.0, 0.0, 1.0])) == pytest.approx([0.0, 0.75, 0.0])

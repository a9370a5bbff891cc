"""The sphere in a matrix: Eshelby's tensor, equilibrium, and the bond."""

from __future__ import annotations

import numpy as np
import pytest
from eshelby import PAIRS, ball, gradient, hooke, inside, tensor

from matpoint.errors import InputError
from matpoint.reference.sphere import Sphere

STRAIN = (1e-3, -2e-3, 0.4e-3, 0.7e-3, 0.1e-3, -0.5e-3)
SPHERE = Sphere(1.3, (10.0, 2.0), (0.2, 0.35), STRAIN)
DIRECTIONS = np.random.default_rng(0).standard_normal((15, 3))
DIRECTIONS /= np.linalg.norm(DIRECTIONS, axis=1)[:, None]


@pytest.mark.parametrize("strain", [STRAIN, (1e-3,) * 3 + (0.0,) * 3, (0.0,) * 3 + (1e-3, 0.0, 0.0)])
@pytest.mark.parametrize(("young", "nu"), [(10.0, 0.2), (1e-3, 0.45), (2.0, 0.35)])
def test_stress_inside_is_that_of_eshelby(strain, young, nu):
    sphere = Sphere(1.3, (young, 2.0), (nu, 0.35), strain)
    x = np.array([[0.0, 0, 0], [0.3, -0.4, 0.9], [-1.3, 0, 0]])
    there, stress = inside(ball(0.35), hooke(young, nu), hooke(2.0, 0.35), np.array(strain))
    np.testing.assert_allclose(sphere.stress(x), np.tile(stress, (3, 1)), atol=1e-15)
    np.testing.assert_allclose(sphere.displacement(x), x @ tensor(there), atol=1e-15)


@pytest.mark.parametrize("side", ["soft", "stiff"])
def test_the_bond_holds(side):
    sphere = SPHERE if side == "stiff" else Sphere(1.3, (0.1, 2.0), (0.4, 0.1), STRAIN)
    x = 1.3 * DIRECTIONS
    both = [tensor(sphere.stress(x, s)) for s in ("inner", "outer")]
    pulls = [np.einsum("nij,nj->ni", s, DIRECTIONS) for s in both]
    np.testing.assert_allclose(*pulls, atol=1e-13 * np.abs(both).max())
    assert np.abs(both[0] - both[1]).max() > 0.1 * np.abs(both).max()
    ends = [sphere.displacement(x * (1 + e)) for e in (-1e-9, 1e-9)]
    np.testing.assert_allclose(*ends, atol=1e-10)


@pytest.mark.parametrize("radius", [0.7, 1.5, 4.0])
def test_the_field_is_in_equilibrium_and_obeys_hooke(radius):
    x = radius * DIRECTIONS
    H = gradient(SPHERE.displacement, x, 3)
    strain = 0.5 * (H + np.swapaxes(H, 1, 2))
    flat = np.stack([strain[:, i, j] for i, j in PAIRS], axis=1)
    stress = flat @ (hooke(10.0, 0.2) if radius < 1.3 else hooke(2.0, 0.35))
    np.testing.assert_allclose(SPHERE.stress(x), stress, atol=1e-8 * np.abs(stress).max())
    residual = np.einsum("nijj->ni", gradient(lambda y: tensor(SPHERE.stress(y)), x, 3))
    assert np.abs(residual).max() < 1e-7 * np.abs(stress).max()


def test_strain_far_away_is_the_given_one():
    stress = hooke(2.0, 0.35) @ np.array(STRAIN)
    np.testing.assert_allclose(SPHERE.stress(1e4 * DIRECTIONS), np.tile(stress, (15, 1)), atol=1e-12)


def test_no_contrast_leaves_the_uniform_strain():
    same, x = Sphere(1.0, (3.0, 3.0), (0.3, 0.3), STRAIN), 2 * DIRECTIONS
    np.testing.assert_allclose(same.displacement(x), x @ tensor(np.array(STRAIN)), atol=1e-15)
    assert same.concentration() == (1.0, 1.0)


@pytest.mark.parametrize(
    ("change", "word"),
    [
        ({"radius": 0.0}, "radius"),
        ({"youngs": (1.0,)}, "youngs"),
        ({"youngs": (1.0, -1.0)}, "positive"),
        ({"poissons": (-1.0, 0.3)}, "poissons"),
        ({"strain": (0.0,) * 3}, "6 finite"),
    ],
)
def test_bad_spheres_are_refused(change, word):
    good = {"radius": 1.0, "youngs": (1.0, 1.0), "poissons": (0.3, 0.3), "strain": STRAIN}
    with pytest.raises(InputError, match=word):
        Sphere(**{**good, **change})


def test_bad_points_are_refused():
    with pytest.raises(InputError, match="shape"):
        SPHERE.stress(np.zeros(2))
    with pytest.raises(InputError, match="side"):
        SPHERE.stress(np.zeros(3), "left")

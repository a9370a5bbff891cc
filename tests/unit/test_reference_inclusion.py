"""The coated disc: Eshelby's tensor, equilibrium, and bonds."""

from __future__ import annotations

import numpy as np
import pytest
from eshelby import cylinder, gradient, hooke, inside, tensor

from matpoint.errors import InputError
from matpoint.reference.inclusion import Inclusion

STRAIN = (1e-3, -2e-3, 0.7e-3)
COATED = Inclusion((1.0, 1.2, 1.5), (10.0, 0.1, 3.0, 1.0), (0.2, 0.35, 0.1, 0.4), STRAIN)
DIRECTIONS = np.stack([np.cos(np.linspace(0, 6, 13)), np.sin(np.linspace(0, 6, 13))], axis=1)


@pytest.mark.parametrize("strain", [STRAIN, (1e-3, 1e-3, 0.0), (0.0, 0.0, 1e-3), (0.0, 0.0, 0.0)])
@pytest.mark.parametrize(("young", "nu"), [(10.0, 0.2), (1e-3, 0.45), (2.0, 0.35)])
def test_stress_inside_a_disc_is_that_of_eshelby(strain, young, nu):
    disc = Inclusion((1.5,), (young, 2.0), (nu, 0.35), strain)
    x = np.array([[0.0, 0.0, 0.0], [0.3, -0.4, 0.0], [1.2, 0.8, 0.0], [-1.5, 0.0, 0.0]])
    full = np.array([strain[0], strain[1], 0, strain[2], 0, 0])
    there, stress = inside(cylinder(0.35), hooke(young, nu), hooke(2.0, 0.35), full)
    np.testing.assert_allclose(disc.stress(x), np.tile(stress, (4, 1)), atol=1e-15)
    np.testing.assert_allclose(disc.displacement(x), (x @ tensor(there))[:, :2], atol=1e-15)


def test_no_contrast_leaves_the_uniform_strain():
    same = Inclusion((1.0, 2.0), (3.0,) * 3, (0.3,) * 3, STRAIN)
    x = np.random.default_rng(0).uniform(-4, 4, (20, 2))
    xx, yy, xy = STRAIN
    np.testing.assert_allclose(same.displacement(x), x @ np.array([[xx, xy], [xy, yy]]), atol=1e-14)
    stress = hooke(3.0, 0.3) @ np.array([xx, yy, 0, xy, 0, 0])
    np.testing.assert_allclose(same.stress(x), np.tile(stress, (20, 1)), atol=1e-14)


@pytest.mark.parametrize("radius", [0.6, 1.1, 1.35, 2.0, 9.0])
def test_every_layer_is_in_equilibrium_and_obeys_hooke(radius):
    x = radius * DIRECTIONS
    layer = int(np.searchsorted(COATED.radii, radius))
    strain = np.zeros((len(x), 3, 3))
    H = gradient(COATED.displacement, x, 2)
    strain[:, :2, :2] = 0.5 * (H + np.swapaxes(H, 1, 2))
    flat = np.stack(
        [strain[:, 0, 0], strain[:, 1, 1], 0 * x[:, 0], strain[:, 0, 1], 0 * x[:, 0], 0 * x[:, 0]], 1
    )
    stress = flat @ hooke(COATED.youngs[layer], COATED.poissons[layer])
    np.testing.assert_allclose(COATED.stress(x), stress, atol=1e-8 * np.abs(stress).max())
    slopes = gradient(lambda y: tensor(COATED.stress(y))[:, :2, :2], x, 2)
    residual = np.einsum("nijj->ni", slopes)
    assert np.abs(residual).max() < 1e-7 * np.abs(COATED.stress(x)).max()


@pytest.mark.parametrize("radius", COATED.radii)
def test_layers_are_bonded(radius):
    x = radius * DIRECTIONS
    sides = [tensor(COATED.stress(x, side))[:, :2, :2] for side in ("inner", "outer")]
    pulls = [np.einsum("nij,nj->ni", s, DIRECTIONS) for s in sides]
    np.testing.assert_allclose(*pulls, atol=1e-12 * np.abs(sides[0]).max())
    assert np.abs(sides[0] - sides[1]).max() > 0.1 * np.abs(sides[0]).max()
    ends = [COATED.displacement(x * (1 + e)) for e in (-1e-9, 1e-9)]
    np.testing.assert_allclose(*ends, atol=1e-10)


def test_strain_far_away_is_the_given_one():
    x = 1e4 * DIRECTIONS
    stress = hooke(1.0, 0.4) @ np.array([STRAIN[0], STRAIN[1], 0, STRAIN[2], 0, 0])
    np.testing.assert_allclose(COATED.stress(x), np.tile(stress, (len(x), 1)), atol=1e-10)


def test_a_coating_like_the_disc_is_part_of_it():
    thick = Inclusion((1.0, 1.5), (5.0, 5.0, 1.0), (0.3, 0.3, 0.2), STRAIN)
    disc = Inclusion((1.5,), (5.0, 1.0), (0.3, 0.2), STRAIN)
    x = np.random.default_rng(2).uniform(-3, 3, (30, 2))
    np.testing.assert_allclose(thick.stress(x), disc.stress(x), atol=1e-14)
    np.testing.assert_allclose(thick.displacement(x), disc.displacement(x), atol=1e-14)


@pytest.mark.parametrize(
    ("change", "word"),
    [
        ({"radii": ()}, "radii"),
        ({"radii": (2.0, 1.0), "youngs": (1.0,) * 3, "poissons": (0.3,) * 3}, "increasing"),
        ({"radii": (-1.0,)}, "positive"),
        ({"youngs": (1.0,)}, "2 finite"),
        ({"youngs": (1.0, 0.0)}, "youngs"),
        ({"poissons": (0.3, 0.5)}, "poissons"),
        ({"strain": (1.0, float("nan"), 0.0)}, "strain"),
    ],
)
def test_bad_inclusions_are_refused(change, word):
    good = {"radii": (1.0,), "youngs": (1.0, 1.0), "poissons": (0.3, 0.3), "strain": STRAIN}
    with pytest.raises(InputError, match=word):
        Inclusion(**{**good, **change})


def test_bad_points_are_refused():
    with pytest.raises(InputError, match="shape"):
        COATED.displacement(np.zeros(4))
    with pytest.raises(InputError, match="side"):
        COATED.stress(np.zeros(2), "left")

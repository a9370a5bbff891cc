"""Effective moduli of a laminate whose layers are thinner than a cell."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from matpoint.errors import InputError
from matpoint.problems import Laminate
from matpoint.reference.laminate import Layers


@cache
def norms(offset: float) -> dict[str, dict[str, float]]:
    return Laminate(offset=offset).verify()


@pytest.mark.parametrize("offset", [0.0, 0.3])
def test_enriched_moduli_are_exact_where_cpdi2_is_far_off(offset):
    """Measured: 1.8e-4 (finite strain: fem has it too) against 3.3, that is 4.3 times too stiff."""
    result = norms(offset)
    for load in ("normal", "shear"):
        assert result["enriched-cpdi2"][load] < 5e-4
        assert result["cpdi2"][load] > 2.0
    # Along the layers strain is uniform: everything sees it.
    assert all(values["in_plane"] < 2e-4 for values in result.values())
    assert all(value < 5e-4 for value in result["fem"].values())


@pytest.mark.slow
def test_two_domains_a_layer_with_their_middle_vertices_enriched():
    result = Laminate(per_layer=2).verify(["enriched-cpdi2"])["enriched-cpdi2"]
    assert max(result.values()) < 5e-4


def test_figures(tmp_path):
    Laminate().verify(["enriched-cpdi2", "fem"], out=tmp_path)
    assert {p.name for p in tmp_path.glob("*.png")} == {"figure-profiles.png", "figure-moduli.png"}


def test_layers_of_one_material_are_that_material():
    layers = Layers((0.2, 0.5, 0.3), (2e6,) * 3, 0.25)
    lam = mu = 8e5  # nu = 1/4: lambda = mu = E / 2.5
    assert layers.normal == pytest.approx(lam + 2 * mu)
    assert layers.shear == pytest.approx(mu)
    assert layers.in_plane == pytest.approx(4 * mu * (lam + mu) / (lam + 2 * mu))
    assert layers.modulus("shear") == layers.shear


@pytest.mark.parametrize("load", ["normal", "shear", "in_plane"])
def test_strains_of_layers_average_to_the_mean(load):
    layers = Layers((0.1, 0.4, 0.5), (1e6, 3e7, 2e5), 0.3)
    assert np.average(layers.strains(load, 1e-3), weights=layers.thickness) == pytest.approx(1e-3)
    assert Layers((1.0, 1.0), (1e6, 1e8), 0.3).normal == pytest.approx(1e6 * 0.7 / 0.52 * 2 / 1.01)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Laminate(load="twist"), "load"),
        (lambda: Laminate(contrast=0.0), "contrast"),
        (lambda: Laminate(offset=1.0), "offset"),
        (lambda: Laminate(per_layer=0), "per_layer"),
        (lambda: Layers((), (), 0.3), "as many"),
        (lambda: Layers((1.0,), (-1.0,), 0.3), "young"),
        (lambda: Layers((1.0,), (1.0,), 0.5), "poisson"),
    ],
)
def test_what_is_refused(make, message):
    with pytest.raises(InputError, match=message):
        make()

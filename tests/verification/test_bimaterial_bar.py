"""The bi-material bar: what the methods must show, for both orders of the materials."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from matpoint.errors import InputError
from matpoint.interpolation import METHODS
from matpoint.problems import BimaterialBar
from matpoint.problems.bimaterial_bar import Track, measure
from matpoint.reference.modal import ModalBar

ORDERS = pytest.mark.parametrize("stiff", ["above", "below"])


@cache
def track(stiff: str, method: str) -> Track:
    bar = BimaterialBar(stiff)
    return bar.reference() if method == "fem" else bar.track(METHODS[method])


@cache
def norms(stiff: str, method: str) -> dict[str, float]:
    return measure(track(stiff, method), track(stiff, "fem"))


def fitted_period(times: np.ndarray, tip: np.ndarray, modal: ModalBar) -> float:
    """The period [s] with which the modes' spectrum, stretched as a whole, fits a history best."""

    def residual(scale: float) -> float:
        basis = np.cos(np.outer(times, scale * modal.frequencies[:4]))
        basis = np.column_stack([np.ones(len(times)), basis])
        rest = tip - basis @ np.linalg.lstsq(basis, tip, rcond=None)[0]
        return float(rest @ rest)

    return modal.period / float(minimize_scalar(residual, bounds=(0.9, 1.1), method="bounded").x)  # type: ignore[union-attr]


@ORDERS
def test_enrichment_removes_the_jump(stiff):
    enriched, plain = norms(stiff, "enriched-cpdi2"), norms(stiff, "cpdi2")
    assert enriched["jump"] <= 0.06
    assert enriched["sigma_b"] <= 0.07
    assert enriched["sigma_c"] <= 0.07
    assert plain["jump"] >= 0.3
    assert norms(stiff, "fem")["jump"] == pytest.approx(0.057, abs=0.001)


@pytest.mark.parametrize(
    ("stiff", "method", "figures"),
    [
        ("above", "cpdi2", (0.255, 0.308, 0.345)),
        ("above", "enriched-cpdi2", (0.0505, 0.0620, 0.0556)),
        ("below", "cpdi2", (0.333, 0.429, 0.338)),
        ("below", "enriched-cpdi2", (0.0551, 0.0635, 0.0560)),
    ],
)
def test_figures_stay_where_they_were_measured(stiff, method, figures):
    """B lies above the interface and C below: so the published prototypes' figures come out."""
    found = norms(stiff, method)
    assert (found["sigma_b"], found["sigma_c"], found["jump"]) == pytest.approx(figures, rel=5e-3)


@ORDERS
@pytest.mark.parametrize("method", ["enriched-cpdi2", "cpdi2", "fem"])
def test_period_and_largest_displacement_are_the_modal_ones(stiff, method):
    run, modal = track(stiff, method), ModalBar(BimaterialBar(stiff).bar)
    exact = modal.displacement(run.centres[:1], run.times)[:, 0]
    assert fitted_period(run.times, exact, modal) == pytest.approx(modal.period, rel=1e-3)
    assert fitted_period(run.times, run.tip, modal) == pytest.approx(modal.period, rel=0.02)
    assert run.tip.min() == pytest.approx(exact.min(), rel=0.02)


@ORDERS
def test_cpdi1_is_cpdi2_in_one_dimension(stiff):
    one, two = track(stiff, "cpdi1"), track(stiff, "cpdi2")
    np.testing.assert_allclose(one.stress, two.stress, atol=1e-10 * np.abs(two.stress).max())
    np.testing.assert_allclose(one.tip, two.tip, atol=1e-10 * np.abs(two.tip).max())


@pytest.mark.slow
@ORDERS
@pytest.mark.parametrize("dim", [2, 3])
def test_quads_and_hexes_between_rollers_are_the_line(stiff, dim):
    flat = track(stiff, "enriched-cpdi2")
    solid = BimaterialBar(stiff, dim).track(METHODS["enriched-cpdi2"])
    np.testing.assert_allclose(solid.tip, flat.tip, atol=1e-9 * np.abs(flat.tip).max())
    np.testing.assert_allclose(solid.stress, flat.stress, atol=1e-9 * np.abs(flat.stress).max())


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("method", [name for name in METHODS if name != "enriched-cpdi2"])
def test_every_method_gives_the_line_in_two_and_three_dimensions(method, dim):
    bar = BimaterialBar("below")
    line = bar.track(METHODS[method], end=0.02)
    solid = BimaterialBar("below", dim).track(METHODS[method], end=0.02)
    np.testing.assert_allclose(solid.stress, line.stress, atol=1e-9 * np.abs(line.stress).max())


def test_verify_measures_and_draws(tmp_path):
    bar, seen = BimaterialBar("below"), []
    result = bar.verify(["fem"], tmp_path, lambda name, number, count: seen.append((name, number, count)))
    assert seen == [("fem", 0, 1)]
    assert list(result) == ["fem"]
    assert list(result["fem"]) == ["tip", "sigma_b", "sigma_c", "jump"]
    assert result["fem"]["sigma_b"] == 0.0
    assert len(list(tmp_path.glob("figure-*.png"))) == 3
    lines = bar.table(result).splitlines()
    assert lines[0].split() == ["method", "tip", "sigma_b", "sigma_c", "jump"]
    assert lines[2].split()[0] == "fem"


@pytest.mark.parametrize("choices", [{"stiff": "left"}, {"dim": 4}, {"dim": True}])
def test_bad_choices_are_refused(choices):
    with pytest.raises(InputError, match="allowed"):
        BimaterialBar(**choices)


@pytest.mark.parametrize("methods", [[], ["cpdi3"]])
def test_bad_methods_are_refused(methods):
    with pytest.raises(InputError, match="method"):
        BimaterialBar().verify(methods)

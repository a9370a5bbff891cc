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
@pytest.mark.parametrize("method", ["fem", *METHODS])
def test_period_and_largest_displacement_are_the_modal_ones(stiff, method):
    run, modal = track(stiff, method), ModalBar(BimaterialBar(stiff).bar)
    exact = modal.displacement(run.centres[:1], run.times)[:, 0]
    assert fitted_period(run.times, exact, modal) == pytest.approx(modal.period, rel=1e-3)
    assert run.tip.min() == pytest.approx(exact.min(), rel=0.02)
    if (stiff, method) == ("below", "bspline3"):
        # Large strain lengthens the period by 1 % (so does the finest finite-element run), and lumped
        # mass with FLIP by (degree + 1)/12 (k h)^2 = 1.1 % more: an error of the grid, gone on a finer one.
        run = BimaterialBar(stiff, refine=2).track(METHODS[method])
    assert fitted_period(run.times, run.tip, modal) == pytest.approx(modal.period, rel=0.02)


@ORDERS
def test_only_enrichment_removes_the_jump_by_refinement(stiff):
    """With the interface in the middle of a cell of a third of the size, CPDI2 is hardly better."""
    fine = BimaterialBar(stiff, refine=3)
    fem = fine.reference()
    plain, enriched = (measure(fine.track(METHODS[name]), fem) for name in ("cpdi2", "enriched-cpdi2"))
    assert plain["jump"] > 0.85 * norms(stiff, "cpdi2")["jump"]
    for name in ("jump", "sigma_b", "sigma_c", "tip"):
        assert enriched[name] < 0.55 * norms(stiff, "enriched-cpdi2")[name]


def test_interface_on_a_grid_line_needs_no_enrichment():
    split = BimaterialBar(refine=2)
    assert measure(split.track(METHODS["cpdi2"]), split.reference())["jump"] < 0.1


@ORDERS
def test_cpdi1_is_cpdi2_in_one_dimension(stiff):
    one, two = track(stiff, "cpdi1"), track(stiff, "cpdi2")
    np.testing.assert_allclose(one.stress, two.stress, atol=1e-10 * np.abs(two.stress).max())
    np.testing.assert_allclose(one.tip, two.tip, atol=1e-10 * np.abs(two.tip).max())


@ORDERS
@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("method", ["cpdi2", "enriched-cpdi2"])
def test_quads_and_hexes_between_rollers_are_the_line(stiff, dim, method):
    line = track(stiff, method)
    solid = BimaterialBar(stiff, dim).track(METHODS[method])
    np.testing.assert_allclose(solid.tip, line.tip, atol=1e-9 * np.abs(line.tip).max())
    np.testing.assert_allclose(solid.stress, line.stress, atol=1e-9 * np.abs(line.stress).max())


# Not bspline3: one particle does not hold the four cubic splines across a cell. The walls hold two
# of them, and the lateral stress pushes the other two apart.
@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("method", ["mpm", "ugimp", "cpgimp", "bspline2", "cpdi1"])
def test_every_method_gives_the_line_in_two_and_three_dimensions(method, dim):
    line = BimaterialBar("below").track(METHODS[method], end=0.1)
    solid = BimaterialBar("below", dim).track(METHODS[method], end=0.1)
    np.testing.assert_allclose(solid.tip, line.tip, atol=1e-9 * np.abs(line.tip).max())
    np.testing.assert_allclose(solid.stress, line.stress, atol=1e-9 * np.abs(line.stress).max())


@pytest.mark.parametrize("dim", [1, 2, 3])
def test_probes_find_their_particles(dim):
    bar = BimaterialBar(dim=dim)
    sim = bar.simulation(METHODS["cpdi2"], threads=1)
    found = [sim.particles.position0[probe.find(sim), 0] for probe in bar.probes]
    np.testing.assert_allclose(found, [0.25, 4.75, 4.25])


def test_verify_measures_and_draws(tmp_path):
    bar, seen = BimaterialBar("below"), []
    names = ["enriched-cpdi2", "fem"]
    result = bar.verify(names, tmp_path, lambda name, number, count: seen.append((name, number, count)))
    assert seen == [("enriched-cpdi2", 0, 2), ("fem", 1, 2)]
    assert list(result) == names
    assert result["enriched-cpdi2"] == norms("below", "enriched-cpdi2")
    assert list(result["fem"]) == ["tip", "sigma_b", "sigma_c", "jump"]
    assert result["fem"]["tip"] == result["fem"]["sigma_b"] == result["fem"]["sigma_c"] == 0.0
    assert len(list(tmp_path.glob("figure-*.png"))) == 3
    with (tmp_path / "histories.csv").open(encoding="utf-8") as file:
        header = file.readline().strip().split(",")
        rows = np.loadtxt(file, delimiter=",")
    assert header[:3] == ["time [s]", "enriched-cpdi2 tip [m]", "enriched-cpdi2 sigma_B [Pa]"]
    np.testing.assert_array_equal(rows[:, 1], track("below", "enriched-cpdi2").tip)
    lines = bar.table(result).splitlines()
    assert lines[0].split() == ["method", *bar.norms]
    assert [line.split()[0] for line in lines[2:4]] == names


def test_figures_are_drawn_for_the_reference_alone(tmp_path):
    assert list(BimaterialBar().verify(["fem"], tmp_path)) == ["fem"]
    assert len(list(tmp_path.glob("figure-*.png"))) == 3


@pytest.mark.parametrize("choices", [{"stiff": "left"}, {"dim": 4}, {"dim": True}, {"dim": 2.0}])
def test_bad_choices_are_refused(choices):
    with pytest.raises(InputError, match="allowed"):
        BimaterialBar(**choices)


@pytest.mark.parametrize("refine", [0, True, 1.5])
def test_bad_refinement_is_refused(refine):
    with pytest.raises(InputError, match="refine"):
        BimaterialBar(refine=refine)


@pytest.mark.parametrize("methods", [[], ["cpdi3"]])
def test_bad_methods_are_refused(methods):
    with pytest.raises(InputError, match="method"):
        BimaterialBar().verify(methods)

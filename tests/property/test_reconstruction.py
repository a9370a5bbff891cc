"""What MLS and IMLS promise, in every dimension, for random particles and odd ones."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import matpoint as mp
from matpoint.interpolation.reconstruction import monomials
from matpoint.kernels.mls import fill_basis, improved_shape, moment_shape
from matpoint.problems import PROBLEMS
from matpoint.threads import Team
from reference.moving_least_squares import polynomial, shape_functions
from support import KIND_OF_DIM, bind, deformed_mesh, gather_field, grid_of, setting_of

METHODS = [
    mp.IMLS(),
    mp.IMLS(mp.BSpline(2), degree=3, velocity_degree=2, points=3, support=2.0),
    mp.MLS(mp.BSpline(3), degree=1),
    mp.SplineIMLS(),
]
CASES = [pytest.param(m, dim, id=f"{m.name}-{k}-{dim}d") for k, m in enumerate(METHODS) for dim in (1, 2, 3)]
SEEDS = st.integers(0, 2**32 - 1)


def filled(choice, dim, seed):
    """A mapping whose particles fill all of the grid, a little out of place."""
    rng = np.random.default_rng(seed)
    grid = grid_of(dim)
    mesh = mp.mesh_box(grid.lower, grid.upper, tuple(3 * c for c in grid.cells))
    setting = setting_of(mesh, rng)
    p = setting.particles
    p.volume[:] = p.volume0
    p.position[:, :dim] += rng.uniform(-0.1, 0.1, (len(p), dim)) * np.array(grid.cell) / 3
    return setting, bind(choice, setting), rng


@pytest.mark.parametrize(("choice", "dim"), CASES)
@settings(max_examples=10)
@given(seed=SEEDS)
def test_the_way_back_reproduces_linear_fields(choice, dim, seed):
    rng = np.random.default_rng(seed)
    setting = setting_of(deformed_mesh(dim, KIND_OF_DIM[dim][0], rng), rng)
    mapping = bind(choice, setting)
    A, b = rng.normal(size=(3, 3)), rng.normal(size=3)
    value, L = gather_field(mapping, setting, mapping.points() @ A.T + b)
    np.testing.assert_allclose(value, setting.particles.position @ A.T + b, atol=1e-10)
    np.testing.assert_allclose(L[:, :, :dim], np.broadcast_to(A[:, :dim], L[:, :, :dim].shape), atol=1e-9)


@pytest.mark.parametrize(("choice", "dim"), CASES)
def test_fields_that_are_polynomials_are_exact_at_gauss_points(choice, dim):
    setting, mapping, rng = filled(choice, dim, 7)
    p, q = setting.particles, mapping.quadrature
    f = polynomial(dim, choice.degree, rng)
    p.stress[:] = f(p.position)[:, None] * np.arange(1, 7)
    p.mass[:] = 3.0 * p.volume
    q.evaluate(p, np.ones((1, 3)))
    assert len(q.cut) == 0
    expected = f(q.position)[:, None] * np.arange(1, 7)
    np.testing.assert_allclose(q.stress, expected, atol=1e-9 * np.abs(expected).max())
    np.testing.assert_allclose(q.mass.sum(), 3.0 * p.volume.sum(), rtol=1e-12)
    np.testing.assert_allclose(q.body, 1.0, rtol=1e-12)
    assert mapping.ranks.min() >= 1


@pytest.mark.parametrize(("choice", "dim"), CASES)
@settings(max_examples=5)
@given(seed=SEEDS)
def test_an_affine_velocity_gives_an_exact_gradient_and_a_constant_stress_no_net_force(choice, dim, seed):
    setting, mapping, rng = filled(choice, dim, seed)
    p, n = setting.particles, mapping.nodes
    A = np.zeros((3, 3))
    A[:dim, :dim] = rng.normal(size=(dim, dim))
    p.velocity[:] = p.position @ A.T
    p.mass[:] = 2.0 * p.volume
    p.stress[:] = rng.normal(size=6)
    n.clear(mapping.team)
    mapping.to_nodes(np.zeros((1, 3)), kinematic=True, dynamic=True)
    scale = np.abs(n.records[:, 4:7]).max()
    np.testing.assert_allclose(n.records[:, 4:7].sum(axis=0), 0.0, atol=1e-11 * scale)
    if mapping.consistent:
        nothing = np.zeros((0, 3))
        held = mp.interpolation.contract.Held(np.zeros(0, np.int64), nothing, np.zeros(0), np.zeros(0))
        n.records[:, 4:7] = 0.0
        mapping.solve(1.0, 0.0, 0.0, held)
    else:
        n.records[:, :3] /= np.maximum(n.records[:, 3:4], 1e-300)
    velocity = n.records[:, :3].copy()
    _, L = gather_field(mapping, setting, velocity)
    if isinstance(choice, mp.IMLS | mp.MLS) and choice.velocity_degree < 1:
        return
    np.testing.assert_allclose(L, np.broadcast_to(A, L.shape), atol=1e-8)


@pytest.mark.parametrize("dim", [1, 2, 3])
def test_imls_is_mls_where_every_matrix_is_regular(dim):
    records = []
    for choice in (mp.IMLS(), mp.MLS(), mp.MLS(raw=True)):
        _, mapping, _ = filled(choice, dim, 3)
        mapping.nodes.clear(mapping.team)
        mapping.to_nodes(np.ones((1, 3)), kinematic=True, dynamic=True)
        records.append(mapping.nodes.records.copy())
        if isinstance(choice, mp.MLS):
            assert mapping.bad_points == 0
            assert 1.0 < mapping.conditions.max() < (1e4 if not choice.raw else 1e13)
    scale = np.abs(records[0]).max(axis=0) + 1e-300
    gap = np.abs(records[1] - records[0]).max(axis=0) / scale
    raw = np.abs(records[2] - records[0]).max(axis=0) / scale
    assert gap.max() < 1e-9
    assert raw.max() > 10 * gap.max()  # textbook monomials lose digits


@pytest.mark.parametrize("degree", [0, 1, 2, 3])
@pytest.mark.parametrize("dim", [1, 2, 3])
def test_shape_functions_against_numpy(dim, degree):
    rng = np.random.default_rng(degree + 10 * dim)
    n = 40
    offset = np.zeros((3, n))
    offset[:dim] = rng.uniform(-1.4, 1.4, (dim, n))
    weight = rng.uniform(0.1, 1.0, n)
    counts, parent, axis = monomials(dim, degree)
    columns = int(counts[-1])
    expected = shape_functions(offset[:dim].T, weight, degree)
    basis, shape = np.empty((columns, n)), np.empty(n)
    fill_basis(n, columns, parent, axis, offset, basis)
    kept = basis.copy()
    rank = improved_shape(n, columns, weight, basis, np.empty(columns), np.empty(columns), 1e-8, shape)
    assert rank == columns
    np.testing.assert_allclose(shape, expected, atol=1e-11)
    value = np.zeros(columns)
    value[0] = 1.0
    moment_shape(n, columns, weight, kept, value, np.empty((columns, columns)), shape)
    np.testing.assert_allclose(shape, expected, atol=1e-10)


def test_particles_on_a_line_lose_the_column_across_it_only():
    """T 17 would drop all that follow; here y goes, x and x^2 stay."""
    offset = np.zeros((3, 5))
    offset[0] = np.linspace(-1.0, 1.0, 5)
    _, parent, axis = monomials(2, 2)
    basis, norm, shape = np.empty((6, 5)), np.empty(6), np.empty(5)
    fill_basis(5, 6, parent, axis, offset, basis)
    rank = improved_shape(5, 6, np.ones(5), basis, np.empty(6), norm, 1e-8, shape)
    assert rank == 3
    np.testing.assert_array_equal(norm > 0, [True, True, False, True, False, False])
    quadratic = 2.0 + 3.0 * offset[0] - offset[0] ** 2
    assert shape @ quadratic == pytest.approx(2.0, abs=1e-12)


@pytest.mark.parametrize("method", [mp.IMLS(), mp.MLS(), mp.SplineIMLS()])
@pytest.mark.parametrize("per_cell", [1, 2])
@pytest.mark.parametrize("dim", [1, 2, 3])
def test_few_particles_free_surfaces_and_empty_cells_run(method, per_cell, dim):
    rubber = mp.NeoHookean(E=1e5, nu=0.3, density=1e3)
    low, high = (0.25,) * dim, (0.8,) * dim
    body = mp.Body(mp.Box(low, high), rubber, per_cell, velocity=(1.0,))
    other = mp.Body(mp.mesh_box((1.1,) * dim, (1.15,) * dim, (1,) * dim), rubber)  # alone in its cell
    sim = mp.Simulation(
        mp.Grid((0.0,) * dim, (1.5,) * dim, 0.25), [body, other],
        interpolation=method, timestep=mp.FixedStep(5e-4), threads=1,
    )  # fmt: skip
    for _ in range(20):
        sim.advance(sim.dt)
    assert np.isfinite(sim.particles.stress).all()
    np.testing.assert_allclose(sim.ledger.start.mass, sim.particles.mass.sum())
    speed = sim.particles.ordered("velocity")[0, 0]
    assert speed == pytest.approx(1.0, abs=0.2)


@pytest.mark.parametrize("choice", METHODS, ids=lambda m: m.name)
def test_the_same_bits_for_any_number_of_threads(choice, monkeypatch):
    monkeypatch.setattr("matpoint.threads._WORTH_IT", 1)  # else such a small run stays on one thread
    results = []
    for threads in (1, 2):
        setting, _, _ = filled(choice, 2, 11)
        setting.team = Team(threads)
        n = len(setting.particles)
        mapping = bind(choice, setting)
        mapping.nodes.clear(mapping.team)
        mapping.to_nodes(np.ones((1, 3)), kinematic=True, dynamic=True)
        results.append(mapping.nodes.records.copy())
        assert n > 100
    np.testing.assert_array_equal(results[0], results[1])


@pytest.mark.parametrize("choice", [mp.IMLS(), mp.TLS(), mp.SplineIMLS()], ids=lambda m: m.name)
def test_a_body_that_crosses_a_large_empty_grid_works_on_the_nodes_around_it(choice):
    rubber, found = mp.NeoHookean(E=1e5, nu=0.3, density=1e3), []
    for low, high in ((0.0, 4.0), (-16.0, 32.0)):
        body = mp.Body(mp.Ball((1.0, 1.0), 0.7), rubber, 3, velocity=(9.0,))
        sim = mp.Simulation(
            mp.Grid((low,) * 2, (high,) * 2, 0.25), [body],
            interpolation=choice, timestep=mp.FixedStep(2e-3), threads=1,
        )  # fmt: skip
        for _ in range(60):
            sim.advance(sim.dt)
        mapping = sim.engine.mapping
        found.append((sim.particles.ordered("position"), mapping.ranks.min(), mapping.grid_mass))
    np.testing.assert_allclose(found[1][0], found[0][0], atol=1e-9)
    assert found[1][1] == found[0][1]
    assert found[1][2] == pytest.approx(found[0][2], rel=1e-9)
    n = mapping.nodes
    assert np.prod(np.subtract(n.last, n.first)) < 200 < n.on_grid / 100
    assert len(mapping.cells.filled) < 200


def test_raw_monomials_far_from_the_origin_are_ill_conditioned():
    """The quantity counts the points where the degree had to be lowered."""
    rubber = mp.NeoHookean(E=1e5, nu=0.3, density=1e3)
    bad = {}
    for raw in (False, True):
        sim = mp.Simulation(
            mp.Grid((1000.0,), (1001.0,), 0.05), [mp.Body(mp.Box((1000.0,), (1001.0,)), rubber, 3)],
            interpolation=mp.MLS(raw=raw, limit=1e10), timestep=mp.FixedStep(1e-4), threads=1,
        )  # fmt: skip
        sim.advance(sim.dt)
        bad[raw] = sim.quantity("bad_points")
    assert bad[False] == 0
    assert bad[True] > 10


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: mp.IMLS(mp.UGIMP()), "basis"),
        (lambda: mp.IMLS(degree=4), "degree"),
        (lambda: mp.IMLS(points=0), "points"),
        (lambda: mp.IMLS(support=0.1), "support"),
        (lambda: mp.IMLS(tolerance=2.0), "tolerance"),
        (lambda: mp.MLS(limit=-1.0), "limit"),
        (lambda: mp.MLS(raw=1), "raw"),
        (lambda: mp.IMLS(reproject="yes"), "reproject"),
        (lambda: mp.SplineIMLS(basis_degree=4), "degree"),
        (lambda: _simulation(mp.IMLS(), mp.USL(mp.APIC())), "APIC"),
        (lambda: _simulation(mp.IMLS(reproject=True), mp.USL()), "reproject"),
    ],
)
def test_what_is_refused(call, message):
    with pytest.raises(mp.InputError, match=message):
        call()


def _simulation(method, scheme):
    rubber = mp.NeoHookean(E=1e5, nu=0.3, density=1e3)
    return mp.Simulation(
        mp.Grid((0.0,), (1.0,), 0.25), [mp.Body(mp.Box((0.0,), (1.0,)), rubber)],
        interpolation=method, scheme=scheme, timestep=mp.FixedStep(1e-4), threads=1,
    )  # fmt: skip


@pytest.mark.parametrize("scheme", [mp.USL(), mp.MUSL(), mp.USL(mp.XPIC(3))])
@pytest.mark.parametrize(
    ("method", "least", "most"),
    [(mp.Linear(), 0.0, 0.0), (mp.TLS(), 0.0, 1e-13), (mp.IMLS(), 1e-6, 1e-2), (mp.MLS(), 1e-6, 1e-2)],
)
def test_the_drift_of_momentum_on_the_grid_is_reported(method, scheme, least, most):
    """Half a wave between walls; a whole one has none, by symmetry, whatever the method."""
    problem = PROBLEMS["mms-1d-half"](cells=16)
    sim = problem.simulation(method, scheme=scheme, threads=1)
    history = []
    for _ in range(200):
        sim.advance(sim.dt)
        history.append(sim.quantity("grid_momentum_error"))
    assert least <= max(history) <= most
    if method.name != "mpm":
        sim.engine.locate(), sim.engine.clear(), sim.engine.gather()
        p, sent = sim.particles, sim.engine.mapping.nodes.records[:, 0].sum()
        scale = p.mass @ np.abs(p.velocity[:, 0])
        expected = abs(sent - p.mass @ p.velocity[:, 0]) / scale
        np.testing.assert_allclose(sim.quantity("grid_momentum_error"), expected, rtol=1e-9, atol=1e-13)


def test_a_body_at_rest_has_no_drift_of_momentum():
    sim = _simulation(mp.IMLS(), None)
    sim.advance(sim.dt)
    assert sim.quantity("grid_momentum_error") == 0.0


def test_spline_imls_reports_its_drift_of_momentum_too():
    problem = PROBLEMS["mms-1d-half"](cells=16)
    sim = problem.simulation(mp.SplineIMLS(), threads=1)
    for _ in range(50):
        sim.advance(sim.dt)
    assert 1e-9 < sim.quantity("grid_momentum_error") < 1e-2


def test_a_mass_that_can_t_be_inverted_ends_the_run_with_its_step(monkeypatch):
    problem = PROBLEMS["mms-1d"](cells=8)
    sim = problem.simulation(mp.SplineIMLS(), threads=1)
    sim.advance(sim.dt)
    monkeypatch.setattr("matpoint.interpolation.consistent._MOST", 1)
    with pytest.raises(mp.RunError, match=r"step 1, .*did not converge"):
        sim.run(problem.end)
    assert "did not converge" in str(problem.track(mp.SplineIMLS(), threads=1).failed)


def test_too_many_particles_around_a_point_end_the_run_with_its_step():
    rubber = mp.NeoHookean(E=1e5, nu=0.3, density=1e3)
    sim = mp.Simulation(
        mp.Grid((0.0,), (1.0,), 0.25), [mp.Body(mp.Box((0.0,), (1.0,)), rubber, per_cell=3000)],
        interpolation=mp.IMLS(), timestep=mp.FixedStep(1e-6), threads=1,
    )  # fmt: skip
    with pytest.raises(mp.RunError, match=r"step 0, .*fewer per cell"):
        sim.advance(sim.dt)


def test_reprojection_is_the_musl_order():
    assert _simulation(mp.IMLS(reproject=True), None).scheme.name == "musl"
    assert _simulation(mp.IMLS(), None).scheme.name == "usl"


@pytest.mark.parametrize(("method", "words"), [(mp.IMLS(), "(T 24-31)"), (mp.SplineIMLS(), "M_ij = sum_g")])
def test_explain_and_ranks_are_those_of_the_method(method, words):
    sim = _simulation(method, None)
    assert words in sim.explain()
    sim.advance(sim.dt)
    assert sim.quantity("smallest_rank") >= 2

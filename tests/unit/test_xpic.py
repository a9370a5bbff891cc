"""XPIC and FMPM against dense matrices, PIC, and what they are for: noise goes, smooth fields stay."""

from __future__ import annotations

import numpy as np
import pytest

import matpoint as mp
from matpoint.case.objects import make_interpolation, make_scheme
from matpoint.case.schema import InterpolationTable, SchemeTable
from matpoint.timestep import stable_step
from reference import weights as reference
from runs import RUBBER, advance, spinning_block, two_blocks

CHOICES = [mp.Linear(), mp.CPGIMP(), mp.BSpline(2), mp.CPDI2(), mp.EnrichedCPDI2(), mp.IMLS(), mp.TLS()]


def _id(value):
    return f"{value.name}-{value.transfer!r}" if isinstance(value, mp.Scheme) else value.name


def _bar(interpolation, cells, velocity, transfer=None, **options):
    """A bar that fills its grid, without stress, at its start."""
    grid = mp.Grid(0.0, 1.0, 1.0 / cells)
    body = mp.Body(mp.Box((0.0,), (1.0,)), RUBBER, 3, velocity=velocity)
    scheme = None if transfer is None else mp.USL(transfer)
    options.setdefault("loads", [mp.Gravity((-9.81,))])
    return mp.Simulation(
        grid,
        [body],
        interpolation=interpolation,
        scheme=scheme,
        timestep=mp.FixedStep(1e-5),
        threads=1,
        **options,
    )


def _dense(name, x, cells):
    """S and its gradient, (particles, nodes), from the definitions of the weights."""
    h, nodes = 1.0 / cells, np.linspace(0.0, 1.0, cells + 1)
    if name == "mpm":
        S = np.array([[reference.hat(a, node, h) for node in nodes] for a in x])
        return S, np.where(S > 0, -np.sign(x[:, None] - nodes) / h, 0.0)
    rows = [reference.spline_weights(a, 0.0, h, cells, 2) for a in x]
    return np.array([r[0] for r in rows]), np.array([r[1] for r in rows])


@pytest.mark.parametrize("kind", ["xpic", "fmpm"])
@pytest.mark.parametrize("interpolation", [mp.Linear(), mp.BSpline(2)], ids=_id)
def test_a_step_is_that_of_dense_matrices(interpolation, kind):
    rng, cells, m, dt = np.random.default_rng(3), 6, 4, 1e-5
    noise = rng.normal(size=3 * cells)
    transfer = mp.XPIC(m) if kind == "xpic" else mp.FMPM(m)
    sim = _bar(
        interpolation,
        cells,
        lambda x: np.sin(5 * x) + noise[np.arange(len(x))][:, None] * [1, 0, 0],
        transfer,
    )
    p = sim.particles
    x, V, W = p.position[:, 0].copy(), p.velocity[:, 0].copy(), np.diag(p.mass)
    S, slope = _dense(interpolation.name, x, cells)
    lumped = S.T @ p.mass
    back = (S / lumped).T @ W  # S+
    a = (S.T @ (p.mass * -9.81)) / lumped
    v, one = back @ V, np.eye(len(lumped))
    series = sum(np.linalg.matrix_power(one - back @ S, j) for j in range(m))
    advance(sim, 1)
    moves = v + a * dt
    if kind == "xpic":
        # V - (1 - S S+)^m V + S a dt, and the alternating sum of binomials of the paper.
        expected = V - np.linalg.matrix_power(np.eye(len(x)) - S @ back, m) @ V + S @ a * dt
        star, total = m * v, m * v
        for r in range(2, m + 1):
            star = (m + 1 - r) / r * back @ S @ star
            total = total + (-1) ** (r + 1) * star
        np.testing.assert_allclose(expected, S @ (total + a * dt), rtol=0, atol=1e-11)
    else:
        moves = series @ moves
        expected = S @ moves
    np.testing.assert_allclose(p.velocity[:, 0], expected, rtol=0, atol=1e-11)
    np.testing.assert_allclose(p.position[:, 0], x + S @ moves * dt, rtol=0, atol=1e-14)
    np.testing.assert_allclose((p.deformation_gradient[:, 0, 0] - 1.0) / dt, slope @ moves, rtol=0, atol=1e-9)


@pytest.mark.parametrize("interpolation", CHOICES, ids=_id)
def test_one_term_is_pic_to_the_last_bit(interpolation):
    dim = 1 if interpolation.name == "imls" else 2
    for order in (mp.USL, mp.USF, mp.MUSL):
        pic = advance(two_blocks(interpolation, dim, scheme=order(mp.PIC())), 20)
        for transfer in (mp.XPIC(1), mp.FMPM(1)):
            other = advance(two_blocks(interpolation, dim, scheme=order(transfer)), 20)
            for name in ("position", "velocity", "stress"):
                np.testing.assert_array_equal(getattr(other.particles, name), getattr(pic.particles, name))


@pytest.mark.parametrize("scheme", [mp.USL(mp.XPIC(3)), mp.USF(mp.XPIC(2)), mp.MUSL(mp.FMPM(3))], ids=_id)
@pytest.mark.parametrize("interpolation", [c for c in CHOICES if c.name not in ("imls", "tls")], ids=_id)
def test_momentum_is_kept_in_a_collision(interpolation, scheme):
    sim = advance(two_blocks(interpolation, scheme=scheme, sample_every=1), 300)
    scale = float(sim.particles.mass @ np.abs(sim.particles.velocity[:, 0]))
    assert sim.ledger.worst["momentum"] < 1e-11 * scale
    assert sim.particles.velocity[sim.particles.body == 0, 0].mean() < 1.9  # they have met


@pytest.mark.parametrize("transfer", [mp.XPIC(4), mp.FMPM(4)])
def test_walls_take_the_momentum_that_the_series_gives_them(transfer):
    wall = [mp.Fixed(mp.Plane("x", 0.0)), mp.PrescribedVelocity(mp.Plane("x", 1.0), (0.3,))]
    sim = _bar(
        mp.BSpline(2), 8, lambda x: np.cos(3 * x) * [1, 0, 0], transfer, boundaries=wall, sample_every=1
    )
    advance(sim, 50)
    assert np.linalg.norm(sim.ledger.latest.impulse) > 1.0
    assert sim.ledger.worst["momentum"] < 1e-10


@pytest.mark.parametrize("transfer", [mp.XPIC(2), mp.XPIC(5), mp.FMPM(2), mp.FMPM(5)])
def test_noise_of_the_null_space_goes_in_one_step(transfer):
    """Velocities with S+ V = 0, from an orthogonal complement: FLIP keeps them for ever."""
    cells = 8
    x = (np.arange(3 * cells) + 0.5) / (3 * cells)
    S, _ = _dense("mpm", x, cells)
    noise = np.linalg.svd(S)[0][:, cells + 1 :] @ np.random.default_rng(1).normal(size=2 * cells - 1)
    assert np.abs(S.T @ noise).max() < 1e-13
    flip = _bar(mp.Linear(), cells, lambda x: noise[:, None] * [1, 0, 0], loads=[])
    advance(flip, 1)
    np.testing.assert_allclose(flip.particles.velocity[:, 0], noise, atol=1e-12)
    sim = _bar(mp.Linear(), cells, lambda x: noise[:, None] * [1, 0, 0], transfer, loads=[])
    advance(sim, 1)
    np.testing.assert_allclose(sim.particles.velocity, 0.0, atol=1e-12)


@pytest.mark.parametrize("interpolation", [mp.Linear(), mp.UGIMP(), mp.BSpline(2), mp.IMLS()], ids=_id)
def test_each_term_lifts_the_order_of_what_is_lost_by_two(interpolation):
    """(1 - S+ S)^m of a smooth field on the nodes, away from the ends, where particles stand evenly."""
    left = {}
    for cells in (32, 64):
        sim = _bar(interpolation, cells, (0.0,))
        sim.engine.locate(), sim.engine.clear(), sim.engine.gather()
        x = sim.engine.mapping.points()
        term = np.sin(4 * x)
        inside = np.abs(x[:, 0] - 0.5) < 0.2
        for m in (1, 2):
            term = term - sim.engine.mapping.round_trip(term)
            left[m, cells] = np.abs(term[inside, 0]).max()
    for m in (1, 2):
        assert np.log2(left[m, 32] / left[m, 64]) > 2 * m - 0.2


def test_noise_on_a_smooth_field_is_damped_and_the_field_is_kept():
    """One step on sin 4x + 0.1 noise: what is left of the noise, and what is lost of the field."""
    noise = 0.1 * np.random.default_rng(5).normal(size=96)
    rest = {}
    for name, transfer in (("flip", mp.FLIP()), ("pic", mp.PIC()), ("x2", mp.XPIC(2)), ("x5", mp.XPIC(5))):
        for key, share in (("noise", 1.0), ("field", 0.0)):
            sim = _bar(
                mp.BSpline(2),
                32,
                lambda x, s=share: np.sin(4 * x) + s * noise[:, None] * [1, 0, 0],
                transfer,
                loads=[],
            )
            x = sim.particles.position[:, 0]
            advance(sim, 1)
            error = (sim.particles.velocity[:, 0] - np.sin(4 * x))[np.abs(x - 0.5) < 0.3]
            rest[name, key] = float(np.sqrt((error**2).mean()))
    assert rest["pic", "noise"] < rest["x2", "noise"] < rest["x5", "noise"] < 0.75 * rest["flip", "noise"]
    assert rest["x5", "field"] < 0.02 * rest["pic", "field"]
    assert rest["x2", "field"] < 0.05 * rest["pic", "field"]


def test_angular_momentum_comes_back_with_the_order():
    lost = [
        advance(spinning_block(mp.BSpline(2), scheme=mp.USL(t), sample_every=1), 50).ledger.worst[
            "angular_momentum"
        ]
        for t in (mp.PIC(), mp.XPIC(2), mp.XPIC(5))
    ]
    assert lost[1] < 0.7 * lost[0]
    assert lost[2] < 0.7 * lost[1]


def test_fmpm_shortens_the_stable_step():
    steps = [
        stable_step(two_blocks(mp.Linear(), scheme=mp.USL(t))) for t in (mp.PIC(), mp.XPIC(4), mp.FMPM(4))
    ]
    assert steps[1] == steps[0]
    assert steps[2] == pytest.approx(steps[0] / 2)


def test_wrong_orders_and_combinations_are_refused_with_the_cure():
    for kind in (mp.XPIC, mp.FMPM):
        for order in (0, -1, 1.5, True, 101, "2"):
            with pytest.raises(mp.InputError, match="order"):
                kind(order)
        with pytest.raises(mp.InputError, match=r"PIC, the limit of many terms, or FLIP"):
            two_blocks(mp.SplineIMLS(), scheme=mp.USL(kind(2)))


def test_explain_names_the_series():
    shown = two_blocks(mp.Linear(), scheme=mp.USL(mp.XPIC(3))).explain()
    assert shown.index("conditions") < shown.index("extended velocity") < shown.index("nodes to particles")
    assert "Hammerquist and Nairn 2017" in shown
    shown = two_blocks(mp.Linear(), scheme=mp.MUSL(mp.FMPM(3))).explain()
    assert shown.count("approximate full mass") == 2


def test_case_files_give_the_number_of_terms():
    def made(**keys):
        return make_scheme(SchemeTable(**keys), mp.Linear())

    assert made(transfer="xpic", terms=5) == mp.USL(mp.XPIC(5))
    assert made(order="musl", transfer="fmpm") == mp.MUSL(mp.FMPM(2))
    with pytest.raises(mp.InputError, match=r"scheme\.terms: flip has no series"):
        made(transfer="flip", terms=3)
    with pytest.raises(mp.InputError, match=r"scheme\.terms"):
        made(transfer="xpic", terms=0)
    table = InterpolationTable(method="tls", degree=2, keep_stress=False, basis="bspline2")
    assert make_interpolation(table) == mp.TLS(mp.BSpline(2), degree=2, keep_stress=False)

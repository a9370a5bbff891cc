"""Manufactured solutions against closed forms, finite differences and the materials themselves."""

from __future__ import annotations

import dataclasses
import warnings

import numpy as np
import pytest
import sympy as sp

from matpoint import mms
from matpoint.errors import InputError
from matpoint.interpolation import CPDI2
from matpoint.materials import Hencky, LinearElastic, NeoHookean, SaintVenantKirchhoff
from matpoint.materials.driver import drive
from matpoint.problems import PROBLEMS, FullWave

HARD = NeoHookean(E=1e7, nu=0.3, density=1000.0)
SOFT = NeoHookean(E=1000.0, nu=0.3, density=1000.0)
HOLLOW = NeoHookean(E=1e7, nu=0.0, density=1000.0)
C = 100.0  # sqrt(E/rho) of HARD

SOLUTIONS = {
    "full": (mms.full_wave(0.1, C), HARD, 0.0031),
    "half": (mms.half_wave(0.05, C), HARD, 0.0031),
    "2d": (mms.standing_waves(0.05, C, 2), HARD, 0.0031),
    "3d": (mms.standing_waves(0.05, C, 3), HARD, 0.0031),
    "vortex": (mms.vortex(1.0, 1.0), SOFT, 0.37),
    "ring": (mms.expanding_ring(0.1, 0.4, 0.6, 100.0), HOLLOW, 0.0031),
    "svk": (mms.standing_waves(0.05, C, 2), SaintVenantKirchhoff(E=1e7, nu=0.3, density=1000.0), 0.0031),
    "svk-vortex": (mms.vortex(0.2, 1.0), SaintVenantKirchhoff(E=1e3, nu=0.3, density=1e3), 0.37),
    "hencky": (mms.standing_waves(0.05, C, 3), Hencky(E=1e7, nu=0.3, density=1000.0), 0.0031),
}
EACH = pytest.mark.parametrize("name", list(SOLUTIONS))


def made(name):
    law, material, time = SOLUTIONS[name]
    return mms.Manufactured(law, material), time


def points(name, n=7):
    rng = np.random.default_rng(3)
    X = rng.uniform(0.05, 0.95, (n, 3))
    if "vortex" in name or name == "ring":
        low, high = (0.4, 0.6) if name == "ring" else (0.75, 1.25)
        R, a = rng.uniform(low, high, n), rng.uniform(0, 2 * np.pi, n)
        X = np.stack([R * np.cos(a), R * np.sin(a), 0 * R], axis=1)
    X[:, len(SOLUTIONS[name][0]) :] = 0.0
    return X


def test_the_check_number_of_the_one_dimensional_problem():
    b = made("full")[0].body_force(np.array([[0.37, 0.0, 0.0]]), 0.0031)
    assert b[0] == pytest.approx([72888.2776, 0.0, 0.0], rel=1e-9)


def test_the_check_numbers_of_the_vortex():
    # mu = 384.615 Pa to all digits
    material = NeoHookean(E=2.6 * 384.615, nu=0.3, density=1000.0)
    b = mms.Manufactured(mms.vortex(1.0, 1.0), material).body_force(np.array([[0.83, 0.41, 0.0]]), 0.37)
    assert b[0] == pytest.approx([-2.00323923, 5.66135823, 0.0], abs=5e-9)


def test_the_closed_form_in_one_dimension():
    """T 44-47 with their misprints put right."""
    solution, t = made("full")
    X = points("full")
    x, A, mu, lam, rho = X[:, 0], 0.1, HARD.shear, HARD.lame, HARD.density
    u = A * np.sin(2 * np.pi * x) * np.sin(C * np.pi * t)
    F = 1 + 2 * A * np.pi * np.cos(2 * np.pi * x) * np.sin(C * np.pi * t)
    b = np.pi**2 * u * (4 * mu / rho - C**2 - 4 * (lam * (np.log(F) - 1) - mu) / (rho * F**2))
    np.testing.assert_allclose(solution.displacement(X, t)[:, 0], u, rtol=1e-12)
    np.testing.assert_allclose(solution.deformation(X, t)[:, 0, 0], F, rtol=1e-12)
    velocity = A * C * np.pi * np.sin(2 * np.pi * x) * np.cos(C * np.pi * t)
    np.testing.assert_allclose(solution.velocity(X, t)[:, 0], velocity, rtol=1e-12)
    np.testing.assert_allclose(solution.body_force(X, t)[:, 0], b, rtol=1e-10)


@pytest.mark.parametrize("dim", [2, 3])
def test_the_closed_form_along_the_axes(dim):
    solution, t = made(f"{dim}d")
    X = points(f"{dim}d")
    A, mu, lam, E, rho = 0.05, HARD.shear, HARD.lame, HARD.E, HARD.density
    phase = C * np.pi * t + np.arange(dim) * 2 * np.pi / dim
    u = A * np.sin(np.pi * X[:, :dim]) * np.sin(phase)
    F = 1 + A * np.pi * np.cos(np.pi * X[:, :dim]) * np.sin(phase)
    J = F.prod(axis=1, keepdims=True)
    b = np.pi**2 * u / rho * ((lam * (1 - np.log(J)) + mu) / F**2 + mu - E)
    np.testing.assert_allclose(solution.body_force(X, t)[:, :dim], b, rtol=1e-9, atol=1e-9)
    sigma = (lam * np.log(J) + mu * (F**2 - 1)) / J
    np.testing.assert_allclose(solution.stress(X, t)[:, :dim], sigma, rtol=1e-10)
    np.testing.assert_allclose(
        solution.stress(X, t)[:, 2], sigma[:, 2] if dim == 3 else lam * np.log(J[:, 0]) / J[:, 0]
    )


def test_the_closed_form_of_the_vortex():
    solution, t = made("vortex")
    X, mu, rho = points("vortex"), SOFT.shear, SOFT.density
    R, turn = np.hypot(X[:, 0], X[:, 1]), np.arctan2(X[:, 1], X[:, 0])
    h = (4 * R - 3) ** 2 * (4 * R - 5) ** 2
    dh = 64 * (R - 1) * (4 * R - 3) * (4 * R - 5)
    ddh = 64 * ((4 * R - 3) * (4 * R - 5) + 4 * (R - 1) * (8 * R - 8))
    g, dg, ddg = np.sin(np.pi * t), np.pi * np.cos(np.pi * t), -(np.pi**2) * np.sin(np.pi * t)
    radial = mu / rho * R * (g * dh) ** 2 - R * (dg * h) ** 2
    around = R * ddg * h - mu / rho * g * (3 * dh + R * ddh)
    a = turn + g * h
    expected = [radial * np.cos(a) - around * np.sin(a), radial * np.sin(a) + around * np.cos(a)]
    np.testing.assert_allclose(solution.body_force(X, t)[:, :2], np.transpose(expected), rtol=1e-8, atol=1e-9)
    s = R * g * dh
    Q = np.array([[np.cos(a), -np.sin(a)], [np.sin(a), np.cos(a)]])
    turned = np.array([[0 * s, mu * s], [mu * s, mu * s**2]])
    sigma = np.einsum("ian,abn,jbn->ijn", Q, turned, Q)
    found = solution.stress(X, t)
    np.testing.assert_allclose(found[:, [0, 1, 3]].T, [sigma[0, 0], sigma[1, 1], sigma[0, 1]], atol=1e-9)


@pytest.mark.parametrize("name", ["vortex", "ring"])
def test_the_circles_are_free_of_tractions(name):
    solution, t = made(name)
    for R in (0.4, 0.6) if name == "ring" else (0.75, 1.25):
        X = np.array([[R * np.cos(0.7), R * np.sin(0.7), 0.0]])
        F, s = solution.deformation(X, t)[0], solution.stress(X, t)[0]
        sigma = np.array([[s[0], s[3], s[5]], [s[3], s[1], s[4]], [s[5], s[4], s[2]]])
        push = sigma @ np.linalg.inv(F).T @ X[0] / R
        assert np.abs(push).max() < 1e-9 * solution.material.E


@EACH
def test_stress_is_that_of_the_material(name):
    solution, t = made(name)
    X = points(name)
    for F, sigma in zip(solution.deformation(X, t), solution.stress(X, t), strict=True):
        np.testing.assert_allclose(sigma, drive(solution.material, [F]).stress[0], rtol=1e-9, atol=1e-6)


@EACH
def test_momentum_is_balanced_by_finite_differences(name):
    """rho0 b = rho0 u_tt - Div P, with P from the compiled law and central differences of order four."""
    solution, t = made(name)
    X, rho, scale = points(name), solution.material.density, solution.material.E
    weights = {-2: 1 / 12, -1: -2 / 3, 1: 2 / 3, 2: -1 / 12}

    def piola(at):
        F, s = solution.deformation(at, t), solution.stress(at, t)
        sigma = s[:, [0, 3, 5, 3, 1, 4, 5, 4, 2]].reshape(-1, 3, 3)
        return np.linalg.det(F)[:, None, None] * sigma @ np.linalg.inv(F).transpose(0, 2, 1)

    step = 1e-4
    divergence = sum(
        w * piola(X + k * step * axis)[:, :, j] / step
        for j, axis in enumerate(np.eye(3)[: solution.dim]) for k, w in weights.items()
    )  # fmt: skip
    short = 1e-4 * t
    rate = sum(w * solution.velocity(X, t + k * short) / short for k, w in weights.items())
    slope = sum(w * solution.displacement(X, t + k * short) / short for k, w in weights.items())
    np.testing.assert_allclose(solution.velocity(X, t), slope, rtol=1e-8, atol=1e-8)
    b = rate - divergence / rho
    np.testing.assert_allclose(solution.body_force(X, t), b, rtol=1e-7, atol=1e-8 * scale / rho)
    np.testing.assert_array_equal(solution.position(X, t), X + solution.displacement(X, t))


def test_a_law_of_the_users_own_and_numbers_as_components():
    F_law = lambda F: 5.0 * (F - sp.eye(3))  # noqa: E731
    material = LinearElastic(E=1.0, nu=0.0, density=2.0)
    with pytest.raises(InputError, match=r"no P\(F\) is known of LinearElastic"):
        mms.Manufactured((mms.X**2,), material)
    solution = mms.Manufactured((mms.X**2 * mms.t, 0.0), material, F_law)
    b = solution.body_force(np.array([[0.3, 0.2, 0.0]]), 2.0)
    assert b[0] == pytest.approx([-5.0 * 4.0 / 2.0, 0.0, 0.0])
    assert solution.start(2.0).place(np.array([[0.3, 0.2, 0.0]]))[0] == pytest.approx([0.48, 0.2, 0.0])


@pytest.mark.parametrize(
    ("law", "material", "message"),
    [
        ("X", HARD, "1 to 3 components"),
        (("sin(X)",), HARD, "must be a sympy expression"),
        ((sp.Symbol("q"),), HARD, "only X, t as imported from matpoint.mms"),
        ((mms.Y,), HARD, "only X, t as imported from matpoint.mms"),
        (mms.vortex(1.0, 1.0), SOLUTIONS["hencky"][1], "along the axes"),
    ],
)
def test_what_is_no_displacement_is_refused(law, material, message):
    with pytest.raises(InputError, match=message):
        mms.Manufactured(law, material)


F = sp.Function("f")


@pytest.mark.parametrize(
    ("law", "told"),
    [
        ((mms.t * sp.Abs(mms.X - 0.5),), r"component 0 = t\*Abs\(X - 0.5\) can't be .*DiracDelta"),
        ((0.0, mms.t * sp.Max(mms.X, mms.Y)), "component 1 .*DiracDelta"),
        ((sp.floor(mms.X) * mms.t,), "can't be differentiated twice"),
        ((F(mms.X) * mms.t,), "can't be differentiated twice"),
        ((sp.exp(sp.I * mms.X),), "holds the imaginary unit I"),
        ((sp.sqrt(-2),), "holds the imaginary unit I"),
        ((sp.nan,), "nan or an infinity"),
        ((sp.zoo * mms.X,), "nan or an infinity"),
        ((0.0, -sp.oo), "component 1 .*nan or an infinity"),
        ((float("nan"),), "must be finite"),
        ((sp.Integer(10) ** 400,), "must be a finite, real number"),
        ((mms.X * sp.Integer(10) ** 400,), "can't be computed"),
        ((sp.Integral(sp.sin(mms.X * mms.Y), (mms.Y, 0, mms.t)),), "can't be computed"),
        (([mms.X, mms.t],), r"component 0 = \[X, t\] must be a sympy expression of X, t"),
        (np.array([[mms.X, mms.t]] * 2), "1 to 3 components"),
        (((mms.X, mms.t), (mms.X, mms.t)), r"component 0 = \(X, t\) must be"),
        ((sp.ImmutableMatrix([mms.X]),), "not a matrix"),
        ((mms.X,) * 4, "1 to 3 components"),
        ((), "1 to 3 components"),
        ((lambda X: X,), "component 0 = <function .* must be a sympy expression"),
        ((True,), "component 0 = True must be"),
    ],
)
def test_odd_displacements_are_refused_in_one_line(law, told):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(InputError, match=f"^manufactured solution: .*{told}") as refused:
            mms.Manufactured(law, HARD)
    assert len(str(refused.value).splitlines()) == 1
    assert len(str(refused.value)) < 320


@pytest.mark.parametrize(
    ("u", "what"),
    [
        (mms.t * sp.sqrt(mms.X - 0.5), "F"),
        (mms.t * sp.log(mms.X - 2), "the displacement"),
        (mms.X / mms.t, "F"),
        ((-1) ** mms.t * mms.X / 9, "F"),
        (mms.X * sp.sqrt(mms.t), "the velocity"),
        (mms.t * mms.X ** sp.Rational(3, 2), "the body force"),
    ],
)
def test_a_problem_with_fields_that_are_no_numbers_says_where_and_when(u, what):
    class Odd(FullWave):
        name = "odd"
        solution = mms.Manufactured((u,), HARD)

    told = (
        rf"^odd: manufactured solution: {what} is no finite number at X = \(.*\) m, t = .* s; u must be real"
    )
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(InputError, match=told):
            Odd()


def test_a_problem_whose_solution_does_not_fit_is_refused():
    class Flat(FullWave):
        solution = mms.Manufactured(mms.standing_waves(0.05, C, 2), HARD)

    with pytest.raises(InputError, match=r"2 components, the grid is 1-D"):
        Flat().simulation(CPDI2())

    class Wrong(FullWave):
        solution = (mms.X,)

    with pytest.raises(
        InputError, match=r"mms-1d: solution = \(X,\): it must be a matpoint.mms.Manufactured"
    ):
        Wrong()


@pytest.mark.parametrize(
    "places", [[0.1, 0.2, 0.3], np.zeros((5, 2)), "X", [[1.0, 2.0], [3.0]], [["a", 0, 0]], None]
)
def test_places_of_another_shape_are_refused(places):
    solution = mms.Manufactured(mms.full_wave(0.1, C), HARD)
    for call in (solution.position, solution.stress, solution.body_force):
        with pytest.raises(InputError, match=r"shape \(n, 3\)"):
            call(places, 0.1)
    with pytest.raises(InputError, match=r"shape \(n, 3\)"):
        solution.refuse_folds(places, [0.0])


def test_times_that_are_no_numbers_are_refused():
    solution, X = mms.Manufactured(mms.full_wave(0.1, C), HARD), np.zeros((1, 3))
    for time in (None, "a", float("nan"), 1j):
        with pytest.raises(InputError, match=r"time = .* must be a finite number"):
            solution.velocity(X, time)
    for times in (None, "a", [], 3.0, [np.nan]):
        with pytest.raises(InputError, match="manufactured solution: time"):
            solution.refuse_infinite(X, times)


def test_numbers_of_numpy_are_numbers():
    solution = mms.Manufactured((np.float32(0.5), np.int64(0)), HARD)
    assert solution.position([[0.1, 0.2, 0.0]], 0.0)[0] == pytest.approx([0.6, 0.2, 0.0])


@pytest.mark.parametrize("material", ["rubber", None, NeoHookean])
def test_what_is_no_material_is_refused(material):
    with pytest.raises(InputError, match=r"material = .* must be a material"):
        mms.Manufactured(mms.full_wave(0.1, C), material)


@pytest.mark.parametrize(
    ("kind", "most", "where", "when"),
    [
        ("mms-1d", 0.5 / np.pi, "X = (0.5, 0, 0) m", "t = 0.005 s"),
        ("mms-1d-half", 1 / np.pi, "X = (1, 0, 0) m", "t = 0.005 s"),
        ("mms-2d", 1 / np.pi, "X = (0, 0, 0) m", "t = 0.005 s"),
        ("mms-3d", 1 / np.pi, "X = (0, 0, 0) m", "t = 0.015 s"),
        ("expanding-ring", 27 / 70, "", "t = 0.015 s"),
    ],
)
def test_a_problem_whose_motion_folds_says_where_and_when(kind, most, where, when):
    """det F reaches 0 where the amplitude reaches its limit; places and times are on the lattice."""
    PROBLEMS[kind](amplitude=0.99 * most)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for amplitude in (1.01 * most, 5.0, 1e300):
            with pytest.raises(InputError, match=f"{kind}: .*the motion folds") as refused:
                PROBLEMS[kind](amplitude=amplitude)
            if amplitude == 1.01 * most:
                assert where in str(refused.value)
                assert when in str(refused.value)


def test_a_vortex_never_folds():
    PROBLEMS["vortex"](amplitude=30.0)


def test_folds_of_a_users_own_motion_are_found():
    solution = mms.Manufactured((-mms.X * mms.t, 0), HARD)
    places = np.array([[0.3, 0.0, 0.0], [0.6, 0.0, 0.0]])
    solution.refuse_folds(places, [0.0, 0.5, 0.99])
    with pytest.raises(InputError, match=r"det F = -0.5 .*t = 1.5 s"):
        solution.refuse_folds(places, [0.0, 1.5, 1.2])
    sheared = mms.Manufactured((mms.Y * mms.t + mms.X * mms.Y, mms.X * mms.t), HARD)
    F = sheared.deformation(places, 0.4)
    assert np.linalg.det(F) == pytest.approx([1 - 0.16 - 0.4 * 0.3, 1 - 0.16 - 0.4 * 0.6])
    sheared.refuse_folds(places, [0.4])
    with pytest.raises(InputError, match=r"det F = -0.12 at X = \(0.6, 0, 0\)"):
        sheared.refuse_folds(places, [0.8])


def test_first_piola_is_always_a_function_and_follows_the_material():
    solution = mms.Manufactured(mms.full_wave(0.1, C), HARD)
    F = sp.diag(sp.Rational(6, 5), 1, 1)
    expected = mms.first_piola(HARD, F)
    assert solution.first_piola(F) == expected
    softer = dataclasses.replace(solution, material=SOFT)
    assert softer.first_piola(F) == mms.first_piola(SOFT, F)
    given = mms.Manufactured(mms.full_wave(0.1, C), LinearElastic(E=1.0, nu=0.0, density=1.0), lambda F: F)
    assert given.first_piola(F) == F
    own = mms.Manufactured(mms.full_wave(0.1, C), HARD, lambda F: mms.first_piola(HARD, F))
    X = points("full")
    np.testing.assert_allclose(own.body_force(X, 0.003), solution.body_force(X, 0.003), rtol=1e-12)


@pytest.mark.parametrize(
    "law",
    [
        3,
        lambda F: 1.0,
        lambda F: F[0, 0],
        lambda F: F * mms.X,
        lambda F: np.eye(3),
        lambda F: 1 / 0,
        lambda F, G: F,
        lambda F: sp.I * F,
        lambda F: F * sp.nan,
    ],
)
def test_a_first_piola_that_gives_no_matrix_of_F_is_refused(law):
    with pytest.raises(InputError, match="first_piola"):
        mms.Manufactured(mms.full_wave(0.1, C), HARD, law)


def test_hencky_takes_displacements_along_the_axes_only():
    material = Hencky(E=1e7, nu=0.3, density=1000.0)
    mms.Manufactured(mms.standing_waves(0.05, C, 3), material)
    with pytest.raises(InputError, match="Hencky elasticity needs a displacement along the axes"):
        mms.Manufactured(mms.vortex(0.1, 1.0), material)

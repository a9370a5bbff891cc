"""Materials: closed forms, the single-point driver, names, bad input, citations."""

from __future__ import annotations

from math import inf, log, nan, sqrt

import numpy as np
import pytest

from material_cases import CASES
from matpoint.citations import CITATIONS, bibtex
from matpoint.errors import InputError
from matpoint.materials import (
    MATERIALS,
    Hencky,
    NeoHookean,
    NewtonianFluid,
    UserMaterial,
    VonMises,
    material_from,
    register_material,
)
from matpoint.materials.driver import drive, shear, uniaxial
from matpoint.tensor import identity, scale

STEEL = {"E": 2e5, "nu": 0.3, "density": 1.0, "yield_stress": 250.0, "hardening": 2000.0}


def plain(F, F_new, L, dt, state, params):
    return scale(F_new[0][0] - 1.0, identity())


# --- plasticity against closed forms


@pytest.mark.parametrize("steps", [1, 7])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_plastic_uniaxial_stress(sign, steps):
    """ln λ = τ/E + α and |τ| = σ_y + H α: exact in any number of steps."""
    m = VonMises(**STEEL)
    strain = sign * 0.05
    found = uniaxial(m, np.exp(np.linspace(0.0, strain, steps + 1)), "stress")
    alpha = (m.E * abs(strain) - m.yield_stress) / (m.E + m.hardening)
    tau = sign * (m.yield_stress + m.hardening * alpha)
    J = np.exp((1.0 - 2.0 * m.nu) * tau / m.E)
    np.testing.assert_allclose(found.state[-1, 6], alpha, rtol=1e-9)
    np.testing.assert_allclose(found.stress[-1], [tau / J, 0, 0, 0, 0, 0], rtol=1e-9, atol=1e-7)


def test_plastic_uniaxial_strain_loaded_and_reversed():
    m = VonMises(**STEEL)
    path = np.exp([0.0, 0.01, 0.01 - 1e-4, -0.01])
    found = uniaxial(m, path)
    strain, plastic, alpha = 0.0, 0.0, 0.0
    for k, stretch in enumerate(path):
        strain = log(stretch)
        q = 2.0 * m.shear * (strain - 1.5 * plastic)  # τ_xx - τ_yy
        excess = max(abs(q) - m.yield_stress - m.hardening * alpha, 0.0)
        growth = excess / (3.0 * m.shear + m.hardening)
        alpha, plastic = alpha + growth, plastic + np.sign(q) * growth
        q -= np.sign(q) * 3.0 * m.shear * growth
        axial = (m.bulk * strain + 2.0 / 3.0 * q) / stretch
        lateral = (m.bulk * strain - q / 3.0) / stretch
        np.testing.assert_allclose(found.stress[k, :3], [axial, lateral, lateral], rtol=1e-9, atol=1e-6)
        np.testing.assert_allclose(found.state[k, 6], alpha, rtol=1e-9, atol=1e-15)


def test_plastic_simple_shear_in_small_steps():
    """τ = (σ_y + H α)/√3 with γ = τ/μ + √3 α, to the order of γ."""
    m = VonMises(**STEEL)
    gamma = 0.01
    found = shear(m, np.linspace(0.0, gamma, 51))
    alpha = (sqrt(3.0) * m.shear * gamma - m.yield_stress) / (3.0 * m.shear + m.hardening)
    tau = (m.yield_stress + m.hardening * alpha) / sqrt(3.0)
    np.testing.assert_allclose(found.state[-1, 6], alpha, rtol=2e-4)
    np.testing.assert_allclose(found.stress[-1, 3], tau, rtol=2e-4)


def test_plastic_work_is_stored_or_dissipated():
    m = VonMises(**STEEL)
    path = uniaxial(m, np.exp(np.linspace(0.0, 0.02, 2001)))
    stretch = path.deformation_gradient[:, 0, 0]
    P = path.stress[:, 0]  # uniaxial strain: the nominal stress is the true one
    work = float(np.sum(0.5 * (P[1:] + P[:-1]) * np.diff(stretch)))
    stored = m.energy(path.deformation_gradient[-1:], path.state[-1:])[0]
    np.testing.assert_allclose(work, stored + m.yield_stress * path.state[-1, 6], rtol=1e-5)
    assert stored < work


def test_plastic_energy_and_speed_without_a_state_take_no_deviator():
    m = VonMises(**STEEL)
    F = np.diag([1.1, 1.0, 1.0])[None]
    np.testing.assert_allclose(m.energy(F), 0.5 * m.bulk * log(1.1) ** 2)
    assert m.wave_speed(F)[0] < m.wave_speed(np.eye(3)[None])[0]


# --- elastic and fluid closed forms


def test_hencky_uniaxial_stress():
    m = Hencky(1e6, 0.3, 1.0)
    found = uniaxial(m, [1.0, 1.5], "stress")
    tau = m.E * log(1.5)
    np.testing.assert_allclose(found.deformation_gradient[1, 1, 1], 1.5**-m.nu, rtol=1e-12)
    np.testing.assert_allclose(found.stress[1, 0], tau / 1.5 ** (1.0 - 2.0 * m.nu), rtol=1e-11)


def test_neo_hookean_shear_and_equation_27():
    m = NeoHookean(1e6, 0.3, 1.0)
    np.testing.assert_allclose(
        shear(m, [0.4]).stress[0], [m.shear * 0.16, 0, 0, m.shear * 0.4, 0, 0], atol=1e-9
    )
    sigma = uniaxial(m, [1.2]).stress[0]
    axial = (m.lame * log(1.2) + m.shear * (1.44 - 1.0)) / 1.2
    lateral = m.lame * log(1.2) / 1.2
    np.testing.assert_allclose(sigma, [axial, lateral, lateral, 0, 0, 0], rtol=1e-13)


def test_fluid_pressure_viscosity_and_cut_off():
    m = NewtonianFluid(1000.0, 2.0, 7e6)
    np.testing.assert_allclose(uniaxial(m, [0.9, 0.9]).stress[1, :3], -1e6 * (0.9**-7.0 - 1.0), rtol=1e-12)
    rate = shear(m, [0.0, 0.1], dt=0.5).stress[1]
    np.testing.assert_allclose(rate, [0, 0, 0, 2.0 * 0.2, 0, 0], atol=1e-12)
    parted = NewtonianFluid(1000.0, 0.0, 7e6, tension_cutoff=True)
    assert not uniaxial(parted, [1.1]).stress.any()
    assert parted.energy(np.diag([1.1, 1.0, 1.0])[None])[0] == 0.0
    np.testing.assert_allclose(m.diffusivity, 4.0 / 3.0 * 2e-3)


def test_initial_state():
    state = VonMises(**STEEL).initial_state(3)
    assert state.shape == (3, 7)
    assert (state == [1, 1, 1, 0, 0, 0, 0]).all()
    assert NeoHookean(1.0, 0.0, 1.0).initial_state(3).shape == (3, 0)


# --- the driver


@pytest.mark.parametrize("case", CASES.values(), ids=CASES.keys())
def test_plot_writes_a_picture(case, tmp_path):
    figure = case.material.plot(tmp_path / "response.png")
    assert (tmp_path / "response.png").read_bytes().startswith(b"\x89PNG")
    assert len(figure.axes) == 2


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda m: drive(m, np.eye(3)), "shape"),
        (lambda m: drive(m, [-np.eye(3)]), "determinants"),
        (lambda m: drive(m, [nan * np.eye(3)]), "finite"),
        (lambda m: drive(m, [np.eye(3)], dt=0.0), "dt = 0.0"),
        (lambda m: uniaxial(m, [-1.0]), "stretches"),
        (lambda m: uniaxial(m, [1.0], "free"), "'free'"),
        (lambda m: m.plot("no/such/folder/x.png"), "can't be written"),
    ],
)
def test_driver_refuses(call, words):
    with pytest.raises(InputError, match=words):
        call(NeoHookean(1.0, 0.3, 1.0))


# --- bad input


ELASTIC = [name for name in MATERIALS if name != "newtonian-fluid"]
GOOD = {name: {"E": 1.0, "nu": 0.3, "density": 1.0} for name in ELASTIC}
GOOD["von-mises"] = STEEL
GOOD["newtonian-fluid"] = {"density": 1.0, "viscosity": 0.0, "bulk_modulus": 1.0}
BAD = [(law, "E", v) for law in ELASTIC for v in (0.0, -1.0, nan, inf, "stiff", None, True)]
BAD += [(law, "nu", v) for law in ELASTIC for v in (0.5, -1.0, 0.7, nan)]
BAD += [(law, "density", v) for law in GOOD for v in (0.0, -1.0, nan)]
BAD += [("von-mises", "yield_stress", 0.0), ("von-mises", "hardening", -1.0)]
BAD += [("newtonian-fluid", "viscosity", -1.0), ("newtonian-fluid", "bulk_modulus", 0.0)]
BAD += [("newtonian-fluid", "exponent", 0.0), ("newtonian-fluid", "tension_cutoff", 1.0)]


@pytest.mark.parametrize(("law", "name", "value"), BAD)
def test_a_bad_parameter_is_named_with_its_value_and_what_is_allowed(law, name, value):
    with pytest.raises(InputError) as caught:
        material_from(law, **(GOOD[law] | {name: value}))
    message = str(caught.value)
    assert f"{name} = {value!r}" in message
    assert "must be" in message


@pytest.mark.parametrize(
    ("law", "parameters", "words"),
    [
        ("neo-hokean", {}, "did you mean 'neo-hookean'"),
        ("NeoHookean", {}, "did you mean 'neo-hookean'"),
        ("granite", {}, "unknown material 'granite'; there are neo-hookean"),
        ("hencky", {"E": 1.0, "density": 1.0}, "lacks nu"),
        ("von-mises", STEEL | {"yeild_stress": 1.0}, "did you mean 'yield_stress'"),
    ],
)
def test_unknown_names_and_parameters(law, parameters, words):
    with pytest.raises(InputError, match=words):
        material_from(law, **parameters)


USER = {"function": plain, "parameters": {}, "density": 1.0, "modulus": 1.0}


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"function": 3}, "function = 3"),
        ({"density": -1.0}, "density = -1.0"),
        ({"parameters": {"k": nan}}, r"parameters\['k'\] = nan"),
        ({"parameters": {"2k": 1.0}}, "2k"),
        ({"parameters": {"def": 1.0}}, "def"),
        ({"parameters": {"k": "soft"}}, "soft"),
        ({"state": 5}, "state = 5"),
        ({"modulus": None}, "either modulus"),
        ({"modulus": 0.0}, "modulus = 0.0"),
        ({"speed": lambda F, state: F[:, 0, 0]}, "either modulus"),
        ({"function": lambda F, F_new, L, dt, state, params: 1 / 0}, "fails: ZeroDivisionError"),
        ({"function": lambda F, F_new, L, dt, state, params: 1.0}, "3x3"),
        ({"function": lambda F, F_new, L, dt, state, params: L}, "symmetric"),
        ({"function": lambda F, F_new, L, dt, state, params: scale(nan, identity())}, "finite"),
    ],
)
def test_a_bad_user_material_is_refused(change, words):
    with pytest.raises(InputError, match=words):
        UserMaterial(**(USER | change))


def test_user_speed_and_energy():
    m = UserMaterial(plain, {}, 4.0, modulus=16.0)
    F = np.diag([1.5, 1.0, 1.0])[None]
    np.testing.assert_allclose(m.wave_speed(F), 3.0)
    assert m.energy(F) is None
    assert m.params == UserMaterial(plain, {}, 1.0, modulus=1.0).params


# --- names and citations


def test_every_name_makes_its_material():
    for name, factory in MATERIALS.items():
        assert type(material_from(name, **GOOD[name])) is factory


def test_registration(monkeypatch):
    monkeypatch.delitem(MATERIALS, "rubber", raising=False)
    register_material("rubber", lambda **_: NeoHookean(1.0, 0.4, 1.0))
    assert material_from("rubber", anything=1) == NeoHookean(1.0, 0.4, 1.0)
    with pytest.raises(InputError, match="'hencky' is registered already"):
        register_material("hencky", NeoHookean)
    del MATERIALS["rubber"]


def test_citations():
    for material in MATERIALS.values():
        assert material.citation
        assert bibtex(material.citation).startswith("@")
    for key, entry in CITATIONS.items():
        assert f"{{{key}," in entry
        assert f"year = {{{key[-4:]}}}" in entry
        assert entry.count("{") == entry.count("}")
    assert bibtex(["jiang2015", "sulsky1994", "jiang2015"]).count("@") == 2
    with pytest.raises(InputError, match="unknown citations"):
        bibtex(["nobody1900"])

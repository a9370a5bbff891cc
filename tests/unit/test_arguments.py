"""What is given from Python in the wrong kind: one message, never a traceback from inside."""

from __future__ import annotations

import numpy as np
import pytest

import matpoint as mp

RUBBER = mp.NeoHookean(E=1e5, nu=0.3, density=1e3)
GOOD = {
    "grid": mp.Grid((0, 0), (1, 1), 0.25),
    "bodies": [mp.Body(mp.Box((0.25, 0.25), (0.75, 0.75)), RUBBER)],
    "interpolation": mp.CPDI2(),
    "timestep": mp.FixedStep(1e-3),
}


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("grid", (0, 1)),
        ("bodies", GOOD["bodies"][0]),
        ("bodies", [RUBBER]),
        ("interpolation", "cpdi2"),
        ("interpolation", mp.CPDI2),
        ("timestep", 1e-3),
        ("scheme", "usl"),
        ("scheme", mp.USL),
        ("boundaries", ["fixed"]),
        ("boundaries", mp.Fixed(mp.Plane("x", 0.0))),
        ("loads", [(0, -10)]),
        ("damping", 0.5),
        ("threads", "two"),
        ("sort_every", 0),
        ("sample_every", 1.5),
    ],
)
def test_a_simulation_refuses_the_wrong_kind(name, value):
    with pytest.raises(mp.InputError, match=name) as caught:
        mp.Simulation(**(GOOD | {name: value}))
    assert "\n" not in str(caught.value)


SQUARE = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]


@pytest.mark.parametrize(
    "call",
    [
        lambda: mp.Fixed("x"),
        lambda: mp.Roller("x"),
        lambda: mp.Symmetry(mp.Box((0,), (1,))),
        lambda: mp.PrescribedVelocity("left", (0.0,)),
        lambda: mp.PrescribedVelocity(mp.Plane("x", 0.0), ("fast",)),
        lambda: mp.Roller(mp.Plane("x", 0.0), ("a", 1)),
        lambda: mp.Plane("x", "left"),
        lambda: mp.Surface(""),
        lambda: mp.CFL("a"),
        lambda: mp.CFL(0.4, every=1.5),
        lambda: mp.CFL(0.4, largest="a"),
        lambda: mp.FixedStep("a"),
        lambda: mp.Body(mp.Box((0,), (1,)), RUBBER, velocity="abc"),
        lambda: mp.Body(mp.Box((0,), (1,)), RUBBER, per_cell=0),
        lambda: mp.Grid(None, (1,), 0.5),
        lambda: mp.Grid("ab", (1,), 0.5),
        lambda: mp.domains_from_arrays([[0, 0], [1]], [[0, 1]], "line"),
        lambda: mp.domains_from_arrays(SQUARE, [[0, 1, 2, 3]], "square"),
        lambda: mp.BodyForce("x"),
        lambda: mp.Gravity("down"),
        lambda: mp.Gravity((0.0,), history=3.0),
        lambda: mp.Pressure("inner", 1.0),
        lambda: mp.Pressure(mp.Surface("inner"), "high"),
        lambda: mp.Traction(mp.Surface("inner"), (1.0,), per="area"),
        lambda: mp.Traction("inner", (1.0,)),
        lambda: mp.MassDamping("a"),
        lambda: mp.LocalDamping(None),
        lambda: mp.Box((0,), (1,)) | 3,
        lambda: mp.Ball((0, 0), "wide"),
        lambda: mp.EnrichedCPDI2(where="somewhere"),
        lambda: mp.EnrichedCPDI2(hourglass=2.0),
        lambda: mp.EnrichedCPDI2(layers=True),
    ],
)
def test_every_choice_refuses_the_wrong_kind(call):
    with pytest.raises(mp.InputError) as caught:
        call()
    assert "\n" not in str(caught.value)


def test_numpy_numbers_are_numbers():
    mp.Ball((np.float32(0), 0), np.float32(1))
    mp.Body(mp.Box((0,), (1,)), RUBBER, per_cell=np.int64(2))
    mp.FixedStep(np.float64(1e-3))
    mp.Grid(np.zeros(2), np.ones(2), np.float64(0.5))
    assert mp.domains_from_arrays(np.array(SQUARE), np.array([[0, 1, 2, 3]]), "quad").n == 1


def test_a_run_refuses_the_wrong_kind():
    sim = mp.Simulation(**GOOD)
    for call in (lambda: sim.run("a"), lambda: sim.run(1.0, writers=["a"]), lambda: sim.advance(-1.0)):
        with pytest.raises(mp.InputError):
            call()


def test_a_velocity_with_too_many_numbers_is_refused():
    body = mp.Body(mp.Box((0.25, 0.25), (0.75, 0.75)), RUBBER, velocity=(0.0, 0.0, 1.0))
    with pytest.raises(mp.InputError, match="velocity has 3 numbers"):
        mp.Simulation(**(GOOD | {"bodies": [body]}))


def test_a_prescribed_velocity_of_the_wrong_shape_is_refused():
    drive = mp.PrescribedVelocity(mp.Plane("x", 0.0), (lambda x, t: np.zeros((len(x), 2)), None))
    with pytest.raises(mp.InputError, match="shape"):
        mp.Simulation(**GOOD, boundaries=[drive])


def test_two_domains_of_a_mesh_in_one_place_are_refused():
    with pytest.raises(mp.InputError, match="same corners"):
        mp.domains_from_arrays(SQUARE, [[0, 1, 2, 3], [1, 2, 3, 0]], "quad")
    twice = np.array([*SQUARE, *(np.array(SQUARE) * 0.5 + 0.2)]) * 0.5 + 0.1
    mesh = mp.domains_from_arrays(twice, [[0, 1, 2, 3], [4, 5, 6, 7]], "quad")
    with pytest.raises(mp.InputError, match="two of its domains lie in one place"):
        mp.Simulation(**(GOOD | {"bodies": [mp.Body(mesh, RUBBER)]}))


def test_corners_in_one_place_become_one():
    x = [*SQUARE, [1.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0]]
    mesh = mp.domains_from_arrays(x, [[0, 1, 2, 3], [4, 5, 6, 7]], "quad")
    assert len(mesh.vertices) == 6
    assert len(np.unique(mesh.cells)) == 6


def test_a_load_that_stops_being_a_number_names_the_particle():
    load = mp.BodyForce(lambda X, x, t: np.where(t > 0.0035, np.nan, 0.0) * x)
    sim = mp.Simulation(**GOOD, loads=[load])
    with pytest.raises(mp.RunError, match=r"load 0 \(body force\)") as caught:
        sim.run(0.1)
    assert caught.value.step == 4
    assert caught.value.particle is not None

"""Case files: the same objects as from Python, and nothing but an InputError for what is wrong."""

from __future__ import annotations

import contextlib
import tomllib

import numpy as np
import pytest

import matpoint as mp
from cases import SMALL
from matpoint.case import Case, CaseTable, build_simulation, build_writers, bundled_cases, load
from matpoint.problems import PROBLEMS


def _case(text):
    return Case("test", CaseTable.model_validate(tomllib.loads(text)))


def test_the_same_run_as_the_same_constructors():
    from_case = build_simulation(_case(SMALL), threads=1)
    rubber = mp.NeoHookean(E=1e5, nu=0.3, density=1000.0)
    from_python = mp.Simulation(
        mp.Grid((0, 0), (1, 1), 0.25),
        [mp.Body(mp.Box((0.25, 0.5), (0.75, 1.0)), rubber, 2)],
        interpolation=mp.CPDI2(),
        timestep=mp.FixedStep(1e-3),
        boundaries=[mp.Fixed(mp.Plane("y", 1.0, "upper"))],
        loads=[mp.Gravity((0.0, -10.0))],
        threads=1,
    )
    for sim in (from_case, from_python):
        sim.run(0.01)
    np.testing.assert_array_equal(from_case.particles.position, from_python.particles.position)


def test_every_bundled_case_builds_with_every_method(tmp_path):
    for name in bundled_cases():
        for method in mp.METHODS:
            case = load(name, [f"interpolation.method={method}"])
            problem = case.tables.problem
            if problem is not None and method not in PROBLEMS[problem.name].methods:
                with contextlib.suppress(mp.InputError):
                    build_simulation(case, threads=1)
                continue
            sim = build_simulation(case, threads=1)
            assert sim.interpolation.name == method
            assert len(build_writers(case, tmp_path, sim)) >= 3


def test_another_method_leaves_behind_options_that_it_does_not_have():
    for name in ("inclusion", "sphere-inclusion"):
        assert load(name).tables.interpolation.hourglass == 0.1
        table = load(name, ["interpolation.method=cpdi2"]).tables.interpolation
        assert (table.layers, table.hourglass) == (None, None)
    with pytest.raises(mp.InputError, match=r"layers: cpdi2 has no such option"):
        build_simulation(load("inclusion", ["interpolation.method=cpdi2", "interpolation.layers=1"]))


SHAPES = """
[grid]
lower = [0.0, 0.0]
upper = [4.0, 4.0]
cell = [0.5, 0.5]
[materials.m]
law = "{law}"
[[bodies]]
material = "m"
region = {region}
velocity = {velocity}
[interpolation]
method = "bspline3"
[scheme]
order = "musl"
transfer = "apic"
[[boundaries]]
kind = "roller"
region = {{ shape = "half-space", point = [0.0, 0.2], normal = [0.0, 1.0] }}
normal = [0.0, 1.0]
[[boundaries]]
kind = "symmetry"
plane = {{ axis = "x", at = 4.0 }}
[[boundaries]]
kind = "velocity"
plane = {{ axis = "x", at = 0.0 }}
velocity = ["0.1*sin(t)*y", "free"]
[[loads]]
kind = "gravity"
value = [0.0, -1.0]
ramp = 0.1
history = "cos(3*t)"
[[loads]]
kind = "body-force"
value = ["X - x", "t"]
[damping]
kind = "local"
factor = 0.2
[time]
end = 0.01
cfl = 0.3
largest = 1e-3
"""
LAWS = {
    "neo-hookean": 'neo-hookean"\nE = 1e5\nnu = 0.3\ndensity = 1e3\n#"',
    "hencky": 'hencky"\nE = 1e5\nnu = 0.3\ndensity = 1e3\n#"',
    "saint-venant-kirchhoff": 'saint-venant-kirchhoff"\nE = 1e5\nnu = 0.3\ndensity = 1e3\n#"',
    "linear-elastic": 'linear-elastic"\nE = 1e5\nnu = 0.3\ndensity = 1e3\n#"',
    "newtonian-fluid": 'newtonian-fluid"\nviscosity = 1.0\nbulk_modulus = 1e5\ndensity = 1e3\n#"',
    "von-mises": 'von-mises"\nE = 1e5\nnu = 0.3\ndensity = 1e3\nyield_stress = 1e3\nhardening = 1e3\n#"',
}
REGIONS = [
    '{ shape = "ball", centre = [2.0, 2.0], radius = 1.0 }',
    '{ shape = "annulus", inner = 0.5, outer = 1.5, centre = [2.0, 2.0] }',
    '{ shape = "polygon", points = [[1.0, 1.0], [3.0, 1.0], [2.0, 3.0]] }',
    '{ shape = "difference", of = [{ shape = "box", lower = [1, 1], upper = [3, 3] },'
    ' { shape = "ball", centre = [2, 2], radius = 0.5 }] }',
    '{ shape = "union", of = [{ shape = "box", lower = [1, 1], upper = [2, 2] },'
    ' { shape = "box", lower = [2, 2], upper = [3, 3] }] }',
    '{ shape = "intersection", of = [{ shape = "box", lower = [1, 1], upper = [3, 3] },'
    ' { shape = "half-space", point = [2, 2], normal = [1, 1] }] }',
]


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("region", REGIONS)
def test_tables_of_all_kinds_run(law, region):
    velocity = '["0.1*x", 0.0]' if law == "hencky" else "[0.1]"
    text = SHAPES.format(law=LAWS[law], region=region, velocity=velocity)
    sim = build_simulation(_case(text), threads=1)
    sim.run(2e-3)
    assert np.isfinite(sim.particles.stress).all()
    assert sim.step >= 2


def test_meshes_in_cases():
    base = SMALL.replace(
        'region = { shape = "box", lower = [0.25, 0.5], upper = [0.75, 1.0] }', "mesh = MESH"
    )
    for mesh, count in (
        ('{ shape = "box", lower = [0.25, 0.5], upper = [0.75, 1.0], divisions = [3, 4] }', 12),
        ('{ shape = "annulus", inner = 0.3, outer = 0.8, divisions = [2, 5], centre = [0.1, 0.1] }', 10),
        ('{ shape = "arrays", kind = "tri", cells = [[0,1,2]], vertices = [[0,0.2],[0.8,0.2],[0.5,1]] }', 1),
    ):
        sim = build_simulation(_case(base.replace("MESH", mesh)), threads=1)
        assert len(sim.particles) == count


def test_overrides():
    case = load("cantilever", ["grid.cell=[0.25, 0.5]", "bodies.0.per_cell = 2", "title=Mine", "time.end=1"])
    assert case.tables.grid.cell == [0.25, 0.5]
    assert case.tables.bodies[0].per_cell == 2
    assert case.tables.title == "Mine"
    assert case.tables.time.end == 1.0
    for setting, message in (
        ("bodies.4.name=x", "0 to 0"),
        ("title.x=1", "below a value"),
        ("=1", "table.key"),
    ):
        with pytest.raises(mp.InputError, match=message):
            load("cantilever", [setting])


def test_a_problem_gives_its_own_tables():
    with pytest.raises(mp.InputError, match="bodies: the problem gives it"):
        build_simulation(load("bimaterial-bar", ['bodies=[{material="m"}]']))
    with pytest.raises(mp.InputError, match="did you mean 'stiff'"):
        build_simulation(load("bimaterial-bar", ["problem.stif=above"]))
    with pytest.raises(mp.InputError, match="stiff"):
        build_simulation(load("bimaterial-bar", ["problem.stiff=left"]))
    with pytest.raises(mp.InputError, match="dim"):
        build_simulation(load("bimaterial-bar", ["problem.dim=4"]))
    with pytest.raises(mp.InputError, match="did you mean 'bimaterial-bar'"):
        build_simulation(load("bimaterial-bar", ["problem.name=bimaterial-bra"]))

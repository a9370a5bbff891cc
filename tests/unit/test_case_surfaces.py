"""Boundary sets, corners and loads on faces in case files."""

from __future__ import annotations

import tomllib

import pytest

import matpoint as mp
from matpoint.case import CaseTable, build_simulation
from matpoint.case.load import Case, check
from matpoint.errors import InputError

RING = """
[grid]
lower = [0.0, 0.0]
upper = [2.5, 2.5]
cell = 0.25
[materials.rubber]
law = "neo-hookean"
E = 1e6
nu = 0.3
density = 1000.0
[[bodies]]
name = "in"
material = "rubber"
mesh = { shape = "annulus", inner = 1.0, outer = 1.5, divisions = [4, 16] }
[[bodies]]
name = "out"
material = "rubber"
mesh = { shape = "annulus", inner = 1.5, outer = 2.0, divisions = [4, 16] }
[interpolation]
METHOD
[time]
end = 0.01
step = 1e-4
[[boundaries]]
kind = "symmetry"
plane = { axis = "x", at = 0.0 }
[[boundaries]]
kind = "symmetry"
plane = { axis = "y", at = 0.0 }
BOUNDARY
LOAD
"""


def ring(boundary="", load="", method='method = "enriched-cpdi2"'):
    text = RING.replace("BOUNDARY", boundary).replace("LOAD", load).replace("METHOD", method)
    return build_simulation(Case("ring", check(tomllib.loads(text), "ring")), threads=1)


def test_a_case_is_the_same_as_the_same_constructors():
    sim = ring(
        '[[boundaries]]\nkind = "fixed"\nsurface = "inner"',
        '[[loads]]\nkind = "pressure"\nsurface = { name = "outer", body = "out" }\nvalue = 2e3\nramp = 0.01\n'
        '[[loads]]\nkind = "traction"\nsurface = "outer"\nvalue = [1e3, 0.0]\nhistory = "sin(100*t)"\n'
        'per = "current"',
        'method = "enriched-cpdi2"\nwhere = "all"\nhourglass = 0.1',
    )
    assert sim.interpolation == mp.EnrichedCPDI2(where="all", hourglass=0.1)
    assert sim.boundaries[2] == mp.Fixed(mp.Surface("inner"))
    assert sim.loads[0] == mp.Pressure(mp.Surface("outer", "out"), 2e3, 0.01)
    assert isinstance(sim.loads[1], mp.Traction)
    assert sim.loads[1].per == "current"
    sim.run(0.01)
    assert abs(sim.ledger.latest.momentum[0]) > 1.0


def test_corners_and_regions_to_enrich():
    disc = '{ shape = "ball", centre = [1.0, 0.0], radius = 0.01 }'
    sim = ring(
        f'[[boundaries]]\nkind = "roller"\nnormal = [1.0, 1.0]\ncorners = {disc}',
        method=f'method = "enriched-cpdi2"\nwhere = {disc}\nlayers = 1',
    )
    assert len(sim.vertices.enriched) == 4
    # Later conditions win, so the slanted roller leaves the symmetry plane what is orthogonal to it.
    assert sim.engine.constraints.index.tolist().count(int(sim.engine.constraints.index.max())) >= 1


@pytest.mark.parametrize(
    ("boundary", "load", "method", "message"),
    [
        (
            '[[boundaries]]\nkind = "fixed"\nsurface = "iner"',
            "",
            "",
            r"^boundaries\.2 \(Fixed\): surface 'iner' does not exist",
        ),
        ('[[boundaries]]\nkind = "fixed"', "", "", "give one of plane, region, surface, corners"),
        ('[[boundaries]]\nkind = "symmetry"\nsurface = "inner"', "", "", "symmetry needs a plane"),
        ('[[boundaries]]\nkind = "roller"\nsurface = "inner"', "", "", "a surface needs a normal"),
        ("", '[[loads]]\nkind = "pressure"\nvalue = 1.0', "", "needs surface"),
        (
            "",
            '[[loads]]\nkind = "gravity"\nvalue = [0.0, 1.0]\n'
            '[[loads]]\nkind = "pressure"\nsurface = "iner"\nvalue = 1.0',
            "",
            r"^loads\.1 \(Pressure\): surface 'iner' does not exist",
        ),
        ("", '[[loads]]\nkind = "pressure"\nsurface = "inner"\nvalue = [1.0]', "", "one number"),
        ("", '[[loads]]\nkind = "traction"\nsurface = "inner"\nvalue = 1.0', "", "list of numbers"),
        ("", '[[loads]]\nkind = "traction"\nsurface = "inner"\nvalue = [1.0, 2.0, 3.0]', "", "2 axes"),
        ("", '[[loads]]\nkind = "pressure"\nsurface = "inner"\nvalue = 1.0\nper = "initial"', "", "per"),
        (
            "",
            '[[loads]]\nkind = "gravity"\nsurface = "inner"\nvalue = [0.0]',
            "",
            "only pressure and traction",
        ),
        ("", '[[loads]]\nkind = "gravity"\nvalue = 1.0', "", "a list is needed"),
        (
            "",
            '[[loads]]\nkind = "pressure"\nsurface = "inner"\nvalue = 1\nhistory = "log(t)"',
            "",
            "finite",
        ),
        ("", "", 'method = "enriched-cpdi2"\nwhere = "edges"', "where"),
        ("", "", 'method = "enriched-cpdi2"\nhourglass = 7.0', "hourglass"),
        ("", "", 'method = "ugimp"\nlayers = 1', "it has none; use enriched-cpdi2"),
        ('[[boundaries]]\nkind = "fixed"\nsurface = "inner"', "", 'method = "bspline2"', "use cpdi2"),
    ],
)
def test_what_is_refused(boundary, load, method, message):
    with pytest.raises(InputError, match=message) as caught:
        ring(boundary, load, method or 'method = "cpdi2"')
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("where", ["interfaces", "all"])
def test_an_enrichment_of_nothing_is_noted(where):
    notes = ring(method=f'method = "enriched-cpdi2"\nwhere = "{where}"').notes
    assert [note for note in notes if "no vertex lies between two materials" in note] == notes
    assert len(notes) == (where == "interfaces")


def test_the_schema_knows_surfaces():
    schema = CaseTable.model_json_schema()["$defs"]
    assert "surface" in schema["BoundaryTable"]["properties"]
    assert "pressure" in str(schema["LoadTable"])
    assert "hourglass" in schema["InterpolationTable"]["properties"]

from __future__ import annotations

import copy
import tomllib
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cases import SMALL
from matpoint.case import CaseTable, build_simulation, build_writers, bundled_cases, load, make_problem
from matpoint.case.load import Case, check
from matpoint.case.schema import ProblemTable
from matpoint.errors import InputError
from matpoint.interpolation import METHODS
from matpoint.materials import MATERIALS, NeoHookean
from matpoint.problems import PROBLEMS


@pytest.fixture
def case(tmp_path):
    path = tmp_path / "small.toml"
    path.write_text(SMALL)
    return str(path)


def refused(case, *changes):
    with pytest.raises(InputError) as caught:
        build_simulation(load(case, changes), threads=1)
    return str(caught.value)


@pytest.mark.parametrize(
    ("setting", "message"),
    [
        ("grid=3", "grid = 3: must be a table"),
        ("grid.cell=wide", "grid.cell = 'wide': must be a number or a list"),
        ("grid.lower=[nan, 0.0]", "grid.lower.0 = nan: must be a finite number"),
        ("bodies=[3]", "bodies.0 = 3: must be a table"),
        ("bodies.0.velocity=[true]", "bodies.0.velocity.0 = True: must be a number or a text"),
        ("bodies.0.per_cell=1.5", "bodies.0.per_cell = 1.5: must be a whole number or a list"),
        ("bodies.0.per_cell=[1,1,1,1]", "a list of at most 3"),
        ("bodies.0.region={}", "bodies.0.region.shape: this key is missing"),
        ("bodies.0.region={shape='bax'}", "shape = 'bax' (did you mean 'box'?); allowed are box, ball"),
        ("bodies.0.region={shape='box', lower=[0.0]}", "bodies.0.region.upper: this key is missing"),
        ("bodies.0.region={shape='union', of=[{shape='box', lower=[0.0], uper=[1.0]}, {shape='ball'}]}",
         "bodies.0.region.of.0.uper: unknown key (did you mean 'upper'?)"),
        ("bodies.0.velocity=[1.0, 2.0, 3.0]", "3 components given; the grid has 2 axes"),
        ("loads.0.value=[]", "loads.0.value = []: must be a list of 1 or more"),
        ("time.end=2020-01-01", "must be a number"),
        ("time.step=1e-300", "too many"),
        ("time.allow_unstable=1", "must be true or false"),
        ("scheme.transfer=flp", "scheme.transfer = 'flp' (did you mean 'flip'?)"),
        ("materials.rubber.E=true", "materials.rubber.E = True: must be a number"),
        ("materials.rubber.Nu=0.2", "did you mean 'nu'"),
        ("bodies.0.per_cell=100000", "this machine has"),
        ("grid.cell=1e-4", "this machine has"),
        ("interpolation.stretch=U", "interpolation.stretch: cpdi2 has no such option"),
        ("damping={kind='mass', factor=1.0}", "kind = 'mass' takes rate"),
        ("boundaries.0.region={shape='ball', centre=[0.0], radius=1.0}", "give one of plane, region"),
        ("boundaries.0.velocity=[1.0]", "only kind = 'velocity' has one"),
        ("boundaries.0.normal=[1.0]", "only kind = 'roller' has one"),
        ("boundaries.0.kind=velocity", "needs velocity"),
        ("loads.0={kind='body-force', value=['x'], ramp=1.0}", "ramp and history don't apply"),
        ("loads.0.value=[0.0, 0.0, -1.0]", "loads.0.value: gravity has 3 components; the grid has 2 axes"),
        ("loads.0.ramp=-1.0", "loads.0.ramp: "),
        ("boundaries.0.plane.axis=z", "boundaries.0.plane.axis = 'z': "),
        ("boundaries.0.plane.at=0.9", "boundaries.0.plane.at: "),
        ("boundaries.0={kind='fixed', region={shape='ball', centre=[0.1,0.1], radius=0.01}}",
         "boundaries.0 (Fixed): no node"),
        ("time={end=1.0, cfl=3.0}", "time.cfl: "),
        ("time={end=1.0, cfl=0.3, largest=-1.0}", "time.largest: "),
        ("time={end=1e12, cfl=0.3}", "in steps of about 0.00646419 s makes over 1e+12 steps"),
        ("time={end=1.0, cfl=1e-300}", "too many"),
        ("time.step=0.1", "time.step: "),
        ("time.sample_every=0", "time.sample_every = 0: must be greater than or equal to 1"),
        ("bodies.0.material='x'", "bodies.0.material = 'x'; there are rubber"),
        ("problem.name=bimaterial-bar", "grid: the problem gives it"),
    ],
)  # fmt: skip
def test_messages_name_the_place_the_value_and_what_is_allowed(case, setting, message):
    assert message in refused(case, setting)


@pytest.mark.parametrize(
    ("setting", "message"),
    [
        ("output.figures=[{colour='foo'}]", "output.figures.0.colour = 'foo'; allowed are von_mises, "),
        ("output.figures=[{colour='spede'}]", "(did you mean 'speed'?)"),
        ("output.figures=[{name=''}]", "output.figures.0.name = '': must be a text that is not empty"),
        ("output.figures=[{name='a/b'}]", "output.figures.0.name: "),
        ("output.figures=[{name='a', every_steps=2}, {name='a-001'}]", "1.name = 'a-001' is taken"),
        ("output.figures=[{name='a-001'}, {name='a', every_steps=2}]", "1.name = 'a' is taken"),
        ("output.figures=[{name='history'}]", "output.figures.0.name = 'history' is taken"),
        ("output.figures=[{name='a'}, {name='a', every_steps=2}]", "output.figures.1.name = 'a' is taken"),
        ("output.history.quantities=['kinetc_energy']",
         "output.history.quantities.0 = 'kinetc_energy' (did you mean 'kinetic_energy'?); see matpoint list"),
        ("output.history.probes.0.field=displacment", ".probes.0.field = 'displacment' (did you mean"),
        ("output.history.probes.0.component=xx", "output.history.probes.0.component = 'xx' "),
        ("output.history.probes.0.at=[0.1, 0.1]", "output.history.probes.0.at: probe 'foot': at = "),
        ("output.history.every_steps=0", "output.history.every_steps: "),
    ],
)  # fmt: skip
def test_messages_about_output_do_so_too(case, tmp_path, setting, message):
    def use():
        read = load(case, [setting])
        build_writers(read, tmp_path, build_simulation(read, threads=1))

    with pytest.raises(InputError) as caught:
        use()
    assert message in str(caught.value)


def test_problems_are_checked_too():
    assert "did you mean 'bimaterial-bar'" in refused("bimaterial-bar", "problem.name=bimaterial-ber")
    assert "did you mean 'stiff'" in refused("bimaterial-bar", "problem.stif=above")
    assert "dim" in refused("bimaterial-bar", "problem.dim=4")
    for setting in ("problem.dim=two", "problem.dim=true", "problem.stiff=3"):
        assert "problem" in refused("bimaterial-bar", setting) or "bimaterial" in refused(
            "bimaterial-bar", setting
        )
    assert make_problem(ProblemTable(name="bimaterial-bar")).name == "bimaterial-bar"


def test_the_same_constructors_as_python(case):
    sim = build_simulation(
        load(
            case, ["scheme={order='musl', transfer='flip', blend=0.9}", "damping={kind='local', factor=0.1}"]
        ),
        threads=1,
    )
    assert sim.materials == (NeoHookean(E=1e5, nu=0.3, density=1000.0),)
    assert (sim.scheme.name, sim.dim, len(sim.particles)) == ("musl", 2, 16)
    assert sim.dt == 1e-3


def test_velocities_and_forces_by_expression(case):
    changes = [
        "bodies.0.velocity=['0.1 * x', 'step(y - 0.75)']",
        "loads.0={kind='body-force', value=['X', '-t']}",
        "boundaries.0={kind='velocity', plane={axis='y', at=1.0}, velocity=['sin(t)', 'free']}",
    ]
    sim = build_simulation(load(case, changes), threads=1)
    x, v = sim.particles.position, sim.particles.velocity
    np.testing.assert_allclose(v[:, 0], 0.1 * x[:, 0])
    np.testing.assert_allclose(v[:, 1], x[:, 1] >= 0.75)
    sim.advance(sim.dt)
    assert "finite" in refused(case, "bodies.0.velocity=['1 / (x - x)']")


def test_every_shape_of_mesh_and_region(case):
    solid = "bodies.0={material='rubber', mesh="
    flat = (
        "{shape='box', lower=[0.25,0.25], upper=[0.75,0.75], divisions=[2,3]}",
        "{shape='annulus', inner=0.2, outer=0.4, divisions=[2,5], centre=[0.5,0.5]}",
        "{shape='arrays', kind='quad', vertices=[[0.25,0.5],[0.5,0.5],[0.5,0.75],[0.25,0.75]],"
        " cells=[[0,1,2,3]]}",
    )
    for mesh, number in zip(flat, (6, 10, 1), strict=True):
        sim = build_simulation(load(case, [f"{solid}{mesh}}}", "boundaries=[]"]), threads=1)
        assert len(sim.particles) == number
        drawn = f"{solid}{{shape='extrusion', base={mesh}, heights=[0.0,0.25,0.5]}}}}"
        box = ["grid.lower=[0.0,0.0,0.0]", "grid.upper=[1.0,1.0,1.0]", "boundaries=[]"]
        assert len(build_simulation(load(case, [drawn, *box]), threads=1).particles) == 2 * number
    ball, box = (
        "{shape='ball', centre=[0.5,0.5], radius=0.3}",
        "{shape='box', lower=[0.5,0.0], upper=[1.0,1.0]}",
    )
    regions = {
        ball: 16,
        f"{{shape='intersection', of=[{ball},{box}]}}": 8,
        f"{{shape='difference', of=[{ball},{box}]}}": 8,
        f"{{shape='union', of=[{ball},{box}]}}": 40,
        f"{{shape='intersection', of=[{ball},{{shape='half-space', point=[0.5,0.5], normal=[0.0,1.0]}}]}}": 8,
        "{shape='polygon', points=[[0.0,0.0],[1.0,0.0],[1.0,1.0]]}": None,
        "{shape='annulus', inner=0.2, outer=0.4, centre=[0.5,0.5]}": None,
    }
    for region, number in regions.items():
        sim = build_simulation(load(case, [f"bodies.0.region={region}", "boundaries=[]"]), threads=1)
        assert number is None or len(sim.particles) == number


@pytest.mark.parametrize("method", METHODS)
def test_every_method_by_name(case, method):
    sim = build_simulation(load(case, [f"interpolation.method={method}"]), threads=1)
    assert sim.interpolation.name == method


def test_the_schema_lists_what_editors_complete():
    schema = CaseTable.model_json_schema()
    parts = schema["$defs"]
    laws = parts["MaterialTable"]["anyOf"]
    assert {law["title"] for law in laws} == {*MATERIALS, "a plugin's law"}
    rubber = next(law for law in laws if law["title"] == "neo-hookean")
    assert set(rubber["required"]) == {"law", "E", "nu", "density"}
    assert parts["InterpolationTable"]["properties"]["method"]["enum"] == list(METHODS)
    assert parts["ProblemTable"]["properties"]["name"]["enum"] == list(PROBLEMS)
    assert "kinetic_energy" in parts["HistoryTable"]["properties"]["quantities"]["items"]["enum"]
    assert parts["GridTable"]["additionalProperties"] is False


# Random damage -----------------------------------------------------------------------------------

ODD = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(-3, 12),
    st.floats(),
    st.sampled_from(
        ["", "x", "free", "cpdi1", "mpm", "musl", "apic", "fixed", "roller", "symmetry", "1/x", "../a"]
    ),
    st.lists(st.one_of(st.floats(-2, 3), st.integers(0, 4), st.text(max_size=3)), max_size=4),
    st.dictionaries(st.sampled_from(["shape", "kind", "at", "axis", "x"]), st.floats(-1, 1), max_size=2),
)


def _places(content, path=()):
    yield path
    items = (
        content.items()
        if isinstance(content, dict)
        else enumerate(content)
        if isinstance(content, list)
        else ()
    )
    for key, value in items:
        yield from _places(value, (*path, key))


@st.composite
def damaged(draw, texts):
    content = tomllib.loads(draw(st.sampled_from(texts)))
    for _ in range(draw(st.integers(1, 3))):
        path = draw(st.sampled_from([p for p in _places(content) if p] or [("title",)]))
        holder = content
        for step in path[:-1]:
            holder = holder[step]
        change = draw(st.sampled_from(["replace", "replace", "replace", "drop", "rename", "double"]))
        if change == "replace":
            holder[path[-1]] = draw(ODD)
        elif change == "drop":
            del holder[path[-1]]
        elif change == "double" and isinstance(holder, list):
            holder.append(copy.deepcopy(holder[path[-1]]))
        elif change == "rename" and isinstance(holder, dict):
            holder[draw(st.text(max_size=4))] = holder.pop(path[-1])
    return content


def outcome(function):
    """The message of a refusal, or "works"; any other exception is a failure of the test."""
    try:
        # Speeds of 1e200 m/s may overflow in sums: that is no crash.
        with np.errstate(all="ignore"):
            function()
    except InputError as error:
        return str(error).rstrip()
    return "works"


def test_a_key_that_breaks_the_line_is_shown_on_one():
    for content in ({"\n": 1}, {"time": {"a\nb": 1}}):
        assert "\n" not in outcome(lambda content=content: check(content, "case"))


@settings(max_examples=400)
@given(content=damaged([SMALL, *bundled_cases().values()]))
def test_a_damaged_case_works_or_is_refused(content, tmp_path_factory):
    folder = Path(tmp_path_factory.getbasetemp()) / "never"

    def use():
        case = Case("damaged", check(content, "damaged"))
        build_simulation(case, threads=1)
        build_writers(case, folder)

    said = outcome(use)
    assert said
    assert "\n" not in said
    assert not folder.exists()


@settings(max_examples=200)
@given(data=st.data())
def test_damaged_text_works_or_is_refused(data, tmp_path_factory):
    path = Path(tmp_path_factory.getbasetemp()) / "text.toml"
    text = data.draw(st.sampled_from([SMALL, *bundled_cases().values()]))
    start = data.draw(st.integers(0, len(text)))
    end = min(len(text), start + data.draw(st.integers(0, 12)))
    path.write_text(text[:start] + data.draw(st.text(max_size=6)) + text[end:], encoding="utf-8", newline="")
    assert "\n" not in outcome(lambda: load(str(path)))

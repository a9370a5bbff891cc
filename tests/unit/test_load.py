from __future__ import annotations

import pytest

from cases import SMALL
from matpoint.case import bundled_cases, load
from matpoint.errors import InputError


@pytest.fixture
def case(tmp_path):
    path = tmp_path / "small.toml"
    path.write_text(SMALL)
    return str(path)


def test_a_file_and_a_bundled_name(case):
    read = load(case)
    assert (read.name, read.tables.title) == ("small", "A block that falls")
    assert read.tables.grid is not None
    assert read.tables.grid.cell == 0.25
    problems = {"bimaterial-bar", "inclusion", "sphere-inclusion"}
    assert set(bundled_cases()) == problems | {"cantilever", "two-discs", "vertical-bar"}
    for name in bundled_cases():
        assert load(name).name == name


@pytest.mark.parametrize(
    ("setting", "path", "value"),
    [
        ("time.end=2", ("time", "end"), 2.0),
        (" time . end = 2.5 ", ("time", "end"), 2.5),
        ("title=bare words", ("title",), "bare words"),
        ('title="quoted = too"', ("title",), "quoted = too"),
        ("title=a=b", ("title",), "a=b"),
        ("title=1\ntime = 3", ("title",), "1\ntime = 3"),  # one value, never more keys
        ("bodies.0.per_cell=3", ("bodies", 0, "per_cell"), 3),
        ("bodies.0.per_cell=[3, 2]", ("bodies", 0, "per_cell"), [3, 2]),
        ("bodies.0.region.upper=[0.5, 1.0]", ("bodies", 0, "region", "upper"), [0.5, 1.0]),
        ("scheme.order=musl", ("scheme", "order"), "musl"),
        ("damping={kind='mass', rate=3.0}", ("damping", "rate"), 3.0),
        ("output.checkpoint.every_steps=20", ("output", "checkpoint", "every_steps"), 20),
    ],
)
def test_overrides(case, setting, path, value):
    found = load(case, [setting]).tables
    for step in path:
        found = found[step] if isinstance(step, int) else getattr(found, step)
    assert found == value


def test_the_last_override_wins(case):
    assert load(case, ["time.end=1", "time.end=2"]).tables.time.end == 2.0


@pytest.mark.parametrize(
    ("setting", "message"),
    [
        ("time", "write it as table.key=value"),
        ("=3", "write it as table.key=value"),
        ("time..end=3", "write it as table.key=value"),
        ("time.end.more=3", "lies below a value"),
        ("bodies.first.per_cell=3", "'first' must be a number from 0 to 0"),
        ("bodies.1.per_cell=3", "from 0 to 0"),
        ("bodies.-1.per_cell=3", "from 0 to 0"),
        ("bodies.².per_cell=3", "from 0 to 0"),
        ("output.figures.0.colour=speed", "output.figures = .*: must be a list"),
        ("tiem.end=3", r"tiem: unknown key \(did you mean 'time'\?\)"),
        ("bodies.0.percell=3", "did you mean 'per_cell'"),
        (
            "bodies.0.region.radius=3.0",
            "bodies.0.region.radius: unknown key; allowed are lower, shape, upper",
        ),
    ],
)
def test_overrides_that_lead_nowhere(case, setting, message):
    with pytest.raises(InputError, match=message):
        load(case, [setting])


def test_what_is_no_case(tmp_path):
    with pytest.raises(
        InputError, match=r"neither a file nor a bundled case \(did you mean 'cantilever'\?\)"
    ):
        load("cantilver")
    with pytest.raises(InputError, match="neither a file"):
        load(str(tmp_path))
    with pytest.raises(InputError):
        load("nul\0byte")
    bad = tmp_path / "bad.toml"
    bad.write_text('title = "x"\n[grid\n')
    with pytest.raises(InputError, match=r"not valid TOML \(.*line 2"):
        load(str(bad))
    bad.write_text("")
    with pytest.raises(InputError, match="interpolation: this key is missing"):
        load(str(bad))
    bad.write_text("a = " + "[" * 5000 + "]" * 5000)
    with pytest.raises(InputError, match="not valid TOML"):
        load(str(bad))
    bad.write_text('title = "a"\ntitle = "b"\n')
    with pytest.raises(InputError, match="not valid TOML"):
        load(str(bad))

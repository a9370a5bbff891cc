"""What a restart must agree with, and what it may change."""

from __future__ import annotations

import functools
import subprocess
import sys

import pytest

import matpoint as mp
from matpoint.fingerprint import identity, spelled
from runs import RUBBER, SOFT


def law(F, F_new, L, dt, state, params):
    return ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))


def other(F, F_new, L, dt, state, params):
    return ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))


def push(x, t):
    return 0.0 * x[:, 0]


def own(function=law, bulk=1.0):
    return mp.UserMaterial(function, {"bulk": bulk}, 1000.0, modulus=1e5)


def sim(material=RUBBER, *, upper=1.0, name="a", **changes):
    given = {
        "interpolation": mp.Linear(), "timestep": mp.FixedStep(1e-4), "threads": 1,
        "boundaries": [mp.Fixed(mp.Plane("x", 0.0))],
    } | changes  # fmt: skip
    body = mp.Body(mp.Box((0.0, 0.0), (upper, 0.5)), material, name=name)
    return mp.Simulation(mp.Grid((0.0, 0.0), (2.0, 1.0), 0.25), [body], **given)


@pytest.mark.parametrize(
    ("one", "two", "differ"),
    [
        ({}, {}, set()),
        ({}, {"timestep": mp.FixedStep(5e-5)}, set()),
        ({}, {"loads": [mp.Gravity((0.0, -1.0))]}, set()),
        ({"material": own()}, {"material": own()}, set()),
        ({"material": own()}, {"material": own(other)}, {"materials"}),
        ({"material": own()}, {"material": own(bulk=2.0)}, {"materials"}),
        ({}, {"material": SOFT}, {"materials", "particles"}),
        ({}, {"upper": 1.25}, {"particles"}),
        ({}, {"name": "b"}, {"bodies"}),
        ({}, {"damping": mp.LocalDamping(0.1)}, {"damping"}),
        ({}, {"boundaries": []}, {"boundaries"}),
        ({}, {"boundaries": [mp.Fixed(mp.Plane("x", 0.25, "lower"))]}, {"boundaries"}),
        ({}, {"boundaries": [mp.PrescribedVelocity(mp.Plane("x", 0.0), (push, None))]}, {"boundaries"}),
        ({}, {"interpolation": mp.UGIMP()}, {"interpolation"}),
        ({}, {"scheme": mp.MUSL()}, {"scheme"}),
    ],
)
def test_what_must_agree(one, two, differ):
    a, b = identity(sim(**one)), identity(sim(**two))
    assert {name for name in a if a[name] != b[name]} == differ


def test_a_restart_says_what_differs(tmp_path):
    first, path = sim(own()), tmp_path / "c.h5"
    first.run(5e-4, [mp.Checkpoint(path, mp.EverySteps(5))])
    again = sim(own(), loads=[mp.Gravity((0.0, -1.0))])
    mp.resume(again, path)
    assert again.step == 5
    with pytest.raises(mp.InputError, match="materials, damping differ"):
        mp.resume(sim(own(bulk=3.0), damping=mp.MassDamping(1.0)), path)


def test_texts_hold_no_addresses_and_are_those_of_another_process():
    things = [own(), functools.partial(push, t=1.0), lambda x: x, push, RUBBER, mp.Ball((0.0, 0.0), 1.0)]
    for thing in things:
        text = spelled(thing)
        assert "0x" not in text
        assert "mappingproxy" not in text
    assert spelled(own()).startswith("UserMaterial(function=law, parameters={bulk=1.0}, density=1000.0")
    assert spelled(RUBBER) == repr(RUBBER)
    script = "from test_fingerprint import *; print(sim(own()).fingerprint())"
    env = [p for p in sys.path if p]
    code = f"import sys; sys.path[:0] = {env!r}; {script}"
    done = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
    assert done.stdout.strip() == sim(own()).fingerprint()

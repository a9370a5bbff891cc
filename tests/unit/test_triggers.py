"""Triggers: no event lost or doubled over long runs."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from matpoint import AtTimes, EverySteps, EveryTime, InputError


def _events(trigger, dt, steps):
    """Steps at which it is due when time is accumulated the way a run does."""
    previous, time, found = -math.inf, 0.0, []
    for step in range(steps + 1):
        if trigger.due(step, time, previous):
            found.append(step)
        previous, time = time, time + dt
    return found


def test_every_steps():
    assert _events(EverySteps(3), 0.1, 10) == [0, 3, 6, 9]


@given(st.sampled_from([1e-5, 5e-5, 1e-3, 0.1]), st.integers(1, 50))
def test_every_time_is_due_once_an_interval(dt, every):
    assert _events(EveryTime(every * dt), dt, 400) == list(range(0, 401, every))


def test_every_time_over_a_hundred_thousand_steps():
    assert len(_events(EveryTime(0.01), 1e-5, 100_000)) == 101


def test_every_time_with_steps_longer_than_the_interval():
    assert _events(EveryTime(0.1), 0.25, 4) == [0, 1, 2, 3, 4]


def test_at_times_fires_once_each():
    assert _events(AtTimes((0.0, 0.14, 0.5)), 5e-5, 10_001) == [0, 2800, 10_000]
    assert _events(AtTimes((0.12, 0.14)), 0.1, 5) == [2]


@pytest.mark.parametrize("n", [0, -1, 1.5, True])
def test_bad_steps(n):
    with pytest.raises(InputError, match="every_steps"):
        EverySteps(n)


@pytest.mark.parametrize("interval", [0.0, -1.0, math.nan, math.inf])
def test_bad_interval(interval):
    with pytest.raises(InputError, match="every_time"):
        EveryTime(interval)


@pytest.mark.parametrize("times", [(), (-1.0,), (math.nan,)])
def test_bad_times(times):
    with pytest.raises(InputError, match="at ="):
        AtTimes(times)

"""Teams of threads: every piece once, in their order where it counts, and no thread left behind."""

from __future__ import annotations

import gc
import os
import signal
import threading
import time

import numpy as np
import pytest

from matpoint.threads import Team, available_threads

LONG = 100_000  # items, enough to be worth several threads


def helpers() -> int:
    """Return how many helping threads there are."""
    return sum(one.name == "matpoint" for one in threading.enumerate())


@pytest.mark.parametrize("threads", [1, 2, 3, 5])
def test_each_item_once_and_results_in_order(threads):
    team, seen = Team(threads), np.zeros(LONG, dtype=int)

    def piece(a: int, b: int) -> int:
        seen[a:b] += 1
        return a

    found = team.split(LONG, piece)
    assert found == sorted(found)
    assert (seen == 1).all()
    team.close()


@pytest.mark.parametrize("threads", [2, 3, 5])
def test_an_odd_slab_waits_for_its_even_neighbours(threads):
    team, count = Team(threads), 41
    pointer = np.arange(count + 1) * LONG
    started, ended = np.full(count, np.inf), np.full(count, -np.inf)

    def call(slabs: np.ndarray, a: int, b: int) -> None:
        for k in slabs[a:b]:
            started[k] = time.perf_counter()
            time.sleep(0.001 * (k % 3))
            ended[k] = time.perf_counter()

    team.coloured(pointer, call)
    assert np.isfinite(ended).all()
    assert (started[1::2] >= ended[0:-1:2]).all()
    assert (started[1:-1:2] >= ended[2::2]).all()
    team.close()


@pytest.mark.parametrize("threads", [1, 2, 3])
def test_the_fault_of_the_earliest_piece_is_raised_after_all_have_ended(threads):
    team, ended = Team(threads), []

    def call(k: int, a: int, b: int) -> None:
        if k in (2, 3):
            raise ValueError(k)
        time.sleep(0.002)
        ended.append(k)

    pieces = [(k, k + 1) for k in range(6)]
    with pytest.raises(ValueError, match="2"):
        team.map(call, pieces, after=[[], [], [], [2], [2, 3], [4]])
    if threads > 1:
        assert sorted(ended) == [0, 1, 4, 5]
    assert team.map(lambda k, a, b: k, pieces) == list(range(6))  # and it goes on
    team.close()


@pytest.mark.skipif(not hasattr(os, "sched_getaffinity"), reason="the system binds no threads")
def test_the_calling_thread_may_go_where_it_might_before():
    team, before = Team(max(2, available_threads())), os.sched_getaffinity(0)
    team.split(LONG, lambda a, b: None)
    assert os.sched_getaffinity(0) == before
    team.close()


@pytest.mark.skipif(not hasattr(os, "sched_getaffinity"), reason="the system binds no threads")
def test_a_system_that_binds_no_threads_runs_them_all_the_same(monkeypatch):
    def refuse(*_):
        raise PermissionError

    monkeypatch.setattr(os, "sched_setaffinity", refuse)
    team = Team(max(2, available_threads()))
    assert sum(team.split(LONG, lambda a, b: b - a)) == LONG
    team.close()


def test_a_team_goes_on_after_interrupts_at_any_moment():
    team, stop, armed = Team(3), threading.Event(), [False]
    pointer = np.arange(22) * LONG

    def handle(*_) -> None:
        if armed[0]:  # once a round, and never outside of one
            armed[0] = False
            raise KeyboardInterrupt

    def kick() -> None:
        rng = np.random.default_rng(3)
        while not stop.is_set():
            time.sleep(rng.uniform(0.0, 0.004))
            signal.raise_signal(signal.SIGINT)  # Python runs the handler in the main thread

    before = signal.signal(signal.SIGINT, handle)
    kicker = threading.Thread(target=kick, daemon=True)
    kicker.start()
    caught, end = 0, time.monotonic() + 1.0
    while time.monotonic() < end:
        try:
            armed[0] = True
            team.split(LONG, lambda a, b: time.sleep(3e-4))
            team.coloured(pointer, lambda slabs, a, b: time.sleep(2e-4))
            armed[0] = False
        except KeyboardInterrupt:
            caught += 1
    stop.set()
    kicker.join()
    signal.signal(signal.SIGINT, before)
    assert caught > 20
    assert sum(team.split(LONG, lambda a, b: b - a)) == LONG
    team.close()


def test_helpers_end_with_their_team():
    gc.collect()
    before = helpers()
    team = Team(4)
    assert helpers() == before + 3
    team.split(LONG, lambda a, b: None)
    del team
    gc.collect()
    assert helpers() == before

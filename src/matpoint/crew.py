"""Threads that help the one that calls, woken by a lock each.

The caller does its share of the work: one wake-up less, and what is short it has done before a helper is
awake. A pool of futures takes half as long again for each round.
"""

from __future__ import annotations

import os
import threading
import weakref
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress

_PATIENCE = 0.1  # seconds, then a helper is woken once more


class _Helper:
    """A thread that sleeps until it is given something to call.

    What it owes is ``asked - done``. Locks only wake: one wake-up too many does no harm, and a lost one (an
    interrupt may come anywhere in the caller) is made good by the caller's waiting.
    """

    def __init__(self, processor: int | None) -> None:
        self._processor = processor
        self._call: Callable[[], None] | None = None
        self._asked, self._done = 0, 0
        self._wake, self._ended = threading.Lock(), threading.Lock()
        self._wake.acquire()
        self._ended.acquire()
        self._thread = threading.Thread(target=self._work, name="matpoint", daemon=True)
        self._thread.start()

    def begin(self, call: Callable[[], None] | None) -> None:
        """Let it call, or end if there is nothing to call."""
        self.wait()
        self._call = call
        self._asked += 1
        _signal(self._wake)

    def wait(self) -> None:
        """Wait until it owes nothing."""
        while self._done != self._asked:
            if not self._ended.acquire(timeout=_PATIENCE):
                _signal(self._wake)

    def join(self) -> None:
        """Wait for its end."""
        self._thread.join()

    def _work(self) -> None:
        if self._processor is not None:
            with suppress(OSError):  # a processor that was taken away meanwhile
                os.sched_setaffinity(0, {self._processor})
        while True:
            self._wake.acquire()
            if self._done == self._asked:
                continue
            call, self._call = self._call, None  # not to be kept alive while this thread sleeps
            try:
                if call is None:
                    return
                call()
            finally:
                del call
                self._done += 1
                _signal(self._ended)


def _signal(lock: threading.Lock) -> None:
    """Release a lock that may be free already."""
    with suppress(RuntimeError):
        lock.release()


def _stop(helpers: list[_Helper]) -> None:
    while helpers:
        one = helpers.pop()
        one.begin(None)
        one.join()


class Crew:
    """Helpers, and the thread that calls.

    Parameters
    ----------
    helpers
        How many threads there are beside the one that calls.
    bind
        Keep each on a processor of its own while it works. They are woken for a millisecond at a time, many
        times a step; some schedulers wake them where the one that wakes them runs, and then all share one
        processor for good.
    """

    def __init__(self, helpers: int, bind: bool) -> None:
        places: list[int | None] = [None] * helpers
        self._place: set[int] = set()  # the caller's
        if bind and hasattr(os, "sched_setaffinity"):
            allowed = sorted(os.sched_getaffinity(0))
            self._place = {allowed[0]}
            places = [allowed[(k + 1) % len(allowed)] for k in range(helpers)]
        self._helpers = [_Helper(place) for place in places]
        self._end = weakref.finalize(self, _stop, self._helpers)

    def run(self, call: Callable[[], None], most: int) -> None:
        """Call ``call()`` here and on helpers, ``most`` times in all, and wait for all of them.

        What is raised here is raised; a helper must not raise anything.
        """
        helpers = self._helpers[: most - 1]
        with self._at_its_place():
            try:
                for one in helpers:
                    one.begin(call)
                call()
            finally:
                _wait(helpers)

    @contextmanager
    def _at_its_place(self) -> Iterator[None]:
        """Bind the calling thread, and let it go where it was allowed to: it is the user's."""
        if not self._place:
            yield
            return
        allowed = os.sched_getaffinity(0)
        try:
            os.sched_setaffinity(0, self._place)
        except OSError:  # not to be had any more, or never: then the system chooses
            self._place = set()
        try:
            yield
        finally:
            if self._place:
                os.sched_setaffinity(0, allowed)

    def close(self) -> None:
        """End the helpers."""
        self._end()


def _wait(helpers: list[_Helper]) -> None:
    """Wait for helpers; an interrupt is raised when all have stopped, since arrays are in use until then."""
    late: KeyboardInterrupt | None = None
    while True:
        try:
            for one in helpers:
                one.wait()
            break
        except KeyboardInterrupt as interrupt:
            late = interrupt
    if late is not None:
        raise late

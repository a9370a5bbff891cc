"""Running kernels on several threads, with bit-for-bit the same result for any number of them.

Kernels release the GIL, so plain threads run them side by side. Loops over particles, vertices
and nodes write to their own entry only and may be cut anywhere. Scatters run slab by slab, each odd
slab after its even neighbours (see ``kernels.locate``).
"""

from __future__ import annotations

import os
import threading
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from itertools import pairwise
from typing import Any

import numpy as np

from matpoint.crew import Crew
from matpoint.errors import InputError

_WORTH_IT = 16384  # below this many items, of 10 to 30 ns each, waking threads costs more than they bring
_SPARE = 4  # pieces for each thread
_SHORTEST = 4096  # items of a piece
BLOCK = 8192  # particles whose sum is made by one thread, in order; sums of blocks are added in order


def available_threads() -> int:
    """Return the number of processors this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def lowest(found: Iterable[int]) -> int:
    """Return the lowest of the indices that pieces found, or -1 if all are negative: nothing found."""
    return min((index for index in found if index >= 0), default=-1)


class Team:
    """A fixed number of threads.

    Parameters
    ----------
    threads
        How many; None takes all processors that the process may use.

    Raises
    ------
    InputError
        If the number is not between 1 and 1024.
    """

    def __init__(self, threads: int | None = None) -> None:
        count = available_threads() if threads is None else threads
        if isinstance(count, bool) or not isinstance(count, int) or not 1 <= count <= 1024:
            raise InputError(f"threads = {threads!r} must be a whole number from 1 to 1024")
        self.threads = count
        self._own = threading.local()
        # Bound if they are to fill all processors; fewer are left to the system, which knows what else runs.
        self._crew = Crew(count - 1, bind=count == available_threads()) if count > 1 else None

    def pieces(self, count: int, most: int | None = None, each: int = 1) -> list[tuple[int, int]]:
        """Cut range(count) into pieces, no more than ``most``; one if it is short.

        There are more than threads, so that one that is held up does not keep the others waiting. ``each``
        is how many small things one of the count is.
        """
        if self._crew is None or count * each < _WORTH_IT:
            return [(0, count)]
        wanted = max(self.threads, min(_SPARE * self.threads, count * each // _SHORTEST))
        edges = np.linspace(0, count, min(wanted, most or wanted) + 1).astype(int)
        return [(a, b) for a, b in pairwise(edges.tolist()) if a < b]

    def map(
        self,
        call: Callable[[int, int, int], Any],
        pieces: list[tuple[int, int]],
        after: Sequence[Sequence[int]] = (),
    ) -> list[Any]:
        """Call ``call(number, start, stop)`` for each piece; return the results in order.

        Piece k begins when the pieces ``after[k]``, all of them earlier ones, have ended.
        """
        if self._crew is None or len(pieces) == 1:
            return [call(k, a, b) for k, (a, b) in enumerate(pieces)]
        results: list[Any] = [None] * len(pieces)
        faults: list[tuple[int, BaseException]] = []
        turn = iter(range(len(pieces)))  # whoever is free takes the next one
        going = [threading.Lock() for _ in after]
        for lock in going:
            lock.acquire()

        def work() -> None:
            try:
                for k in turn:
                    try:
                        for earlier in after[k] if after else ():
                            with going[earlier]:
                                pass
                        results[k] = call(k, *pieces[k])
                    except BaseException as fault:
                        faults.append((k, fault))
                    finally:
                        if going:
                            going[k].release()
            except BaseException as interrupt:  # between two pieces: nobody must wait for one of them
                faults.append((len(pieces), interrupt))
                for lock in going:
                    with suppress(RuntimeError):
                        lock.release()

        self._crew.run(work, min(self.threads, len(pieces)))
        if faults:
            raise min(faults, key=lambda found: found[0])[1]
        return results

    def split(self, count: int, call: Callable[[int, int], Any], each: int = 1) -> list[Any]:
        """Call ``call(start, stop)`` on the pieces of range(count); return the results in order."""
        return self.map(lambda _, a, b: call(a, b), self.pieces(count, each=each))

    def scratch(self, *shape: int) -> np.ndarray:
        """Return an array of the calling thread's own, with anything in it: the same one every time."""
        held = self._own.__dict__.setdefault("arrays", {})
        if shape not in held:
            held[shape] = np.empty(shape)
        return held[shape]

    def sums(self, count: int, width: int, call: Callable[[int, int, int, np.ndarray], Any]) -> np.ndarray:
        """Return sums over range(count), shape (width,): to the last bit the same for any threads.

        ``call(start, stop, block, sums)`` puts the sums of each block of ``block`` items into its own row
        of ``sums``.
        """
        sums = np.zeros((-(-count // BLOCK), width))
        self.blocks(count, lambda a, b: call(a, b, BLOCK, sums))
        return sums.sum(axis=0)

    def blocks(self, count: int, call: Callable[[int, int], Any]) -> list[Any]:
        """As :meth:`split`, with pieces that begin at multiples of ``BLOCK``."""
        pieces = [(a * BLOCK, min(b * BLOCK, count)) for a, b in self.pieces(-(-count // BLOCK), each=BLOCK)]
        return self.map(lambda _, a, b: call(a, b), pieces)

    def coloured(self, pointer: np.ndarray, call: Callable[[np.ndarray, int, int], Any]) -> None:
        """Call ``call(slabs, start, stop)`` over the even slabs, and over each odd one after its neighbours.

        Slab k is pointer[k]:pointer[k + 1].
        """
        slabs = np.arange(len(pointer) - 1)
        even, odd = slabs[::2], slabs[1::2]
        if self._crew is None or pointer[-1] < _WORTH_IT:
            call(even, 0, len(even))
            call(odd, 0, len(odd))
            return
        first, second = (self._shares(pointer[some + 1] - pointer[some]) for some in (even, odd))
        # The neighbours of odd slab j are even slabs j and j + 1.
        after = [[k for k, (c, d) in enumerate(first) if c <= b and a < d] for a, b in second]
        self.map(
            lambda k, a, b: call(even if k < len(first) else odd, a, b),
            first + second,
            [[]] * len(first) + after,
        )

    def _shares(self, load: np.ndarray) -> list[tuple[int, int]]:
        """Cut things of some load into pieces, ``_SPARE`` for each thread, as equal as they can be."""
        done = np.cumsum(load)
        shares = np.linspace(0, done[-1] if len(done) else 0, _SPARE * self.threads + 1)[1:-1]
        edges = [0, *np.searchsorted(done, shares).tolist(), len(load)]
        return [(a, b) for a, b in pairwise(edges) if a < b]

    def close(self) -> None:
        """End the threads."""
        if self._crew is not None:
            self._crew.close()

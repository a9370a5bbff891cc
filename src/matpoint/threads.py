"""Running kernels on several threads, with bit-for-bit the same result for any number of them.

Kernels release the GIL, so plain threads run them side by side. Loops over particles, vertices
and nodes write to their own entry only and may be cut anywhere. Scatters run slab by slab, first
the even slabs, then the odd ones (see ``kernels.locate``).
"""

from __future__ import annotations

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor, wait
from itertools import pairwise
from typing import Any

import numpy as np

from matpoint.errors import InputError

_WORTH_IT = 2048  # below this many items a thread costs more than it brings


def available_threads() -> int:
    """Return the number of processors this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


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
        self._pool = ThreadPoolExecutor(count - 1) if count > 1 else None  # the caller is one of them

    def pieces(self, count: int, most: int | None = None, each: int = 1) -> list[tuple[int, int]]:
        """Cut range(count) into a piece for each thread, but no more than ``most``; one if it is short.

        ``each`` is how many small things one of the count is.
        """
        if self._pool is None or count * each < _WORTH_IT:
            return [(0, count)]
        edges = np.linspace(0, count, min(self.threads, most or self.threads) + 1).astype(int)
        return [(a, b) for a, b in pairwise(edges.tolist()) if a < b]

    def map(self, call: Callable[[int, int, int], Any], pieces: list[tuple[int, int]]) -> list[Any]:
        """Call ``call(number, start, stop)`` for each piece; return the results in order."""
        if self._pool is None or len(pieces) == 1:
            return [call(k, a, b) for k, (a, b) in enumerate(pieces)]
        results: list[Any] = [None] * len(pieces)
        turn = iter(range(len(pieces)))  # whoever is free takes the next one; the caller works too

        def work() -> None:
            for k in turn:
                results[k] = call(k, *pieces[k])

        others = [self._pool.submit(work) for _ in range(min(self.threads, len(pieces)) - 1)]
        try:
            work()
        finally:
            wait(others)
        for other in others:
            other.result()
        return results

    def split(self, count: int, call: Callable[[int, int], Any], each: int = 1) -> list[Any]:
        """Call ``call(start, stop)`` on the pieces of range(count); return the results in order."""
        return self.map(lambda _, a, b: call(a, b), self.pieces(count, each=each))

    def coloured(self, pointer: np.ndarray, call: Callable[[np.ndarray, int, int], Any]) -> None:
        """Call ``call(slabs, start, stop)`` over the even slabs, then over the odd ones."""
        for colour in (0, 1):
            slabs = np.arange(colour, len(pointer) - 1, 2)
            if self._pool is None or pointer[-1] < _WORTH_IT:
                call(slabs, 0, len(slabs))
                continue
            load = np.cumsum(pointer[slabs + 1] - pointer[slabs])
            # Twice as many pieces as threads evens out what the counts do not show.
            shares = np.linspace(0, load[-1] if len(load) else 0, 2 * self.threads + 1)[1:-1]
            edges = [0, *np.searchsorted(load, shares).tolist(), len(slabs)]
            pieces = [(a, b) for a, b in pairwise(edges) if a < b]
            self.map(lambda _, a, b, slabs=slabs: call(slabs, a, b), pieces)

    def close(self) -> None:
        """End the threads."""
        if self._pool is not None:
            self._pool.shutdown()

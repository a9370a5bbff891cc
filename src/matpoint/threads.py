"""Running kernels on several threads, with bit-for-bit the same result for any number of them.

Kernels release the GIL, so plain threads run them side by side. Loops over particles, vertices
and nodes write to their own entry only and may be cut anywhere. Scatters run slab by slab, first
the even slabs, then the odd ones (see ``kernels.locate``).
"""

from __future__ import annotations

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from itertools import pairwise
from typing import Any

import numpy as np

from matpoint.errors import InputError

_WORTH_IT = 2048  # below this many items a thread costs more than it brings
BLOCK = 8192  # particles whose sum is made by one thread, in order; sums of blocks are added in order


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
        self._pool = ThreadPoolExecutor(count) if count > 1 else None

    def split(self, count: int, call: Callable[[int, int], Any]) -> list[Any]:
        """Call ``call(start, stop)`` on pieces of range(count); return the results in order."""
        if self._pool is None or count < _WORTH_IT:
            return [call(0, count)]
        edges = np.linspace(0, count, self.threads + 1).astype(int)
        return self._map(call, list(pairwise(edges.tolist())))

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
        edges = np.linspace(0, -(-count // BLOCK), self.threads + 1).astype(int) * BLOCK
        pieces = [(a, min(b, count)) for a, b in pairwise(edges.tolist()) if a < b]
        if self._pool is None or len(pieces) < 2:
            return [call(0, count)]
        return self._map(call, pieces)

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
            self._map(lambda a, b, slabs=slabs: call(slabs, a, b), pieces)

    def _map(self, call: Callable[[int, int], Any], pieces: list[tuple[int, int]]) -> list[Any]:
        assert self._pool is not None
        futures = [self._pool.submit(call, a, b) for a, b in pieces]
        return [future.result() for future in futures]

    def close(self) -> None:
        """End the threads."""
        if self._pool is not None:
            self._pool.shutdown()

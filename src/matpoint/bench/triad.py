"""Memory bandwidth by a triad: a_i = b_i + s c_i over arrays far larger than any cache."""

from __future__ import annotations

import time

import numpy as np

from matpoint.jit import kernel
from matpoint.threads import Team

BYTES = 24  #: an element: two reads and a write; the read that a write may cause first is not counted


@kernel
def triad(a, b, c, s, start, stop):
    """A = b + s c for the elements start:stop."""
    for i in range(start, stop):
        a[i] = b[i] + s * c[i]


def triad_gbs(threads: int, elements: int = 16_000_000, rounds: int = 5) -> float:
    """Return the bandwidth [GB/s, 1e9 bytes] of the fastest round.

    Parameters
    ----------
    threads
        How many run side by side.
    elements
        Of each of the three arrays, float64; 16 million are 128 MB.
    rounds
        Passes; one more comes first and touches all memory.
    """
    team = Team(threads)
    a, b, c = np.zeros(elements), np.ones(elements), np.full(elements, 2.0)
    best = np.inf
    for k in range(rounds + 1):
        begin = time.perf_counter()
        team.split(elements, lambda start, stop: triad(a, b, c, 0.5, start, stop))
        seconds = time.perf_counter() - begin
        best = min(best, seconds) if k else best
    team.close()
    return BYTES * elements / best / 1e9

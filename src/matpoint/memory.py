"""Memory that is free, and refusing what can't fit into it."""

from __future__ import annotations

import ctypes
import math
import os
from contextlib import suppress

from matpoint.errors import InputError

# Rough bytes of a node's record and of a particle with its vertices, rows and temporary arrays.
_PER_NODE, _PER_PARTICLE = 64.0, 1000.0


def free_memory() -> float:
    """Return the bytes that this process may take now: those free, or a limit set below them.

    Where the system does not tell what is free it is all that the machine has.
    """
    try:
        import resource  # noqa: PLC0415 (not on Windows)

        limit = float(resource.getrlimit(resource.RLIMIT_AS)[0])
    except (ImportError, OSError):
        limit = -1.0
    return min(_machine(), limit if limit > 0 else math.inf)


def _machine() -> float:
    try:
        with open("/proc/meminfo", encoding="ascii") as file:
            for line in file:
                if line.startswith("MemAvailable:"):
                    return 1024.0 * float(line.split()[1])
    except (OSError, ValueError, IndexError):
        pass
    try:
        return float(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))
    except (AttributeError, ValueError, OSError):
        return math.inf


def give_back() -> None:
    """Give memory that nothing uses any more back to the system, where the C library can (glibc).

    It keeps what has been freed in pieces below 32 MB for the next request, which after setting up a million
    particles is a tenth of all that they need.
    """
    with suppress(OSError, AttributeError, TypeError):
        ctypes.CDLL(None).malloc_trim(0)


def refuse_size(
    where: str, nodes: float, particles: float, cure: str, per_particle: float = _PER_PARTICLE
) -> None:
    """Refuse numbers of nodes and particles that need more memory than is free.

    Parameters
    ----------
    where
        What needs them.
    nodes, particles
        How many.
    cure
        What would help.
    per_particle
        Bytes of a particle.

    Raises
    ------
    InputError
        With the sizes, the memory, and the cure.
    """
    free = free_memory()
    for count, bytes_, what in ((nodes, _PER_NODE, "nodes"), (particles, per_particle, "particles")):
        if count * bytes_ > free:
            raise InputError(
                f"{where}: {count:.3g} {what} need about {count * bytes_ / 1e9:.3g} GB, this machine has"
                f" {free / 1e9:.3g} GB free; {cure}"
            )

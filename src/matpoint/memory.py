"""Refusing what can't fit into memory, before anything large is allocated."""

from __future__ import annotations

import os

from matpoint.errors import InputError

# Rough bytes of a node's record and of a particle with its vertices, rows and temporary arrays.
_PER_NODE, _PER_PARTICLE = 64.0, 1000.0


def available() -> float:
    """Return the bytes of memory that this process may have: the machine's, or a limit set below it."""
    try:
        physical = float(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))
    except (AttributeError, ValueError, OSError):
        physical = 64e9
    try:
        import resource  # noqa: PLC0415 (not on Windows)

        limit = float(resource.getrlimit(resource.RLIMIT_AS)[0])
    except (ImportError, OSError):
        return physical
    return min(physical, limit) if limit > 0 else physical


def refuse_size(
    where: str, nodes: float, particles: float, cure: str, per_particle: float = _PER_PARTICLE
) -> None:
    """Refuse numbers of nodes and particles that need more memory than the machine has.

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
    memory = available()
    for count, bytes_, what in ((nodes, _PER_NODE, "nodes"), (particles, per_particle, "particles")):
        if count * bytes_ > memory:
            raise InputError(
                f"{where}: {count:.3g} {what} need about {count * bytes_ / 1e9:.3g} GB, there are"
                f" {memory / 1e9:.3g} GB here; {cure}"
            )

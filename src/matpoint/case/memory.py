"""Refusing cases that can't fit into memory, before anything large is allocated."""

from __future__ import annotations

import math
import os
from collections.abc import Iterable

from matpoint.body import Body
from matpoint.errors import InputError
from matpoint.grid import Grid
from matpoint.regions import Region

# Rough bytes of a node's record and of a particle with its vertices, rows and temporary arrays.
_PER_NODE, _PER_PARTICLE = 64.0, 1000.0


def _available() -> float:
    """Bytes of memory that the machine has."""
    try:
        return float(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))
    except (AttributeError, ValueError, OSError):
        return 64e9


def _particles(body: Body, grid: Grid) -> float:
    """About how many lattice points the bounds of a body hold; 0 if its shape says nothing."""
    if not isinstance(body.geometry, Region):
        return 0.0
    low, high = body.geometry.bounds()
    count = body.per_cell if isinstance(body.per_cell, tuple) else (body.per_cell,) * grid.dim
    sizes = [n * (b - a) / h + 1.0 for n, a, b, h in zip(count, low, high, grid.cell, strict=False)]
    return math.prod(max(size, 1.0) for size in sizes) if all(map(math.isfinite, sizes)) else 0.0


def check_memory(grid: Grid, bodies: Iterable[Body]) -> None:
    """Refuse a grid and bodies that need more memory than the machine has.

    Raises
    ------
    InputError
        With the sizes, and what would help.
    """
    memory = _available()
    nodes = math.prod(float(n + 1) for n in grid.cells)
    if nodes * _PER_NODE > memory:
        raise InputError(
            f"grid: {nodes:.3g} nodes need {nodes * _PER_NODE / 1e9:.3g} GB, this machine has"
            f" {memory / 1e9:.3g} GB; use larger cells or a smaller box"
        )
    for body in bodies:
        particles = _particles(body, grid)
        if particles * _PER_PARTICLE > memory:
            raise InputError(
                f"{body.label}: {particles:.3g} particles need about {particles * _PER_PARTICLE / 1e9:.3g}"
                f" GB, this machine has {memory / 1e9:.3g} GB; use a smaller per_cell, region or larger cells"
            )

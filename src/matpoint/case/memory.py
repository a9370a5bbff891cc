"""Refusing cases that can't fit into memory, before anything large is allocated."""

from __future__ import annotations

import math
from collections.abc import Iterable

from matpoint.body import Body
from matpoint.grid import Grid
from matpoint.memory import refuse_size
from matpoint.regions import Region


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
    nodes = math.prod(float(n + 1) for n in grid.cells)
    refuse_size("grid", nodes, 0.0, "use larger cells or a smaller box")
    for body in bodies:
        cure = "use a smaller per_cell, region or larger cells"
        refuse_size(body.label, 0.0, _particles(body, grid), cure)

"""The block that every row of the benchmark moves: neo-Hookean, structured, away from the grid's walls.

``benchmarks/native/step.cpp`` and ``taichi_step.py`` make the same block, so its numbers stand there too.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from matpoint.body import Body
from matpoint.grid import Grid
from matpoint.interpolation import (
    CPDI1,
    CPDI2,
    CPGIMP,
    IMLS,
    UGIMP,
    BSpline,
    EnrichedCPDI2,
    Interpolation,
    Linear,
)
from matpoint.loads import Gravity
from matpoint.materials import NeoHookean
from matpoint.meshes import mesh_box
from matpoint.regions import Box

PER_CELL = {2: 3, 3: 2}  #: particles per cell and axis: 9 in 2-D, 8 in 3-D
MARGIN = 4  # empty cells below the block; one more lies above
OFFSET = 0.16  # of a cell: some particles then leave their cells early, so that sorting has something to do
MODULUS, POISSON, DENSITY, GRAVITY = 1e6, 0.3, 1000.0, 9.8  # Pa, -, kg/m^3, m/s^2
SPEED, WAVES = 1.0, 0.05  # m/s, and the share of it that varies: linear hats bear little stress at a surface
COURANT, WAVE = 0.1, 40.0  # dt = COURANT h / WAVE, with the wave speed [m/s] rounded up
ENRICHED = 0.05  # share of the vertices

#: Row -> its interpolation, given dimension and cells per side. ``imls`` has the default options.
METHODS: dict[str, Callable[[int, int], Interpolation]] = {
    "linear": lambda dim, cells: Linear(),
    "ugimp": lambda dim, cells: UGIMP(),
    "cpgimp": lambda dim, cells: CPGIMP(),
    "bspline2": lambda dim, cells: BSpline(2),
    "bspline3": lambda dim, cells: BSpline(3),
    "cpdi1": lambda dim, cells: CPDI1(),
    "cpdi2": lambda dim, cells: CPDI2(),
    "enriched-cpdi2": lambda dim, cells: EnrichedCPDI2(where=enriched_layer(dim, cells)),
    "imls-1-point": lambda dim, cells: IMLS(degree=1, points=1),
    "imls-2-points": lambda dim, cells: IMLS(degree=1, points=2),
    "imls": lambda dim, cells: IMLS(),
}


def cells_for(particles: int, dim: int) -> int:
    """Return the cells along the block's side, 1 m, that come nearest to a number of particles."""
    return max(1, round(particles ** (1.0 / dim) / PER_CELL[dim]))


def enriched_layer(dim: int, cells: int) -> Box:
    """Return a slice [m] of the block with about ``ENRICHED`` of its vertices, one plane at least."""
    side = cells * PER_CELL[dim]
    planes = max(1, round(ENRICHED * (side + 1)))
    first = (side + 1 - planes) // 2
    return Box(((first - 0.5) / side,), ((first + planes - 0.5) / side,))


def velocity(x: np.ndarray) -> np.ndarray:
    """Return the smooth velocity [m/s] at points (n, dim) [m], b the axis after a.

    v_a = SPEED (1 + WAVES sin(3 x_b)).
    """
    return SPEED * (1.0 + WAVES * np.sin(3.0 * np.roll(x, -1, axis=1)))


def block(dim: int, cells: int) -> tuple[Grid, Body, Gravity, float]:
    """Return grid, body, gravity and step [s] of the block.

    Parameters
    ----------
    dim
        2 or 3.
    cells
        Along the block's side of 1 m.
    """
    h, side = 1.0 / cells, cells * PER_CELL[dim]
    low = -(MARGIN + OFFSET) * h
    grid = Grid((low,) * dim, (low + (cells + 2 * MARGIN + 1) * h,) * dim, h)
    mesh = mesh_box((0.0,) * dim, (1.0,) * dim, (side,) * dim)

    def moving(x: np.ndarray) -> np.ndarray:
        v = np.zeros_like(x)
        v[:, :dim] = velocity(x[:, :dim])
        return v

    body = Body(mesh, NeoHookean(MODULUS, POISSON, DENSITY), velocity=moving)
    return grid, body, Gravity((0.0, -GRAVITY, 0.0)[:dim]), COURANT * h / WAVE

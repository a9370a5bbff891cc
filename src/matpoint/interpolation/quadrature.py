"""Quadrature points of a reconstruction: Gauss points of whole cells, particles of cut ones."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from matpoint.grid import Grid
from matpoint.interpolation.contract import ParticleError
from matpoint.kernels import reconstruct as kernels
from matpoint.nodes import Nodes
from matpoint.particles import Particles
from matpoint.sorting import Slabs, box_of, sort_by_cell
from matpoint.threads import Team

FULL = 0.75  # filled share that makes a cell whole; beside a free surface a full cell has 7/8 an axis

_ANYWHERE = np.full(3, -np.inf), np.full(3, np.inf)

Monomials = tuple[np.ndarray, np.ndarray, np.ndarray]


@dataclass(frozen=True, eq=False)
class Solver:
    """How shape functions are made, as kernels take it.

    Attributes
    ----------
    mode : int
        ``kernels.MODES``.
    tolerance, limit
        Of IMLS and of MLS.
    """

    mode: int
    tolerance: float
    limit: float


class CellList:
    """Particles by cell, and how much of each cell they fill.

    Attributes
    ----------
    origin, size, inverse, cells
        Of the grid, three components; missing axes have one cell of size 1 and inverse 0.
    pointer, order
        Particles of cell c are ``order[pointer[c]:pointer[c + 1]]``.
    """

    def __init__(self, grid: Grid, team: Team, count: int) -> None:
        self._team = team
        absent = 3 - grid.dim
        self.origin = np.array([*grid.lower, *(0.0,) * absent])
        self.size = np.array([*grid.cell, *(1.0,) * absent])
        self.inverse = np.array([*(1.0 / h for h in grid.cell), *(0.0,) * absent])
        self.cells = np.array([*grid.cells, *(1,) * absent])
        self.cell = np.zeros(count, dtype=np.int32)
        self.order = self.cell.copy()
        self.filled = np.zeros(int(self.cells.prod()))

    def renew(self, particles: Particles) -> None:
        """Sort the particles again, where they are now."""
        x = particles.position
        self.pointer = sort_by_cell(
            self._team, x, self.origin, self.inverse, np.zeros(3, dtype=np.int64), self.cells, self.cell,
            self.order,
        )  # fmt: skip
        kernels.fill_cells(x, particles.volume, self.origin, self.inverse, self.cells, self.filled)

    def whole_cells(self, surrounded: bool) -> np.ndarray:
        """Flag the cells that the body fills, shape (cells,); if ``surrounded``, all around them too.

        Beside a free surface a fit has particles on one side only, and to reach beyond them is to
        extrapolate: such cells are left to their particles.
        """
        from scipy.ndimage import minimum_filter  # noqa: PLC0415 (slow to import)

        full = (self.filled >= FULL).reshape(self.cells)
        if full.all() or not surrounded:
            return full.ravel()
        size = np.where(self.inverse > 0.0, 3, 1)
        return minimum_filter(full, size=tuple(size), mode="nearest").ravel()

    @property
    def arguments(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Origin, inverse and cells, as kernels take them."""
        return self.origin, self.inverse, self.cells


class Quadrature:
    """Points that carry mass, velocity, stress and force in the particles' stead.

    Attributes
    ----------
    position, velocity, body : ndarray, shape (q, 3)
        [m], [m/s], [m/s^2]
    mass, volume : ndarray, shape (q,)
        [kg], [m^3]
    stress : ndarray, shape (q, 6)
        [Pa]
    ranks, conditions : ndarray, shape (g,)
        Rank and condition number of the moment matrix of each Gauss point; the g Gauss points come first.
    cell : ndarray, shape (g,)
        The cell of each Gauss point.
    """

    #: Whether a fit reaches into the cells around, so that they must be filled as well.
    surrounded: ClassVar[bool] = True

    def __init__(
        self, cells: CellList, nodes: Nodes, team: Team, solver: Solver, monomials: Monomials, support: float,
        points: int, dim: int,
    ) -> None:  # fmt: skip
        self._list, self._nodes, self._team = cells, nodes, team
        self._solver, self._monomials, self._support = solver, monomials, support
        at, weight = np.polynomial.legendre.leggauss(points)
        lines = [0.5 * (at + 1.0)] * dim + [np.array([0.0])] * (3 - dim)
        self._unit = np.stack([m.ravel() for m in np.meshgrid(*lines, indexing="ij")], axis=1)
        parts = [0.5 * weight] * dim + [np.ones(1)] * (3 - dim)
        shares = np.prod([m.ravel() for m in np.meshgrid(*parts, indexing="ij")], axis=0)
        self._shares = shares * cells.size.prod()
        self._whole = np.zeros(0, dtype=bool)

    def place(self, particles: Particles) -> None:
        """Put the points where they belong, for the particles where they are."""
        c = self._list
        whole = c.whole_cells(self.surrounded)
        if not np.array_equal(whole, self._whole):
            self._whole = whole
            chosen = np.flatnonzero(whole)
            corner = np.stack(np.unravel_index(chosen, tuple(c.cells)), axis=1)
            gauss = c.origin + (corner[:, None] + self._unit[None]) * c.size
            self._gauss = gauss.reshape(-1, 3)
            self.cell = np.repeat(chosen, len(self._unit))
            self._volume = np.tile(self._shares, len(chosen))
            self.ranks = np.zeros(len(self._gauss), dtype=np.int64)
            self.conditions = np.zeros(len(self._gauss))
        self.cut = np.flatnonzero(~whole[c.cell])
        self.position = np.concatenate([self._gauss, particles.position[self.cut]])
        if len(self.cut):
            self.cut_slabs = Slabs(self._nodes, self._team, len(self.cut), self.cut.astype(np.int32))
            self.cut_slabs.renew(particles.position, *self._box(particles.position))
        self.slabs = Slabs(self._nodes, self._team, len(self.position))
        self.slabs.renew(self.position, *self._box(self.position))

    def _box(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The corners of the box around points [m]."""
        return box_of(self._team, x, *_ANYWHERE)[1:]

    def evaluate(self, particles: Particles, body: np.ndarray, with_velocity: bool) -> None:
        """Bring the particles' fields to the points (T 24-26)."""
        p, c, s = particles, self._list, self._solver
        fields = np.zeros((len(p), kernels.FIELDS))
        fields[:, 0] = p.mass / p.volume
        fields[:, 1:7] = p.stress
        fields[:, 7:10] = fields[:, :1] * body
        if with_velocity:
            fields[:, 10:13] = p.velocity
        values = np.empty((len(self._gauss), kernels.FIELDS))
        found = self._team.split(
            len(values),
            lambda a, b: kernels.fields_at_points(
                a, b, self._gauss, s.mode, *self._monomials, s.tolerance, s.limit, *c.arguments,
                self._support, p.position, c.order, c.pointer, fields.ravel(), values.ravel(), self.ranks,
                self.conditions,
            ),
            kernels.HEAVY,
        )  # fmt: skip
        refuse_crowds(found, c)
        density = values[:, 0]
        inverse = np.divide(1.0, density, out=np.zeros_like(density), where=density > 0.0)
        k = self.cut
        own = np.broadcast_to(body, (len(p), 3))
        self.mass = np.concatenate([density * self._volume, p.mass[k]])
        self.volume = np.concatenate([self._volume, p.volume[k]])
        self.stress = np.concatenate([values[:, 1:7], p.stress[k]])
        self.body = np.concatenate([values[:, 7:10] * inverse[:, None], own[k]])
        velocity = values[:, 10:13] if with_velocity else np.zeros((len(values), 3))
        self.velocity = np.concatenate([velocity, p.velocity[k]])


def refuse_crowds(found: list[int], cells: CellList) -> None:
    """Raise ParticleError if a point had more neighbours than a kernel has room for."""
    if any(q >= 0 for q in found):
        raise ParticleError(
            int(cells.order[0]),
            f"more than {kernels.ROOM} particles lie within the support of one point; use fewer per cell",
        )

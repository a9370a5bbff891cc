"""Quadrature points of a reconstruction: Gauss points of whole cells, particles of cut ones."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from matpoint.interpolation.cells import CellList, room
from matpoint.interpolation.contract import ParticleError
from matpoint.kernels import cells as kernels
from matpoint.kernels import points as point_kernels
from matpoint.kernels.reconstruct import HEAVY, ROOM, STRIDE, fields_at_points
from matpoint.kernels.vector import LANES, lines, records
from matpoint.nodes import Nodes
from matpoint.particles import Particles
from matpoint.sorting import Slabs
from matpoint.threads import Team

#: Arrays of points and the shape of what each has.
_CARRIED = {"position": (3,), "velocity": (3,), "mass": (), "volume": (), "stress": (6,), "body": (3,)}

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


class PointSlabs(Slabs):
    """Slabs of points whose number changes."""

    def __init__(self, nodes: Nodes, team: Team) -> None:
        super().__init__(nodes, team, 0)
        self._key_room, self._order_room = self._key, self.order

    def resize(self, count: int) -> None:
        """Make room for another number of points."""
        self._key_room, self._order_room = room(self._key_room, count), room(self._order_room, count)
        self._key, self.order = self._key_room[:count], self._order_room[:count]


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
    fields : ndarray
        What the particles hand to the points, flat (``kernels.points``).
    cut : ndarray
        The particles that are points, after the Gauss points.
    """

    position: np.ndarray
    velocity: np.ndarray
    mass: np.ndarray
    volume: np.ndarray
    stress: np.ndarray
    body: np.ndarray

    #: Whether a fit reaches into the cells around, so that they must be filled as well.
    surrounded: ClassVar[bool] = True

    def __init__(
        self, cells: CellList, nodes: Nodes, team: Team, solver: Solver, monomials: Monomials, support: float,
        points: int, dim: int,
    ) -> None:  # fmt: skip
        self._list, self._team = cells, team
        self._solver, self._monomials, self._support = solver, monomials, support
        at, weight = np.polynomial.legendre.leggauss(points)
        lines = [0.5 * (at + 1.0)] * dim + [np.array([0.0])] * (3 - dim)
        self._unit = np.stack([m.ravel() for m in np.meshgrid(*lines, indexing="ij")], axis=1)
        parts = [0.5 * weight] * dim + [np.ones(1)] * (3 - dim)
        shares = np.prod([m.ravel() for m in np.meshgrid(*parts, indexing="ij")], axis=0)
        self._shares = shares * cells.size.prod()
        self.slabs = PointSlabs(nodes, team)
        # All arrays are made anew only when they have to grow; points take the first part of each.
        self._chosen = np.zeros(0, dtype=np.int64)
        self._ranks, self._conditions = np.zeros(0, dtype=np.int64), np.zeros(0)
        self._room = {name: np.zeros((0, *shape)) for name, shape in _CARRIED.items()}
        self.fields, self._values = records(0).reshape(-1), records(0).reshape(-1)

    @property
    def cell(self) -> np.ndarray:
        """The cell of each Gauss point, shape (g,)."""
        return np.repeat(self._whole, len(self._unit))

    def place(self, particles: Particles, low: np.ndarray, high: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Put the points where they belong, for the particles in a box [m]; return the corners of all."""
        c = self._list
        c.mark_whole(self.surrounded)
        self._chosen = room(self._chosen, len(c.whole))
        least, most = np.zeros(3, dtype=np.int64), np.zeros(3, dtype=np.int64)
        found = kernels.list_whole(c.whole, c.first, c.cells, self._chosen, least, most)
        self._whole = self._chosen[:found]
        self.cut = c.list_cut()
        gauss = found * len(self._unit)
        self._resize(gauss, gauss + len(self.cut))
        self._team.split(
            found,
            lambda a, b: kernels.gauss_points(
                a, b, self._whole, self._unit, c.origin, c.size, c.first, c.cells, self.position
            ),
            len(self._unit),
        )
        np.take(particles.position, self.cut, axis=0, out=self.position[gauss:], mode="clip")
        # The box ends at the cells' centres, so that rounding can't take in one more.
        low = np.minimum(low, c.origin + (least + 0.5) * c.size)
        high = np.maximum(high, c.origin + (most + 0.5) * c.size)
        self._box = low, high
        self._sort_points()
        return self._box

    def _resize(self, gauss: int, count: int) -> None:
        """Let there be so many Gauss points, and so many points in all."""
        self._ranks, self._conditions = room(self._ranks, gauss), room(self._conditions, gauss)
        self.ranks, self.conditions = self._ranks[:gauss], self._conditions[:gauss]
        self._values = _line_pairs(self._values, gauss)
        for name, array in self._room.items():
            self._room[name] = room(array, count)
            setattr(self, name, self._room[name][:count])

    def _sort_points(self) -> None:
        """Sort the points by slab."""
        self.slabs.resize(len(self.position))
        self.slabs.renew(self.position, *self._box)

    def evaluate(self, particles: Particles, body: np.ndarray) -> None:
        """Bring the particles' fields to the points (T 24-26)."""
        p, gauss = particles, len(self.ranks)
        self.fields = _line_pairs(self.fields, len(p))
        self._team.split(
            len(p),
            lambda a, b: point_kernels.particle_fields(
                a, b, p.mass, p.volume, p.stress, body, p.velocity, self.fields
            ),
        )
        found = self._team.split(gauss, lambda a, b: self._fit(p.position, a, b), HEAVY)
        refuse_crowds(found, self._list)
        self._team.split(
            len(self.cut),
            lambda a, b: point_kernels.carry_particles(
                a, b, self.cut, gauss, p.mass, p.volume, p.stress, body, p.velocity, self.mass, self.volume,
                self.stress, self.body, self.velocity,
            ),
        )  # fmt: skip

    def _fit(self, x: np.ndarray, start: int, stop: int) -> int:
        """Fields at Gauss points start:stop."""
        c, s, values = self._list, self._solver, self._values
        crowded = fields_at_points(
            start, stop, self.position, s.mode, *self._monomials, s.tolerance, s.limit, *c.arguments,
            self._support, x, c.order, c.pointer, self.fields, values, self.ranks, self.conditions,
            *workspace(self._team, self._monomials),
        )  # fmt: skip
        point_kernels.carry_values(
            start, stop, values, self._shares, self.mass, self.volume, self.stress, self.body, self.velocity
        )
        return crowded

    def renew_velocities(self, velocity: np.ndarray) -> None:
        """Let the particles hand over other velocities [m/s]."""
        self._team.split(
            len(velocity), lambda a, b: point_kernels.particle_velocities(a, b, velocity, self.fields)
        )


def _line_pairs(array: np.ndarray, count: int) -> np.ndarray:
    """Return a flat array, this one or a longer one, that has ``FIELDS`` numbers for each of ``count``."""
    if len(array) >= point_kernels.FIELDS * count:
        return array
    return records((count + count // 8) * point_kernels.FIELDS // LANES).reshape(-1)


def workspace(team: Team, monomials: Monomials) -> tuple[np.ndarray, np.ndarray]:
    """Return the calling thread's own arrays for fits (``kernels.reconstruct.workspace``)."""
    columns = int(monomials[0][-1])
    long = lines(team.scratch((columns + 6) * STRIDE + LANES), columns + 6, STRIDE)
    return long, team.scratch(columns + 2, columns)


def refuse_crowds(found: list[int], cells: CellList) -> None:
    """Raise ParticleError if a point had more neighbours than a kernel has room for."""
    if any(q >= 0 for q in found):
        raise ParticleError(
            int(cells.order[0]),
            f"more than {ROOM} particles lie within the support of one point; use fewer per cell",
        )

"""The transfers of MLS and IMLS: particles to nodes by reconstruction, back by the basis (T 24-37)."""

from __future__ import annotations

import math
from functools import cached_property
from typing import ClassVar

import numpy as np

from matpoint.interpolation.box import BoxMapping, scatter
from matpoint.interpolation.cells import CellList, room
from matpoint.interpolation.contract import Setting
from matpoint.interpolation.quadrature import Monomials, Quadrature, Solver, refuse_crowds, workspace
from matpoint.kernels import momenta as kernels
from matpoint.kernels.nodes import clear
from matpoint.kernels.reconstruct import HEAVY, velocities_at_nodes
from matpoint.kernels.vector import records
from matpoint.nodes import Axis


class ReconstructedMapping(BoxMapping):
    """Fields at Gauss points by least squares, velocities at nodes by least squares.

    A cell is whole if the particles' volumes fill it; its fields are integrated at Gauss points. Others, at
    free surfaces, are integrated at their particles, as MPM does.

    Attributes
    ----------
    grid_mass : float
        Mass [kg] on the nodes at the last transfer.
    grid_momentum_error : float
        |momentum of the nodes less that of the particles| over the sum of the particles' |m v|, at the last
        transfer of velocities. The sum, not the particles' momentum itself, which vanishes in a standing
        wave. 0 if all are at rest.
    node_ranks, node_conditions : ndarray
        Rank and condition number of the moment matrix at each active node.
    """

    quadrature_kind: ClassVar[type[Quadrature]] = Quadrature

    def __init__(
        self, setting: Setting, axes: list[Axis], solver: Solver, fields: Monomials, velocities: Monomials,
        support: float, points: int,
    ) -> None:  # fmt: skip
        super().__init__(setting, axes)
        self._solver, self._velocity_monomials = solver, velocities
        self.cells = CellList(setting.grid, self.team, len(self.particles))
        self.quadrature = self.quadrature_kind(
            self.cells, self.nodes, self.team, solver, fields, support, points, setting.grid.dim
        )
        self.node_ranks, self.node_conditions = np.zeros(0, dtype=np.int64), np.zeros(0)
        self._ranks, self._conditions = self.node_ranks, self.node_conditions
        self.grid_mass = float(self.particles.mass.sum())
        self.grid_momentum_error = 0.0

    @property
    def grid_mass_error(self) -> float:
        """The share of the particles' mass that the nodes had too much or too little of."""
        total = float(self.particles.mass.sum())
        return abs(self.grid_mass - total) / total

    @property
    def ranks(self) -> np.ndarray:
        """Columns kept at every point where something was reconstructed, Gauss points first."""
        return np.concatenate([self.quadrature.ranks, self.node_ranks[self.node_ranks > 0]])

    @property
    def conditions(self) -> np.ndarray:
        """Condition numbers of the moment matrices at the same points; 0 where none is made (IMLS)."""
        return np.concatenate([self.quadrature.conditions, self.node_conditions[self.node_ranks > 0]])

    @property
    def bad_points(self) -> int:
        """The number of points whose moment matrix was too ill-conditioned to be solved (MLS)."""
        return int((self.conditions >= self._solver.limit).sum())

    def by_cell(self, values: np.ndarray, worst: np.ufunc) -> np.ndarray:
        """Return the worst value of the Gauss points in each particle's cell, 0 where it has none, (n,)."""
        q = self.quadrature
        found = np.zeros(len(self.cells.filled))
        if worst is np.minimum:
            found[q.cell] = np.inf
        worst.at(found, q.cell, values)
        return found[self.cells.cell]

    def activate(self, low: np.ndarray, high: np.ndarray) -> None:
        self.cells.renew(self.particles, low, high)
        # Gauss points may lie in cells that hold no particle.
        self.nodes.active_within(*self.quadrature.place(self.particles, low, high))

    def to_nodes(self, body: np.ndarray, *, kinematic: bool, dynamic: bool) -> None:
        self.quadrature.evaluate(self.particles, body)
        self._scatter(kinematic, dynamic)
        if kinematic:
            self._velocities()

    def velocities_to_nodes(self) -> None:
        self.quadrature.renew_velocities(self.particles.velocity)
        self._velocities()

    def round_trip(self, velocity: np.ndarray) -> np.ndarray:
        kept = self.grid_momentum_error
        result = super().round_trip(velocity)
        self.grid_momentum_error = kept  # the trip's velocities are not the particles'
        return result

    def _scatter(self, kinematic: bool, dynamic: bool) -> None:
        """Mass, momentum and forces of the quadrature points to the nodes (T 28-30, with rho in T 29)."""
        q = self.quadrature
        scatter(self.team, self.nodes, q.slabs, q, self.half, q.body, kinematic=kinematic, dynamic=dynamic)

    def _velocities(self) -> None:
        """Momenta m_i v_i with velocities by the hat as weight (T 31)."""
        n, s, c = self.nodes, self._solver, self.cells
        count = math.prod(b - a for a, b in zip(n.first, n.last, strict=True))
        self._ranks, self._conditions = room(self._ranks, count), room(self._conditions, count)
        self.node_ranks, self.node_conditions = self._ranks[:count], self._conditions[:count]
        found = self.team.split(
            count,
            lambda a, b: velocities_at_nodes(
                a, b, *n.shape[1:], n.first, n.last, n.flat, *n.coordinates, s.mode,
                *self._velocity_monomials, s.tolerance, s.limit, *c.arguments, 1.0, self.particles.position,
                c.order, c.pointer, self.quadrature.fields, self.node_ranks, self.node_conditions,
                *workspace(self.team, self._velocity_monomials),
            ),
            HEAVY,
        )  # fmt: skip
        refuse_crowds(found, c)
        if len(self.quadrature.cut):
            self._average_beside_cut_cells()
        self._compare()

    def _compare(self) -> None:
        """Note the nodes' mass, and how far their momentum is from that of the velocities sent."""
        p, n = self.particles, self.nodes
        planes = np.zeros((n.last[0] - n.first[0], 8))
        n.each(self.team, lambda *some: kernels.sum_records(*some, n.flat, planes.reshape(-1)))
        found = planes.sum(axis=0)
        sent = self.team.sums(
            len(p), 4, lambda *some: kernels.sum_momenta(*some[:3], p.mass, p.velocity, some[3])
        )
        gap, scale = found[:3] - sent[:3], float(sent[3])
        self.grid_mass = float(found[3])
        self.grid_momentum_error = float(np.sqrt(gap @ gap)) / scale if scale > 0.0 else 0.0

    @cached_property
    def _averages(self) -> np.ndarray:
        return records(self.nodes.on_grid).reshape(-1)

    def _average_beside_cut_cells(self) -> None:
        """Give nodes of cut cells the mass-weighted mean of velocities, as MPM does: no extrapolation."""
        n, p, s, c, averages = self.nodes, self.particles, self._slabs, self.cells, self._averages
        n.each(self.team, lambda *some: clear(averages, *some))
        self.team.coloured(
            s.pointer,
            lambda slabs, a, b: kernels.averages_to_nodes(
                *n.rows, n.shape[1], n.shape[2], averages, slabs, a, b, s.pointer, s.order, p.position,
                p.velocity, p.mass, c.cell, c.whole,
            ),
        )  # fmt: skip
        n.each(self.team, lambda *some: kernels.take_averages(*some, averages, n.flat))

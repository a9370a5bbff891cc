"""The transfers of MLS and IMLS: particles to nodes by reconstruction, back by the basis (T 24-37)."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from matpoint.interpolation.box import BoxMapping, scatter
from matpoint.interpolation.contract import Setting
from matpoint.interpolation.quadrature import CellList, Monomials, Quadrature, Solver, refuse_crowds
from matpoint.kernels import reconstruct as kernels
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
        Rank and condition number of the moment matrix at each node.
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
        self._places = self.nodes.positions()
        self.node_ranks = np.zeros(self.nodes.on_grid, dtype=np.int64)
        self.node_conditions = np.zeros(self.nodes.on_grid)
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
        self.nodes.active_everywhere()  # Gauss points may lie in cells that hold no particle

    def before(self) -> None:
        super().before()
        self.cells.renew(self.particles)
        self.quadrature.place(self.particles)

    def to_nodes(self, body: np.ndarray, *, kinematic: bool, dynamic: bool) -> None:
        self.quadrature.evaluate(self.particles, body, with_velocity=False)
        self._scatter(kinematic, dynamic)
        if kinematic:
            self._velocities()

    def velocities_to_nodes(self) -> None:
        self._velocities()

    def round_trip(self, velocity: np.ndarray) -> np.ndarray:
        kept = self.grid_momentum_error
        result = super().round_trip(velocity)
        self.grid_momentum_error = kept  # the trip's velocities are not the particles'
        return result

    def _scatter(self, kinematic: bool, dynamic: bool) -> None:
        """Mass, momentum and forces of the quadrature points to the nodes (T 28-30, with rho in T 29)."""
        q, n = self.quadrature, self.nodes
        scatter(self.team, n, q.slabs, q, self.half, q.body, kinematic=kinematic, dynamic=dynamic)
        if kinematic:
            self.grid_mass = float(n.records[:, 3].sum())

    def _velocities(self) -> None:
        """Momenta m_i v_i with velocities by the hat as weight (T 31)."""
        p, n, s, c = self.particles, self.nodes, self._solver, self.cells
        found = self.team.split(
            n.on_grid,
            lambda a, b: kernels.velocities_at_nodes(
                a, b, n.flat, self._places, s.mode, *self._velocity_monomials, s.tolerance, s.limit,
                *c.arguments, 1.0, p.position, p.velocity, c.order, c.pointer, self.node_ranks,
                self.node_conditions,
            ),
            kernels.HEAVY,
        )  # fmt: skip
        refuse_crowds(found, c)
        if len(self.quadrature.cut):
            self._average_beside_cut_cells()
        self._compare_momenta()

    def _compare_momenta(self) -> None:
        """Note how far the nodes' momentum is from the particles', whose velocities are still those sent."""
        p = self.particles
        momenta = p.mass[:, None] * p.velocity
        gap = self.nodes.records[:, :3].sum(axis=0) - momenta.sum(axis=0)
        scale = float(np.sqrt((momenta**2).sum(axis=1)).sum())
        self.grid_momentum_error = float(np.sqrt(gap @ gap)) / scale if scale > 0.0 else 0.0

    def _average_beside_cut_cells(self) -> None:
        """Give nodes of cut cells the mass-weighted mean of velocities, as MPM does: no extrapolation."""
        n, q = self.nodes, self.quadrature
        kept = n.records.copy()
        n.clear(self.team)
        super().to_nodes(np.zeros((1, 3)), kinematic=True, dynamic=False)
        mean = n.records[:, :3] / np.maximum(n.records[:, 3:4], 1e-300)
        n.clear(self.team)
        p = self.particles
        scatter(self.team, n, q.cut_slabs, p, self.half, p.velocity, kinematic=True, dynamic=False)
        beside = n.records[:, 3] > 0.0
        n.records[:] = kept
        n.records[beside, :3] = kept[beside, 3:4] * mean[beside]

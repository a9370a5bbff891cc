"""The transfers of MLS and IMLS: whole cells by Gauss points, cut cells by their particles."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from matpoint.interpolation.box import BoxMapping, Slabs
from matpoint.interpolation.contract import ParticleError, Setting
from matpoint.kernels import box as box_kernels
from matpoint.kernels import reconstruct as kernels
from matpoint.nodes import Axis

if TYPE_CHECKING:
    from matpoint.interpolation.reconstruction import _Reconstruction

_FULL = 0.75  # filled share that makes a cell whole; beside a free surface a full cell has 7/8 an axis


@dataclass(frozen=True, eq=False)
class Plan:
    """How shape functions are made, as kernels take it.

    Attributes
    ----------
    mode : int
        ``kernels.MODES``.
    fields, velocities
        ``counts, parent, axis`` of the monomials of fields and of velocities.
    tolerance, limit
        Of IMLS and of MLS.
    support
        Radius of the fields' weight in cells.
    points, shares : ndarray, shape (g, 3) and (g,)
        Gauss points and weights of the unit cell.
    """

    mode: int
    fields: tuple[np.ndarray, np.ndarray, np.ndarray]
    velocities: tuple[np.ndarray, np.ndarray, np.ndarray]
    tolerance: float
    limit: float
    support: float
    points: np.ndarray
    shares: np.ndarray

    @classmethod
    def make(cls, choice: _Reconstruction, dim: int, mode: str, tolerance: float, limit: float) -> Plan:
        """Return the plan of a choice in ``dim`` dimensions."""
        from matpoint.interpolation.reconstruction import monomials  # noqa: PLC0415 (it imports this module)

        at, weight = np.polynomial.legendre.leggauss(choice.points)
        lines = [0.5 * (at + 1.0)] * dim + [np.array([0.5])] * (3 - dim)
        points = np.stack([m.ravel() for m in np.meshgrid(*lines, indexing="ij")], axis=1)
        parts = [0.5 * weight] * dim + [np.ones(1)] * (3 - dim)
        shares = np.prod([m.ravel() for m in np.meshgrid(*parts, indexing="ij")], axis=0)
        return cls(
            kernels.MODES[mode], monomials(dim, choice.degree), monomials(dim, choice.velocity_degree),
            tolerance, limit, choice.support, points, shares,
        )  # fmt: skip


class ReconstructedMapping(BoxMapping):
    """Particles to nodes by reconstruction, nodes to particles by the basis (T 24-37).

    A cell is whole if the particles' volumes fill it; its fields are integrated at Gauss points. Other cells, at free surfaces, are integrated at their particles, as MPM does.

    Attributes
    ----------
    ranks, conditions : ndarray
        Smallest rank and largest condition number of the moment matrices, in each cell, then each node.
    grid_mass : float
        Mass [kg] on the nodes at the last transfer.
    """

    def __init__(self, setting: Setting, axes: list[Axis], plan: Plan) -> None:
        super().__init__(setting, axes)
        grid = setting.grid
        absent = 3 - grid.dim
        self.plan = plan
        self._origin = np.array([*grid.lower, *(0.0,) * absent])
        self._size = np.array([*grid.cell, *(1.0,) * absent])
        self._inverse = np.array([*(1.0 / h for h in grid.cell), *(0.0,) * absent])
        self._cells = np.array([*grid.cells, *(1,) * absent])
        self._shares = plan.shares * self._size.prod()
        count = int(self._cells.prod())
        self._cell = np.zeros(len(self.particles), dtype=np.int64)
        self._order = self._cell.copy()
        self._pointer = np.zeros(count + 1, dtype=np.int64)
        self._filled = np.zeros(count)
        self._fields = np.zeros((len(self.particles), 10))
        self._places = self.nodes.positions()
        self.ranks = np.zeros(count + self.nodes.on_grid, dtype=np.int64)
        self.conditions = np.zeros(count + self.nodes.on_grid)
        self.grid_mass = float(self.particles.mass.sum())
        self._count = count

    def before(self) -> None:
        super().before()
        x = self.particles.position
        kernels.order_by_cell(
            x, self._origin, self._inverse, self._cells, self._cell, self._pointer, self._order
        )
        kernels.fill_cells(x, self.particles.volume, self._origin, self._inverse, self._cells, self._filled)
        whole = self._filled >= _FULL
        self._cut = Slabs(self.nodes, np.flatnonzero(~whole[self._cell]))
        self._cut.renew(x)
        self._sort_cells(np.flatnonzero(whole))

    def _sort_cells(self, cells: np.ndarray) -> None:
        """Order whole cells by slab, as the scatter takes them."""
        n = self.nodes
        along = (cells // [self._cells[1] * self._cells[2], self._cells[2], 1][n.slab_axis]) % self._cells[
            n.slab_axis
        ]
        slab = along // n.slab_cells
        order = np.argsort(slab, kind="stable")
        self._slab_cells = cells[order]
        slabs = -(-int(self._cells[n.slab_axis]) // n.slab_cells)
        self._slab_pointer = np.searchsorted(slab[order], np.arange(slabs + 1))

    def to_nodes(self, body: np.ndarray, *, kinematic: bool, dynamic: bool) -> None:
        self._integrate(body, float(kinematic), float(dynamic))
        n = self.nodes
        self.grid_mass = float(n.records[:, 3].sum())
        if kinematic:
            self._velocities()

    def _integrate(self, body: np.ndarray, kinematic: float, dynamic: float) -> None:
        """Mass and forces of whole cells by Gauss points, of cut cells by particles."""
        p, n, plan, f = self.particles, self.nodes, self.plan, self._fields
        f[:, 0] = p.mass / p.volume
        f[:, 1:7] = p.stress
        f[:, 7:] = f[:, :1] * body
        found: list[int] = []
        self.team.coloured(
            self._slab_pointer,
            lambda slabs, a, b: found.append(
                kernels.cells_to_nodes(
                    *n.rows, n.shape[1], n.shape[2], n.flat, slabs, a, b, self._slab_pointer,
                    self._slab_cells, plan.points, self._shares, plan.mode, *plan.fields, plan.tolerance,
                    plan.limit, self._origin, self._inverse, self._size, self._cells, plan.support,
                    p.position, self._order, self._pointer, f, kinematic, dynamic, self.ranks,
                    self.conditions,
                )
            ),
        )  # fmt: skip
        self._refuse_crowds(found)
        s = self._cut
        self.team.coloured(
            s.pointer,
            lambda slabs, a, b: box_kernels.particles_to_nodes(
                *n.rows, n.shape[1], n.shape[2], n.flat, slabs, a, b, s.pointer, s.order,
                p.position, self.half, p.velocity, p.mass, p.volume, p.stress, body, kinematic, dynamic,
            ),
        )  # fmt: skip

    def _velocities(self) -> None:
        """Momenta m_i v_i with velocities by the hat as weight (T 31)."""
        p, n, plan = self.particles, self.nodes, self.plan
        found = self.team.split(
            n.on_grid,
            lambda a, b: kernels.velocities_at_nodes(
                a, b, n.flat, self._places, plan.mode, *plan.velocities, plan.tolerance, plan.limit,
                self._origin, self._inverse, self._cells, 1.0, p.position, p.velocity, self._order,
                self._pointer, self.ranks[self._count :], self.conditions[self._count :],
            ),
        )  # fmt: skip
        self._refuse_crowds(found)

    def _refuse_crowds(self, found: list[Any]) -> None:
        if any(q >= 0 for q in found):
            raise ParticleError(
                int(self._order[0]),
                f"more than {kernels.ROOM} particles lie within the support of one point; use fewer per cell",
            )

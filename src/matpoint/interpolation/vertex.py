"""The vertex family's transfers: particle -> unique vertices -> grid, and back (S, section 4)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from matpoint.grid import Grid
from matpoint.interpolation.box import LEFT, wide_bounds
from matpoint.interpolation.contract import Book, Mapping, ParticleError, Setting, Take
from matpoint.kernels import vertex as kernels
from matpoint.kernels.corners import SIGNS
from matpoint.kernels.faces import add_forces
from matpoint.nodes import Nodes, hat_axis
from matpoint.sorting import Slabs, box_of
from matpoint.vertices import Vertices

PAD = 2  # cells beyond the box, where corners of domains may reach
CORNER_LEFT = f"a corner of its domain is more than {PAD} cells out of the grid"
KIND_OF_DIM = (0, 1, 2)  # line, quadrilateral, hexahedron


def signs(dim: int) -> np.ndarray:
    """Which way the half edge vectors of a parallelepiped go to each corner, shape (2^dim, 3)."""
    return SIGNS[: 2**dim] * (np.arange(3) < dim)


def bounds_of_corners(grid: Grid) -> tuple[np.ndarray, np.ndarray]:
    """Return corners [m] of the box that domains may reach."""
    lower, upper = wide_bounds(grid)
    lower[: grid.dim] -= PAD * np.array(grid.cell)
    upper[: grid.dim] += PAD * np.array(grid.cell)
    return lower, upper


class VertexMapping(Mapping):
    """Two-level transfers; a subclass says how vertices come about and how domains advance."""

    foresees = False  # particles will be at the centroids of where their corners go

    def __init__(self, setting: Setting, vertices: Vertices) -> None:
        grid = setting.grid
        self.particles, self.team, self._vertices = setting.particles, setting.team, vertices
        self.nodes = Nodes([hat_axis(grid, k, PAD, PAD) for k in range(grid.dim)], len(vertices.enriched))
        self.position_next = self.particles.position.copy()
        self.bounds = wide_bounds(grid)
        self._corner_bounds = bounds_of_corners(grid)
        self._slabs = self.make_slabs()
        self._loads: Sequence[tuple[np.ndarray, np.ndarray]] = ()
        self.update_domains()

    @property
    def vertices(self) -> Vertices:
        """The corners of all domains."""
        return self._vertices

    def make_slabs(self) -> Slabs:
        """Return slabs of the vertices that scatter to the grid."""
        v = self.vertices
        return Slabs(self.nodes, self.team, len(v), v.ordinary)

    def update_domains(self) -> None:
        """Bring corner positions, corner weights and centroids in line; raise ParticleError."""
        raise TypeError("a subclass defines how its domains come about")

    def before(self) -> None:
        corners, (least, most) = self.vertices.position, self.bounds
        lost, low, high = self._slabs.survey(corners, *self._corner_bounds)
        if lost >= 0 or not ((low >= least) & (high <= most)).all():
            self._refuse_outside(lost)  # else particles are in the grid with their corners
        self.nodes.active_within(low, high)
        self._slabs.renew(corners, low, high)

    def _refuse_outside(self, corner: int) -> None:
        """Raise ParticleError for a particle that left the grid, or else for a corner that is too far out."""
        lost, _, _ = box_of(self.team, self.particles.position, *self.bounds)
        if lost >= 0:
            raise ParticleError(lost, LEFT)
        if corner >= 0:
            raise ParticleError(self.vertices.owner(corner), CORNER_LEFT)

    def to_nodes(self, body: np.ndarray, *, kinematic: bool, dynamic: bool) -> None:
        p, v, n, s = self.particles, self.vertices, self.nodes, self._slabs
        v.records[v.idle] = 0.0
        self.team.coloured(
            v.edges,
            lambda runs, a, b: kernels.particles_to_vertices(
                runs, a, b, v.edges, v.connectivity, v.kind, v.first, v.weights, p.velocity,
                p.mass, p.volume, p.stress, body, float(kinematic), float(dynamic), v.flat,
            ),
        )  # fmt: skip
        if dynamic:
            self.push_vertices()
        self.team.coloured(
            s.pointer,
            lambda slabs, a, b: kernels.vertices_to_nodes(
                *n.rows, n.shape[1], n.shape[2], n.flat, slabs, a, b, s.pointer, s.order, v.position, v.flat
            ),
        )
        # An enriched vertex is a node: zeta = 1 for its own degree of freedom (S 26, corrected).
        n.records[n.on_grid :] += v.records[v.enriched]

    def nodes_to_vertices(self, dt: float, *, move: bool) -> None:
        v, n, s = self.vertices, self.nodes, self._slabs
        self.team.split(
            len(s.order),
            lambda a, b: kernels.nodes_to_vertices(
                *n.rows, n.shape[1], n.shape[2], n.flat, a, b, s.order, v.position, v.flat, v.position_next,
                dt, move,
            ),
        )  # fmt: skip
        v.records[v.enriched] = n.records[n.on_grid :]
        if move:
            self.team.split(
                len(v.enriched),
                lambda a, b: kernels.move_vertices(a, b, v.enriched, v.flat, v.position, v.position_next, dt),
            )

    def bring(self, start: int, stop: int, gradient: np.ndarray, take: Take) -> None:
        p, v = self.particles, self.vertices
        kernels.vertices_to_particles(
            start, stop, v.connectivity, v.kind, v.weights, v.flat, p.velocity, p.position,
            self.position_next, gradient, *take,
        )  # fmt: skip

    def push(self, loads: Sequence[tuple[np.ndarray, np.ndarray]]) -> None:
        self._loads = loads

    def push_vertices(self) -> None:
        """Add the forces that act on vertices themselves to their records."""
        for vertices, force in self._loads:
            add_forces(vertices, force, self.vertices.flat)

    def advance(self, book: Book | None = None) -> None:
        before, p = self.swap_positions(), self.particles
        self.update_domains()
        if book is not None:
            self.team.blocks(len(p), lambda a, b: book(a, b, before[a:b], p.position[a:b]))

    def permute(self, order: np.ndarray) -> None:
        self.vertices.permute_particles(order)
        self.update_domains()

"""CPDI1: hats interpolated over parallelepipeds that follow F (S, section 2)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from matpoint.interpolation.box import LEFT, wide_bounds
from matpoint.interpolation.contract import Book, Interpolation, Mapping, ParticleError, Setting, Take
from matpoint.interpolation.vertex import CORNER_LEFT, KIND_OF_DIM, PAD, bounds_of_corners, signs
from matpoint.kernels.parallelepiped import (
    nodes_to_particles,
    parallelepipeds,
    particles_to_nodes,
    stretch_edges,
)
from matpoint.nodes import Nodes, hat_axis
from matpoint.sorting import Slabs, box_of
from matpoint.vertices import Vertices

_HAIR = 1e-6  # cells that rounding may put a corner farther away


class ParallelepipedMapping(Mapping):
    """Corners of x_p +- r_k with r_k = F r_k0, each particle's own (S 16), made anew in every transfer."""

    def __init__(self, setting: Setting) -> None:
        grid = self._grid = setting.grid
        self.particles, self.team = setting.particles, setting.team
        self.nodes = Nodes([hat_axis(grid, k, PAD, PAD) for k in range(grid.dim)])
        self.position_next = self.particles.position.copy()
        self._edges0 = setting.domains_edges
        self._edges = np.empty_like(self._edges0)
        self._far = np.zeros(3)
        self._seen: Vertices | None = None  # made for whoever looks, until something moves
        self._bounds, self._corner_bounds = wide_bounds(grid), bounds_of_corners(grid)
        self._slabs = Slabs(self.nodes, self.team, len(self.particles))
        self._stretch()

    @property
    def corners(self) -> int:
        return len(self.particles) * 2**self._grid.dim

    @property
    def vertices(self) -> Vertices:
        """The corners of all domains as they are now; corner c of particle p is vertex p * 2^dim + c."""
        if self._seen is not None:
            return self._seen
        p, dim = self.particles, self._grid.dim
        n, count = len(p), 2**dim
        first = (p.position0[:, None] + signs(dim) @ self._edges0).reshape(-1, 3)
        connectivity = np.arange(n * count, dtype=np.int32).reshape(n, count)
        found = Vertices(first, connectivity, np.full(n, KIND_OF_DIM[dim - 1]), kept=False)
        self.team.split(
            n,
            lambda a, b: parallelepipeds(a, b, dim, p.position, self._edges, found.position, found.weights),
        )
        self._seen = found
        return found

    def before(self) -> None:
        self._seen = None
        x = self.particles.position
        lost, low, high = self._slabs.survey(x, *self._bounds)
        if lost >= 0:
            raise ParticleError(lost, LEFT)
        far, (least, most) = self._far, self._corner_bounds
        if not ((low - far >= least) & (high + far <= most)).all():
            lost, _, _ = box_of(self.team, self.vertices.position, least, most)
            if lost >= 0:
                raise ParticleError(lost // 2**self._grid.dim, CORNER_LEFT)
        self.nodes.active_within(low - far, high + far)
        self._slabs.renew(x, low, high)

    def _stretch(self) -> None:
        """Let the edges follow F, and make slabs as thick as the longest asks for."""
        self._seen = None
        F, grid = self.particles.deformation_gradient, self._grid
        pieces = self.team.pieces(len(F))
        far = np.zeros((len(pieces), 3))
        self.team.map(lambda k, a, b: stretch_edges(a, b, F, self._edges0, self._edges, far[k]), pieces)
        cell = np.array([*grid.cell, *(0.0,) * (3 - grid.dim)])
        self._far = np.where(cell > 0.0, far.max(axis=0), 0.0) + _HAIR * cell
        # A corner is up to so many cells below its particle's, or above it, where it sees one node more.
        cells = np.minimum(np.ceil(self._far[: grid.dim] / cell[: grid.dim]), max(self.nodes.shape))
        self.nodes.set_slabs([2 * int(count) + 1 for count in cells])

    def to_nodes(self, body: np.ndarray, *, kinematic: bool, dynamic: bool) -> None:
        p, n, s = self.particles, self.nodes, self._slabs
        self.team.coloured(
            s.pointer,
            lambda slabs, a, b: particles_to_nodes(
                *n.rows, n.shape[1], n.shape[2], n.flat, slabs, a, b, s.pointer, s.order, self._grid.dim,
                p.position, self._edges, p.velocity, p.mass, p.volume, p.stress, body, float(kinematic),
                float(dynamic),
            ),
        )  # fmt: skip

    def bring(self, start: int, stop: int, gradient: np.ndarray, take: Take) -> None:
        p, n = self.particles, self.nodes
        nodes_to_particles(
            *n.rows, n.shape[1], n.shape[2], n.flat, start, stop, self._grid.dim, p.position,
            self._edges, p.velocity, self.position_next, gradient, *take,
        )  # fmt: skip

    def advance(self, book: Book | None = None) -> None:
        self.swap_positions()
        self._stretch()

    def permute(self, order: np.ndarray) -> None:
        self._edges0 = np.ascontiguousarray(self._edges0[order])
        self._stretch()

    def state(self) -> dict[str, np.ndarray]:
        return {"edges": self._edges0}

    def restore(self, arrays: dict[str, np.ndarray]) -> None:
        self._edges0 = np.array(arrays["edges"])
        self._stretch()


@dataclass(frozen=True)
class CPDI1(Interpolation):
    """Parallelograms and parallelepipeds that deform with F (Sadeghirad et al. 2011)."""

    uses_vertices: ClassVar[bool] = True
    citation: ClassVar[tuple[str, ...]] = ("sulsky1994", "sadeghirad2011")

    @property
    def name(self) -> str:
        return "cpdi1"

    def bind(self, setting: Setting) -> Mapping:
        return ParallelepipedMapping(setting)

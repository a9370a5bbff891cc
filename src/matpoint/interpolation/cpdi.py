"""CPDI2: hats interpolated over domains whose corners move with the material (S, section 3)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import ClassVar

import numpy as np

from matpoint.errors import InputError
from matpoint.interpolation.contract import Book, Interpolation, Mapping, ParticleError, Setting
from matpoint.interpolation.hourglass import HourglassControl
from matpoint.interpolation.vertex import KIND_OF_DIM, VertexMapping, signs
from matpoint.kernels.corners import corner_weights
from matpoint.kernels.parallelepiped import parallelepipeds
from matpoint.quality import altitudes
from matpoint.threads import BLOCK
from matpoint.vertices import Vertices


class ConvectedVertices(VertexMapping):
    """Corners that move with the grid velocity and are shared by neighbours (S, section 3).

    A domain that turns over ends the run, or falls back to a parallelepiped of its own that follows
    F (CPDI1), as ``on_inversion`` says; ``fallen`` lists the particles that have fallen back.
    """

    def __init__(
        self, setting: Setting, enriched: np.ndarray, on_inversion: str, hourglass: float = 0.0
    ) -> None:
        self.dim, self._on_inversion = setting.grid.dim, on_inversion
        # Needed only for domains that fall back.
        self._edges = setting.domains_edges if on_inversion == "cpdi1" else np.zeros((0, 3, 3))
        self._shared = len(setting.vertices)
        self.fallen = np.zeros(0, dtype=np.int32)
        vertices = Vertices(setting.vertices, setting.connectivity, setting.kind)
        vertices.enrich(np.union1d(enriched, setting.held))
        self._hourglass = HourglassControl(vertices, setting, hourglass) if hourglass > 0 else None
        super().__init__(setting, vertices)
        if on_inversion == "stop":  # else particles whose domains have fallen back go on by themselves
            self.position_next = np.zeros((0, 3))

    def update_domains(self, book: Book | None = None) -> None:
        p = self.particles
        own = p.position[self.fallen]
        self._build_fallen(own)
        turned = [q for some in self.team.blocks(len(p), partial(self._weigh, book)) for q in some]
        if turned:
            self._refuse(turned if self._on_inversion == "stop" else np.intersect1d(turned, self.fallen))
            own = np.append(own, p.position[turned], axis=0)  # where they are: nothing was written for them
            self._fall_back(np.array(turned))
            self._build_fallen(own)
            self._refuse([q for q in turned if self._weigh(None, q, q + 1)])
        # A fallen domain is built around its particle: the centroid would only add rounding.
        p.position[self.fallen] = own

    @staticmethod
    def _refuse(turned: Sequence[int] | np.ndarray) -> None:
        if len(turned):
            raise ParticleError(
                int(min(turned)),
                "its domain turned over (a corner Jacobian is not positive); refine, shorten the"
                ' step, or let such domains fall back with on_inversion = "cpdi1"',
            )

    def _weigh(self, book: Book | None, start: int, stop: int) -> list[int]:
        """Weights and centroids of domains start:stop; return those that have turned over.

        Only the first of them, if it ends the run.
        """
        p, v, found = self.particles, self.vertices, []
        for first in range(start, stop, BLOCK):
            a, b = first, min(first + BLOCK, stop)
            before = self.team.scratch(BLOCK, 3)[: b - a]
            if book is not None:
                before[:] = p.position[a:b]
            while a < b:
                turned = corner_weights(a, b, v.kind, v.connectivity, v.position, v.weights, p.position)
                if turned < 0:
                    break
                found.append(turned)
                if self._on_inversion == "stop":
                    return found
                a = turned + 1
            if book is not None:
                book(first, b, before, p.position[first:b])
        return found

    def _build_fallen(self, position: np.ndarray) -> None:
        """Put the corners of fallen domains around their particles, at ``position`` (m, 3) [m]."""
        v, fallen = self.vertices, self.fallen
        F = self.particles.deformation_gradient[fallen]
        edges = np.einsum("pab,pkb->pka", F, self._edges[fallen])
        # No weights: those of all domains are made together.
        parallelepipeds(
            0, len(fallen), self.dim, position, edges, v.position[self._shared :], np.zeros((0, 0, 4))
        )

    def _fall_back(self, particles: np.ndarray) -> None:
        """Give particles parallelepipeds of their own instead of shared corners."""
        first = self.particles.position0[particles, None] + signs(self.dim) @ self._edges[particles]
        self.vertices.detach(particles, first, KIND_OF_DIM[self.dim - 1])
        self.fallen = np.append(self.fallen, particles.astype(np.int32))
        if self._hourglass is not None:
            for particle in self.particles.id[particles]:
                self._hourglass.release(int(particle))
        self._slabs = self.make_slabs()

    def push_vertices(self) -> None:
        super().push_vertices()
        if self._hourglass is not None:
            self._hourglass.act(self.vertices, push=True)

    def stored_energy(self) -> float:
        return 0.0 if self._hourglass is None else self._hourglass.act(self.vertices, push=False)

    def records_of(self, vertices: np.ndarray) -> np.ndarray:
        return self.nodes.on_grid + np.searchsorted(self.vertices.enriched, vertices)

    def permute(self, order: np.ndarray) -> None:
        self._edges = self._edges[order] if len(self._edges) else self._edges
        rank = np.empty_like(order)
        rank[order] = np.arange(len(order))
        self.fallen = rank[self.fallen]
        super().permute(order)

    def advance(self, book: Book | None = None) -> None:
        v = self.vertices
        v.position, v.position_next = v.position_next, v.position
        if len(self.position_next):
            super().advance(book)
        else:
            self.update_domains(book)

    def state(self) -> dict[str, np.ndarray]:
        v = self.vertices
        return {
            "corners": v.position, "corners0": v.position0, "connectivity": v.connectivity,
            "kind": v.kind, "edges": self._edges, "fallen": self.fallen,
        }  # fmt: skip

    def restore(self, arrays: dict[str, np.ndarray]) -> None:
        enriched = self.vertices.enriched
        self._vertices = Vertices(arrays["corners0"], arrays["connectivity"], arrays["kind"])
        self.vertices.position[:] = arrays["corners"]
        self.vertices.enrich(enriched)
        self._edges, self.fallen = np.array(arrays["edges"]), np.array(arrays["fallen"])
        if self._hourglass is not None:
            for particle in self.particles.id[self.fallen]:
                self._hourglass.release(int(particle))
        self._slabs = self.make_slabs()
        self.update_domains()

    def points(self) -> np.ndarray:
        return np.concatenate([self.nodes.positions(), self.vertices.position[self.vertices.enriched]])

    def constraint_points(self, index: np.ndarray, points: np.ndarray) -> np.ndarray:
        own = index - self.nodes.on_grid
        if len(self.vertices.enriched) == 0 or own.max() < 0:
            return points
        points = points.copy()
        points[own >= 0] = self.vertices.position[self.vertices.enriched[own[own >= 0]]]
        return points

    def spacing(self) -> np.ndarray:
        v = self.vertices
        if len(v.enriched) == 0:
            return super().spacing()
        used = np.arange(v.connectivity.shape[1]) < v.count[:, None]
        touches = (v.is_enriched[v.connectivity] & used).any(axis=1)
        return np.where(touches, altitudes(v), np.inf)


def check_policy(method: str, on_inversion: str) -> None:
    """Raise InputError if a policy for domains that turn over does not exist."""
    if on_inversion not in ("stop", "cpdi1"):
        raise InputError(f'{method}: on_inversion = {on_inversion!r}; "stop" and "cpdi1" are allowed')


@dataclass(frozen=True)
class CPDI2(Interpolation):
    """Lines, quadrilaterals, hexahedra, triangles, tetrahedra whose corners move (S, section 3).

    Neighbouring domains share corners, so there are no gaps; weights are exact integrals.

    Parameters
    ----------
    on_inversion
        What becomes of a domain that turns over: ``"stop"`` ends the run with the particle's id,
        ``"cpdi1"`` gives it a parallelepiped of its own that follows F; such particles are counted.
    """

    on_inversion: str = "stop"
    uses_vertices: ClassVar[bool] = True
    shares_corners: ClassVar[bool] = True
    citation: ClassVar[tuple[str, ...]] = ("sulsky1994", "sadeghirad2011", "sadeghirad2013")

    def __post_init__(self) -> None:
        check_policy("CPDI2", self.on_inversion)

    @property
    def name(self) -> str:
        return "cpdi2"

    def bind(self, setting: Setting) -> Mapping:
        return ConvectedVertices(setting, np.zeros(0, dtype=np.int64), self.on_inversion)

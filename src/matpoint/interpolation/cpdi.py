"""CPDI1 and CPDI2: hats interpolated over convected particle domains (S, sections 2 and 3)."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import ClassVar

import numpy as np

from matpoint.errors import InputError
from matpoint.interpolation.contract import Book, Interpolation, Mapping, ParticleError, Setting
from matpoint.interpolation.hourglass import HourglassControl
from matpoint.interpolation.vertex import VertexMapping
from matpoint.kernels.corners import SIGNS, corner_weights, parallelepipeds
from matpoint.kernels.vertex import move_vertices
from matpoint.quality import altitudes
from matpoint.threads import BLOCK
from matpoint.vertices import Vertices


def _signs(dim: int) -> np.ndarray:
    """Which way the half edge vectors go to each corner, shape (2^dim, 3)."""
    return SIGNS[: 2**dim] * (np.arange(3) < dim)


KIND_OF_DIM = (0, 1, 2)  # line, quadrilateral, hexahedron


class StretchedVertices(VertexMapping):
    """Corners of x_p +- r_k with r_k = F r_k0, each particle's own (S 16).

    Corner c of particle p is vertex p * 2^dim + c, so that vertices follow the particles' order.
    """

    shared = False

    def __init__(self, setting: Setting) -> None:
        self.dim = setting.grid.dim
        self._edges = setting.domains_edges
        n, count = len(setting.particles), 2**self.dim
        corners = np.arange(n * count, dtype=np.int32).reshape(n, count)
        self._all = np.arange(n, dtype=np.int32)
        super().__init__(
            setting, Vertices(np.zeros((n * count, 3)), corners, np.full(n, KIND_OF_DIM[self.dim - 1]))
        )
        self._begin()

    def _begin(self) -> None:
        """Find where the corners were at first."""
        x = self.particles.position0[:, None] + _signs(self.dim) @ self._edges
        self.vertices.position0[:] = x.reshape(-1, 3)

    def update_domains(self) -> None:
        p, v = self.particles, self.vertices
        self.team.split(
            len(p),
            lambda a, b: parallelepipeds(
                a, b, self._all, 0, self.dim, p.position, p.deformation_gradient, self._edges,
                v.position, v.weights,
            ),
        )  # fmt: skip

    def permute(self, order: np.ndarray) -> None:
        self._edges = np.ascontiguousarray(self._edges[order])
        self._begin()
        self.update_domains()

    def state(self) -> dict[str, np.ndarray]:
        return {"edges": self._edges}

    def restore(self, arrays: dict[str, np.ndarray]) -> None:
        self._edges = np.array(arrays["edges"])
        self._begin()
        self.update_domains()


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
        while True:
            v = self.vertices
            p.position[self.fallen] = own  # a pass before may have put centroids there
            parallelepipeds(
                0, len(self.fallen), self.fallen, self._shared, self.dim, p.position,
                p.deformation_gradient, self._edges, v.position, v.weights,
            )  # fmt: skip
            found = self.team.blocks(len(p), partial(self._weigh, book))
            turned = min((q for q in found if q >= 0), default=-1)
            if turned < 0:
                # A fallen domain is built around its particle: the centroid would only add rounding.
                p.position[self.fallen] = own
                return
            if self._on_inversion == "stop" or turned in self.fallen:
                raise ParticleError(
                    turned,
                    "its domain turned over (a corner Jacobian is not positive); refine, shorten the"
                    ' step, or let such domains fall back with on_inversion = "cpdi1"',
                )
            own = np.append(own, p.position[[turned]], axis=0)  # where it is: nothing was written for it
            self._fall_back(turned)

    def _weigh(self, book: Book | None, start: int, stop: int) -> int:
        """Weights and centroids of domains start:stop; return the first that has turned over, or -1."""
        p, v = self.particles, self.vertices
        for a in range(start, stop, BLOCK):
            b = min(a + BLOCK, stop)
            before = self.team.scratch(BLOCK, 3)[: b - a]
            if book is not None:
                before[:] = p.position[a:b]
            turned = corner_weights(a, b, v.kind, v.connectivity, v.position, v.weights, p.position)
            if turned >= 0:
                return turned
            if book is not None:
                book(a, b, before)
        return -1

    def _fall_back(self, particle: int) -> None:
        """Give a particle a parallelepiped of its own instead of shared corners."""
        first = self.particles.position0[particle] + _signs(self.dim) @ self._edges[particle]
        self.vertices.detach(particle, first, KIND_OF_DIM[self.dim - 1])
        self.fallen = np.append(self.fallen, particle)
        if self._hourglass is not None:
            self._hourglass.release(int(self.particles.id[particle]))
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

    def move_vertices(self, dt: float) -> None:
        v = self.vertices
        self.team.split(len(v), lambda a, b: move_vertices(a, b, v.flat, v.position, v.position_next, dt))

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


@dataclass(frozen=True)
class CPDI1(Interpolation):
    """Parallelograms and parallelepipeds that deform with F (Sadeghirad et al. 2011)."""

    uses_vertices: ClassVar[bool] = True
    citation: ClassVar[tuple[str, ...]] = ("sulsky1994", "sadeghirad2011")

    @property
    def name(self) -> str:
        return "cpdi1"

    def bind(self, setting: Setting) -> Mapping:
        return StretchedVertices(setting)


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

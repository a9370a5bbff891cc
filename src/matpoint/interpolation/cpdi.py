"""CPDI1 and CPDI2: hats interpolated over convected particle domains (S, sections 2 and 3)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from matpoint.interpolation.contract import Interpolation, Mapping, ParticleError, Setting, first_fault
from matpoint.interpolation.vertex import VertexMapping
from matpoint.kernels.corners import corner_weights, parallelepipeds
from matpoint.kernels.vertex import move_vertices
from matpoint.vertices import Vertices

_KIND_OF_DIM = (0, 1, 2)  # line, quadrilateral, hexahedron


class StretchedVertices(VertexMapping):
    """Corners of x_p +- r_k with r_k = F r_k0, each particle's own (S 16)."""

    def __init__(self, setting: Setting) -> None:
        self.dim = setting.grid.dim
        self._edges = np.ascontiguousarray(setting.domains_edges)
        n, count = len(setting.particles), 2**self.dim
        corners = np.arange(n * count).reshape(n, count)
        kind = np.full(n, _KIND_OF_DIM[self.dim - 1])
        super().__init__(setting, Vertices(np.zeros((n * count, 3)), corners, kind))
        self.vertices.position0[:] = self.vertices.position

    def update_domains(self) -> None:
        p, v = self.particles, self.vertices
        self.team.split(
            len(p),
            lambda a, b: parallelepipeds(
                a, b, self.dim, p.position, p.deformation_gradient, self._edges, v.position, v.weights
            ),
        )

    def permute(self, order: np.ndarray) -> None:
        # Corner c of particle p is vertex p * 2^dim + c by definition: only the vertices move.
        self._edges = np.ascontiguousarray(self._edges[order])
        v, count = self.vertices, 2**self.dim
        v.position0 = np.ascontiguousarray(v.position0.reshape(-1, count, 3)[order].reshape(-1, 3))
        self.update_domains()

    def state(self) -> dict[str, np.ndarray]:
        return {"edges": self._edges, "position0": self.vertices.position0}

    def restore(self, arrays: dict[str, np.ndarray]) -> None:
        self._edges = np.array(arrays["edges"])
        self.vertices.position0 = np.array(arrays["position0"])
        self.update_domains()


class ConvectedVertices(VertexMapping):
    """Corners that move with the grid velocity and are shared by neighbours (S, section 3)."""

    def __init__(self, setting: Setting, enriched: np.ndarray) -> None:
        vertices = Vertices(setting.vertices, setting.connectivity, setting.kind)
        vertices.enrich(enriched)
        super().__init__(setting, vertices)

    def update_domains(self) -> None:
        p, v = self.particles, self.vertices
        turned = first_fault(
            self.team,
            len(p),
            lambda a, b: corner_weights(a, b, v.kind, v.connectivity, v.position, v.weights, p.position),
        )
        if turned >= 0:
            raise ParticleError(
                turned,
                "its domain turned over (a corner Jacobian is not positive); refine, shorten the step,"
                " or use cpdi1, whose domains can't",
            )

    def move_vertices(self, dt: float) -> None:
        v = self.vertices
        self.team.split(len(v), lambda a, b: move_vertices(a, b, v.flat, v.position, v.position_next, dt))

    def advance(self) -> None:
        v = self.vertices
        v.position, v.position_next = v.position_next, v.position
        super().advance()

    def state(self) -> dict[str, np.ndarray]:
        v = self.vertices
        return {"corners": v.position, "connectivity": v.connectivity, "kind": v.kind}

    def restore(self, arrays: dict[str, np.ndarray]) -> None:
        v = self.vertices
        v.position, v.connectivity, v.kind = (
            np.array(arrays[k]) for k in ("corners", "connectivity", "kind")
        )
        v.link()
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

    def spacing(self) -> float:
        """The shortest distance [m] between two corners of a domain that has an enriched one."""
        v = self.vertices
        if len(v.enriched) == 0:
            return float("inf")
        flags = v.is_enriched
        shortest = np.inf
        for kind, edges in _EDGES.items():
            rows = v.connectivity[v.kind == kind]
            rows = rows[flags[rows].any(axis=1)] if len(rows) else rows
            for a, b in edges:
                if len(rows):
                    gap = v.position[rows[:, a]] - v.position[rows[:, b]]
                    shortest = min(shortest, float(np.sqrt((gap**2).sum(axis=1)).min()))
        return shortest


_QUAD = ((0, 1), (1, 2), (2, 3), (3, 0))
_EDGES = {
    0: ((0, 1),),
    1: _QUAD,
    2: (*_QUAD, (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)),
    3: ((0, 1), (1, 2), (2, 0)),
    4: ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)),
}


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


@dataclass(frozen=True)
class CPDI2(Interpolation):
    """Lines, quadrilaterals, hexahedra, triangles, tetrahedra whose corners move (S, section 3).

    Neighbouring domains share corners, so there are no gaps; weights are exact integrals.
    """

    uses_vertices: ClassVar[bool] = True
    citation: ClassVar[tuple[str, ...]] = ("sulsky1994", "sadeghirad2011", "sadeghirad2013")

    @property
    def name(self) -> str:
        return "cpdi2"

    def bind(self, setting: Setting) -> Mapping:
        return ConvectedVertices(setting, np.zeros(0, dtype=np.int64))

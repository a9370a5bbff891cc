"""Vertices: the corners of particle domains, each one stored once and shared."""

from __future__ import annotations

import numpy as np

from matpoint.kernels import EVERY_POINT
from matpoint.kernels.corners import CORNERS, corner_weights
from matpoint.kernels.order import reorder
from matpoint.kernels.vector import records
from matpoint.kernels.vertex import find_first, independent_blocks

_SHORTEST = 256  # particles of a run; fewer are not worth a thread's while


class Vertices:
    """Corners of all domains and the lists that join them to particles.

    Parameters
    ----------
    position, connectivity, kind
        As below; ``position`` is the initial one.
    kept
        False for corners that are made to be looked at only: without weights, records and runs.

    Attributes
    ----------
    position, position0 : ndarray, shape (nv, 3)
        Current and initial position [m].
    connectivity : ndarray of int32, shape (n, K)
        Vertices of each particle in VTK's order, padded with -1; rows follow the particles' order.
    kind : ndarray of int8, shape (n,)
        ``matpoint.domains.Kind`` of each particle's domain.
    weights : ndarray, shape (n, K, 4)
        R [-] and G (3) [1/m] of each corner.
    records : ndarray, shape (nv, 8)
        What a node record holds, for each vertex.
    edges : ndarray of int64
        Run k of particles is edges[k]:edges[k + 1]; runs two or more apart share no vertex.
    first : ndarray of uint8, shape (n,)
        Bit c is set if the particle is the first to add to its corner c; ``idle`` lists the vertices without
        any particle.
    enriched : ndarray of int64
        The vertices that are degrees of freedom of their own; ``ordinary`` are the others, ``EVERY_POINT`` if
        that is all of them.
    """

    def __init__(
        self, position: np.ndarray, connectivity: np.ndarray, kind: np.ndarray, *, kept: bool = True
    ) -> None:
        self.position0 = np.ascontiguousarray(position, dtype=float)
        self.position = self.position0.copy()
        self.connectivity = np.ascontiguousarray(connectivity, dtype=np.int32)
        self.kind = np.ascontiguousarray(kind, dtype=np.int8)
        self.position_next = self.position.copy() if kept else self.position
        self.weights = np.zeros((*self.connectivity.shape, 4)) if kept else np.zeros((0, 0, 4))
        self.records = records(len(position) if kept else 0)
        self.flat = self.records.reshape(-1)
        self.enriched = np.zeros(0, dtype=np.int64)
        self.ordinary = EVERY_POINT
        if kept:
            self.link()

    def __len__(self) -> int:
        return len(self.position)

    @property
    def count(self) -> np.ndarray:
        """How many corners each particle has, shape (n,)."""
        return CORNERS[self.kind]

    def enrich(self, vertices: np.ndarray) -> None:
        """Make these vertices degrees of freedom of their own."""
        self.enriched = np.asarray(vertices, dtype=np.int64)
        if len(self.enriched):
            self.ordinary = np.setdiff1d(np.arange(len(self), dtype=np.int32), self.enriched)

    @property
    def is_enriched(self) -> np.ndarray:
        """Flag of each vertex, shape (nv,)."""
        flags = np.zeros(len(self), dtype=bool)
        flags[self.enriched] = True
        return flags

    def link(self) -> None:
        """Cut the particles into runs that can be added up side by side; needed after any change of order."""
        edges = np.zeros(len(self.connectivity) // _SHORTEST + 2, dtype=np.int64)
        taken = independent_blocks(self.connectivity, len(self), _SHORTEST, edges)
        self.edges = edges[:taken].copy()
        seen = np.zeros(len(self), dtype=bool)
        self.first = np.zeros(len(self.connectivity), dtype=np.uint8)
        find_first(self.edges, self.connectivity, self.kind, seen, self.first)
        self.idle = np.flatnonzero(~seen)

    def owner(self, vertex: int) -> int:
        """Return the first particle with a vertex among its corners."""
        return int(np.argmax((self.connectivity == vertex).any(axis=1)))

    def detach(self, particles: np.ndarray, position0: np.ndarray, kind: int) -> None:
        """Give particles corners of their own, appended to the others.

        Parameters
        ----------
        particles
            Their rows, (m,).
        position0
            Initial positions of the new corners [m], shape (m, corners, 3).
        kind
            The kind of their new domains.
        """
        old, count = len(self), position0.shape[1]
        n, width = self.connectivity.shape
        if count > width:
            wider = np.full((n, count), -1, dtype=np.int32)
            wider[:, :width] = self.connectivity
            self.connectivity = wider
            weights = np.zeros((n, count, 4))
            weights[:, :width] = self.weights
            self.weights = weights
        new = np.arange(old, old + count * len(particles), dtype=np.int32)
        self.connectivity[particles] = -1
        self.connectivity[particles, :count] = new.reshape(-1, count)
        self.kind[particles] = kind
        for name in ("position", "position_next", "position0"):
            setattr(self, name, np.concatenate([getattr(self, name), position0.reshape(-1, 3)]))
        self.records = records(len(self))
        self.flat = self.records.reshape(-1)
        if self.ordinary is not EVERY_POINT:
            self.ordinary = np.append(self.ordinary, new)
        self.link()

    def initial_weights(self) -> np.ndarray:
        """Return R and G of all domains where they began, shape (n, K, 4)."""
        weights = np.zeros((*self.connectivity.shape, 4))
        centre = np.zeros((len(self.connectivity), 3))
        corner_weights(0, len(weights), self.kind, self.connectivity, self.position0, weights, centre)
        return weights

    def deformation(self) -> np.ndarray:
        """Return F from corner positions, sum_a x_a (x) G0_a, shape (n, 3, 3).

        What it differs from the particles' own F is hourglassing, and drift of the rate form
        (methods, section 4).
        """
        weights = self.initial_weights()
        used = (np.arange(weights.shape[1]) < self.count[:, None])[..., None]
        corners = np.where(used, self.position[self.connectivity], 0.0)
        F = np.einsum("pca,pcb->pab", corners, weights[..., 1:])
        missing = ~F.any(axis=(0, 2))
        F[:, missing, missing] = 1.0
        return F

    def permute_particles(self, order: np.ndarray) -> None:
        """Follow a new order of the particles."""
        rows = self.connectivity.view(np.uint8)
        reorder(order, rows, np.zeros(len(rows), dtype=bool), np.empty(rows.shape[1], dtype=np.uint8))
        self.kind = self.kind[order]
        self.link()

"""A second set of arrays, for velocities that go to the particles and back without leaving a trace."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Protocol

import numpy as np

from matpoint.kernels.vector import records
from matpoint.nodes import Nodes
from matpoint.particles import Particles
from matpoint.vertices import Vertices


class Carrier(Protocol):
    """What a mapping lends its arrays from."""

    nodes: Nodes
    particles: Particles
    position_next: np.ndarray

    @property
    def vertices(self) -> Vertices | None:
        """The corners of all domains, or None."""
        ...


class Spare:
    """Arrays that a transfer writes, to stand in for a mapping's own.

    Attributes
    ----------
    nodes : ndarray, shape (records, 8)
    """

    def __init__(self, nodes: Nodes, particles: Particles, vertices: Vertices | None) -> None:
        self.nodes = records(len(nodes.records))
        self._velocity = np.zeros_like(particles.velocity)
        self._nowhere = np.zeros((0, 3))  # no position is wanted
        self._corners = None if vertices is None else np.zeros_like(vertices.position_next)

    @contextmanager
    def in_place_of_own(self, mapping: Carrier) -> Iterator[None]:
        """Let the mapping's transfers work on these arrays for a while."""
        n, p, v = mapping.nodes, mapping.particles, mapping.vertices
        own, velocity, ahead = n.records, p.velocity, mapping.position_next
        corners = None if v is None else v.position_next
        n.records, n.flat = self.nodes, self.nodes.reshape(-1)
        p.velocity, mapping.position_next = self._velocity, self._nowhere
        if v is not None and self._corners is not None:
            v.position_next = self._corners
        try:
            yield
        finally:
            n.records, n.flat = own, own.reshape(-1)
            p.velocity, mapping.position_next = velocity, ahead
            if v is not None and corners is not None:
                v.position_next = corners

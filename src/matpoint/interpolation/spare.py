"""A second set of arrays, for velocities that go to the particles and back without leaving a trace."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Protocol

import numpy as np

from matpoint.kernels.vector import records
from matpoint.nodes import Nodes
from matpoint.particles import Particles


class Carrier(Protocol):
    """What a mapping lends its arrays from."""

    nodes: Nodes
    particles: Particles
    position_next: np.ndarray


class Spare:
    """Arrays that a transfer writes, to stand in for a mapping's own.

    Attributes
    ----------
    nodes : ndarray, shape (records, 8)
    """

    def __init__(self, nodes: Nodes, particles: Particles) -> None:
        self.nodes = records(len(nodes.records))
        self._velocity = np.zeros_like(particles.velocity)
        self._nowhere = np.zeros((0, 3))  # no position is wanted

    @contextmanager
    def in_place_of_own(self, mapping: Carrier) -> Iterator[None]:
        """Let the mapping's transfers work on these arrays for a while."""
        n, p = mapping.nodes, mapping.particles
        own, velocity, ahead = n.records, p.velocity, mapping.position_next
        n.records, n.flat = self.nodes, self.nodes.reshape(-1)
        p.velocity, mapping.position_next = self._velocity, self._nowhere
        try:
            yield
        finally:
            n.records, n.flat = own, own.reshape(-1)
            p.velocity, mapping.position_next = velocity, ahead

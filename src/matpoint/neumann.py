"""Neumann's series of the full mass, by transfers both ways (Nairn and Hammerquist 2021)."""

from __future__ import annotations

import numpy as np

from matpoint.boundary import Constraints
from matpoint.interpolation.contract import Mapping
from matpoint.kernels import neumann as kernels


class NeumannSeries:
    """sum_{0 < j < terms} (1 - S+ S)^j v on the active nodes, in arrays that it keeps.

    Held directions are taken out of every term, so that the sum obeys the conditions if v does. Apart from
    that the sum has no momentum for S+ S = M_L^-1 M, whose full and lumped mass have the same row sums.

    Parameters
    ----------
    mapping
        With the masses on its nodes; they are left as they are.
    constraints
        What is held.
    terms
        Terms of the series, the first of which is v itself.
    """

    def __init__(self, mapping: Mapping, constraints: Constraints, terms: int) -> None:
        self._mapping, self._constraints, self._terms = mapping, constraints, terms
        self._term = np.zeros((len(mapping.nodes.records), 3))
        self._total = np.zeros_like(self._term)

    def add_up(self, share: float) -> np.ndarray:
        """Add up the terms for v = velocity - ``share`` increment of the nodes.

        Returns
        -------
        push : ndarray, shape (c,)
            Impulse [N s] on the body along each held direction.
        """
        m, c, term, total = self._mapping, self._constraints, self._term, self._total
        n, mass = m.nodes, m.nodes.records[:, 3]
        push = np.zeros(len(c.index))
        n.each(m.team, lambda *some: kernels.begin_series(*some, n.flat, share, term, total))
        for _ in range(self._terms - 1):
            back = m.round_trip(term)
            n.each(m.team, lambda *some, back=back: kernels.lessen(*some, back, term))
            along = np.einsum("ca,ca->c", term[c.index], c.normal)
            np.subtract.at(term, c.index, along[:, None] * c.normal)
            push -= mass[c.index] * along
            n.each(m.team, lambda *some: kernels.add_term(*some, term, total))
        return push

    def take(self, lane: int) -> None:
        """Put velocity plus sum in the place of the nodes' velocities (0) or of their increments (4)."""
        n, total = self._mapping.nodes, self._total
        n.each(self._mapping.team, lambda *some: kernels.take_sum(*some, total, lane, n.flat))

"""Neumann's series of the full mass, by transfers both ways (Nairn and Hammerquist 2021)."""

from __future__ import annotations

import numpy as np

from matpoint.boundary import Constraints
from matpoint.interpolation.contract import Mapping


def neumann_correction(
    mapping: Mapping, velocity: np.ndarray, terms: int, constraints: Constraints
) -> tuple[np.ndarray, np.ndarray]:
    """Return sum_{0 < j < terms} (1 - S+ S)^j v, and the impulse that conditions have on it.

    Held directions are taken out of every term, so that the sum obeys the conditions if v does. Apart from
    that the sum has no momentum for S+ S = M_L^-1 M, whose full and lumped mass have the same row sums.

    Parameters
    ----------
    mapping
        With the masses on its nodes; they are left as they are.
    velocity : ndarray, shape (records, 3)
        v of the nodes [m/s].
    terms
        Terms of the series, the first of which is v itself.

    Returns
    -------
    correction : ndarray, shape (records, 3)
        [m/s]
    push : ndarray, shape (c,)
        Impulse [N s] on the body along each held direction.
    """
    c, mass = constraints, mapping.nodes.records[:, 3]
    term, correction, push = velocity, np.zeros_like(velocity), np.zeros(len(c.index))
    for _ in range(terms - 1):
        term = term - mapping.round_trip(term)
        along = np.einsum("ca,ca->c", term[c.index], c.normal)
        np.subtract.at(term, c.index, along[:, None] * c.normal)
        push -= mass[c.index] * along
        correction += term
    return correction, push

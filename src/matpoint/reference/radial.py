"""The layered ring by explicit finite elements along its radius, with finite strain.

The elements and the law are those of :mod:`matpoint.reference.radial_operators`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from matpoint.errors import InputError
from matpoint.reference.radial_operators import RadialOperators, radial_frequencies
from matpoint.reference.ring import LayeredRing


@dataclass(frozen=True, eq=False)
class RadialHistory:
    """What a radial run of the ring leaves.

    Attributes
    ----------
    ring : LayeredRing
        The ring.
    times : ndarray, shape (t,)
        [s]
    nodes : ndarray, shape (n + 1,)
        Initial radii [m].
    displacement : ndarray, shape (t, n + 1)
        Radial, of the nodes [m].
    stress : ndarray, shape (t, n, 3)
        Radial, hoop and axial Cauchy stresses [Pa] at the centres of the elements.
    """

    ring: LayeredRing
    times: np.ndarray
    nodes: np.ndarray
    displacement: np.ndarray
    stress: np.ndarray

    @property
    def centres(self) -> np.ndarray:
        """Initial radii of the centres of the elements [m], shape (n,)."""
        return 0.5 * (self.nodes[1:] + self.nodes[:-1])

    def displacement_at(self, R: np.ndarray | float) -> np.ndarray:
        """Return radial displacements [m] at initial radii R [m], shape (t, radii)."""
        R = np.atleast_1d(np.asarray(R, dtype=float))
        self.ring.layer(R)  # refuses radii outside
        e = np.clip(np.searchsorted(self.nodes, R) - 1, 0, len(self.nodes) - 2)
        share = (R - self.nodes[e]) / np.diff(self.nodes)[e]
        return (1 - share) * self.displacement[:, e] + share * self.displacement[:, e + 1]

    def stress_at(self, R: np.ndarray | float, side: str = "inner") -> np.ndarray:
        """Return radial, hoop and axial stresses [Pa] at initial radii R [m], shape (t, radii, 3).

        Linear between the centres of elements of the same layer, and beyond them up to its faces;
        on an interface, from its ``side``: 'inner' or 'outer'.
        """
        R = np.atleast_1d(np.asarray(R, dtype=float))
        per = len(self.centres) // self.ring.layers
        first = self.ring.layer(R, side) * per
        e = np.clip(np.searchsorted(self.centres, R) - 1, first, first + per - 2)
        share = ((R - self.centres[e]) / (self.centres[e + 1] - self.centres[e]))[:, None]
        return (1 - share) * self.stress[:, e] + share * self.stress[:, e + 1]

    def traction(self, interface: int = 0) -> np.ndarray:
        """Return the radial stress [Pa] on an interface, counted from the inside, shape (t,).

        The mean of what the elements on its two sides extrapolate to, which is of second order.
        """
        if not 0 <= interface < self.ring.layers - 1:
            raise InputError(f"ring: interface = {interface} must be from 0 to {self.ring.layers - 2}")
        R = self.ring.radii[interface + 1]
        return 0.5 * (self.stress_at(R, "inner") + self.stress_at(R, "outer"))[:, 0, 0]


def radial_fem(
    ring: LayeredRing, *, end: float, step: float, elements: int = 40, every: int = 1
) -> RadialHistory:
    """Run the ring from rest; b_r = omega^2 r, with the current radius r, is there from t = 0 on.

    The step is that of the particle methods: symplectic Euler with the lumped mass.

    Parameters
    ----------
    ring
        The ring.
    end, step
        End time and time step [s].
    elements
        In each layer, linear and equal.
    every
        Steps between two samples; the initial state is sampled too.

    Raises
    ------
    InputError
        If the step is over the stability limit, or there are too few steps or elements.
    """
    operators = RadialOperators(ring, elements)
    limit = 2.0 / float(radial_frequencies(ring, elements, -1)[0])
    if not 0 < step <= limit:
        raise InputError(f"ring: step = {step:.4g} s must be positive and at most {limit:.4g} s")
    steps = round(end / step)
    if steps < 1 or every < 1:
        raise InputError(f"ring: end = {end:g} s and every = {every} must allow for one step at least")
    R, mass = operators.nodes, operators.mass
    u, v = np.zeros_like(R), np.zeros_like(R)
    times, displacements, stresses = [0.0], [u.copy()], [operators.stress(u)]
    for n in range(1, steps + 1):
        v += step * (ring.omega**2 * (R + u) - operators.forces(u) / mass)
        u += step * v
        if n % every == 0:
            times.append(n * step)
            displacements.append(u.copy())
            stresses.append(operators.stress(u))
    return RadialHistory(ring, np.array(times), R, np.array(displacements), np.array(stresses))

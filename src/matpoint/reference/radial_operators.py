"""Linear finite elements along the radius of a layered ring.

Two Gauss points an element in the initial radius R, per radian: F_rr = 1 + u', F_tt = 1 + u/R,
F_zz = 1, and the neo-Hookean law (Sadeghirad et al. 2013, eq. 27) in principal axes,
P_k = lambda ln(J)/F_k + mu (F_k - 1/F_k).
"""

from __future__ import annotations

import numpy as np

from matpoint.errors import InputError
from matpoint.reference.ring import LayeredRing


class RadialOperators:
    """Elements of the ring, the same number in each layer, and their forces per radian.

    Parameters
    ----------
    ring
        The ring.
    elements
        In each layer, at least 2.

    Attributes
    ----------
    nodes : ndarray, shape (n + 1,)
        Initial radii [m].
    mass : ndarray, shape (n + 1,)
        Row sums of the consistent mass per radian [kg].
    """

    def __init__(self, ring: LayeredRing, elements: int) -> None:
        if elements < 2:
            raise InputError(f"ring: elements = {elements} must be at least 2 in each layer")
        radii = np.array(ring.radii)
        parts = np.linspace(radii[:-1], radii[1:], elements + 1)
        self.nodes = np.append(parts[:-1].T.ravel(), radii[-1])
        self.lengths = np.diff(self.nodes)
        lam, mu = ring.lame()
        self.lam, self.mu = np.repeat(lam, elements), np.repeat(mu, elements)
        self.density = np.repeat(ring.densities, elements)
        self.right = 0.5 + np.array([[-0.5], [0.5]]) / np.sqrt(3.0)  # N of the outer node, (2, 1)
        self.R = self.nodes[:-1] + self.right * self.lengths
        self.weight = 0.5 * self.lengths * self.R
        self.mass = self._scatter(
            self.density * self.weight * (1 - self.right), self.density * self.weight * self.right
        )

    @staticmethod
    def _scatter(left: np.ndarray, right: np.ndarray) -> np.ndarray:
        total = np.append(left.sum(axis=0), 0.0)
        total[1:] += right.sum(axis=0)
        return total

    def forces(self, u: np.ndarray) -> np.ndarray:
        """Return internal nodal forces per radian [N], shape (n + 1,)."""
        a = 1.0 + np.diff(u) / self.lengths
        b = 1.0 + ((1 - self.right) * u[:-1] + self.right * u[1:]) / self.R
        log = self.lam * np.log(a * b)
        radial = self.weight * (log / a + self.mu * (a - 1 / a)) / self.lengths
        hoop = self.weight * (log / b + self.mu * (b - 1 / b)) / self.R
        return self._scatter((1 - self.right) * hoop - radial, self.right * hoop + radial)

    def stress(self, u: np.ndarray) -> np.ndarray:
        """Return Cauchy stresses [Pa] at the centres, shape (n, 3)."""
        a = 1.0 + np.diff(u) / self.lengths
        b = 1.0 + (u[1:] + u[:-1]) / (self.nodes[1:] + self.nodes[:-1])
        log = self.lam * np.log(a * b) / (a * b)
        return np.stack(
            [log + self.mu * (a / b - 1 / (a * b)), log + self.mu * (b / a - 1 / (a * b)), log], axis=1
        )

    def stiffness(self) -> tuple[np.ndarray, np.ndarray]:
        """Return diagonal and off-diagonal of the small-strain stiffness per radian."""

        def entry(slope_i: int, slope_j: int) -> np.ndarray:
            shape = [self.right if s > 0 else 1 - self.right for s in (slope_i, slope_j)]
            r = [s / self.lengths for s in (slope_i, slope_j)]
            t = [n / self.R for n in shape]
            both = (self.lam + 2 * self.mu) * (r[0] * r[1] + t[0] * t[1])
            return self.weight * (both + self.lam * (r[0] * t[1] + t[0] * r[1]))

        return self._scatter(entry(-1, -1), entry(1, 1)), entry(-1, 1).sum(axis=0)


def radial_frequencies(ring: LayeredRing, elements: int = 40, count: int = 1) -> np.ndarray:
    """Return the lowest small-strain circular frequencies [rad/s] of breathing modes, shape (count,).

    ``elements`` are those of one layer; a negative ``count`` asks for the highest ones.
    """
    from scipy.linalg import eigh_tridiagonal  # noqa: PLC0415 (loaded when used)

    operators = RadialOperators(ring, elements)
    diagonal, off = operators.stiffness()
    root = np.sqrt(operators.mass)
    size = len(root)
    if not 0 < abs(count) <= size:
        raise InputError(f"ring: count = {count} must be from 1 to {size} in size")
    span = (0, count - 1) if count > 0 else (size + count, size - 1)
    squares = eigh_tridiagonal(diagonal / root**2, off / (root[1:] * root[:-1]), True, "i", span)
    return np.sqrt(squares)

"""Spinning rings of concentric elastic layers: their data, and their small-strain statics in closed form.

In plane strain and axial symmetry (lambda + 2 mu) (u'' + u'/R - u/R^2) + rho omega^2 R = 0, so that
in each layer u = A R + B/R - rho omega^2 R^3 / (8 (lambda + 2 mu)); A and B of all layers follow from
continuous displacement and radial stress, and the pressures on the two faces.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from matpoint.errors import InputError


@dataclass(frozen=True)
class LayeredRing:
    """A ring of bonded layers about the origin in plane strain, under b_r = omega^2 r from t = 0 on.

    Parameters
    ----------
    radii
        Inner face, interfaces and outer face [m], increasing; layers + 1 numbers.
    youngs, poissons, densities
        Young's modulus [Pa], Poisson's ratio and density [kg/m^3] of each layer, from the inside.
    omega
        Angular velocity of the frame [rad/s].

    Raises
    ------
    InputError
        If counts differ, radii don't increase from a positive one, or a parameter is out of range.
    """

    radii: Sequence[float] = (3.0, 3.1, 3.2)
    youngs: Sequence[float] = (1e9, 5e8)
    poissons: Sequence[float] = (0.3, 0.3)
    densities: Sequence[float] = (1000.0, 1000.0)
    omega: float = 1.0

    def __post_init__(self) -> None:
        for name in ("radii", "youngs", "poissons", "densities"):
            values = tuple(float(x) for x in getattr(self, name))
            object.__setattr__(self, name, values)
            needed = len(self.radii) - (name != "radii")
            if len(values) != needed or needed < 1 or not np.isfinite(values).all():
                raise InputError(f"ring: {name} = {values} must be {needed} finite numbers")
            if name != "poissons" and min(values) <= 0:
                raise InputError(f"ring: {name} = {values} must be positive")
        if not all(low < high for low, high in pairwise(self.radii)) or len(self.radii) < 2:
            raise InputError(f"ring: radii = {self.radii} must be two at least, and increase")
        if not all(-1 < nu < 0.5 for nu in self.poissons):
            raise InputError(f"ring: poissons = {self.poissons} must be in (-1, 0.5)")
        if not np.isfinite(self.omega):
            raise InputError(f"ring: omega = {self.omega!r} must be finite")

    @property
    def layers(self) -> int:
        """How many layers."""
        return len(self.youngs)

    def lame(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the Lamé parameters [Pa] of the layers, shape (layers,) each."""
        young, nu = np.array(self.youngs), np.array(self.poissons)
        return young * nu / ((1 + nu) * (1 - 2 * nu)), young / (2 * (1 + nu))

    def layer(self, R: np.ndarray, side: str = "inner") -> np.ndarray:
        """Return the layer of initial radii [m]; on an interface, that on its 'inner' or 'outer' side.

        Raises
        ------
        InputError
            If a radius is outside the ring or the side is not one of the two.
        """
        if side not in ("inner", "outer"):
            raise InputError(f"ring: side = {side!r} must be 'inner' or 'outer'")
        R, slack = np.asarray(R, dtype=float), 1e-12 * self.radii[-1]
        first, last = self.radii[0], self.radii[-1]
        if not ((first - slack <= R) & (last + slack >= R)).all():
            raise InputError(f"ring: radii must be from {first:g} to {last:g} m")
        faces = np.array(self.radii[1:-1]) + (slack if side == "inner" else -slack)
        return np.searchsorted(faces, R)


class StaticRing:
    """The ring at rest in its frame, in small strain.

    Parameters
    ----------
    ring
        The ring.
    inner_pressure, outer_pressure
        On the faces [Pa].
    """

    def __init__(self, ring: LayeredRing, inner_pressure: float = 0.0, outer_pressure: float = 0.0) -> None:
        self.ring = ring
        lam, mu = ring.lame()
        self._lam, self._mu = lam, mu
        self._cubic = -np.array(ring.densities) * ring.omega**2 / (8 * (lam + 2 * mu))
        count = 2 * ring.layers
        matrix, right = np.zeros((count, count)), np.zeros(count)
        # Unknowns A + B/R^2 with R over the outer radius, stresses over a modulus: of one size.
        size, modulus = ring.radii[-1], float(mu.max())
        ends = [(0, ring.radii[0], -inner_pressure), (ring.layers - 1, size, -outer_pressure)]
        for row, (k, R, traction) in enumerate(ends):
            matrix[row, 2 * k : 2 * k + 2] = self._rows(k, R)[1] / modulus
            right[row] = (traction - self._particular(k, R)[1]) / modulus
        for k, R in enumerate(ring.radii[1:-1]):
            inner, outer = self._rows(k, R) / [[1.0], [modulus]], self._rows(k + 1, R) / [[1.0], [modulus]]
            rows = slice(2 * k + 2, 2 * k + 4)
            matrix[rows, 2 * k : 2 * k + 2], matrix[rows, 2 * k + 2 : 2 * k + 4] = inner, -outer
            right[rows] = (self._particular(k + 1, R) - self._particular(k, R)) / [1.0, modulus]
        solution = np.linalg.solve(matrix, right).reshape(-1, 2)
        self._A, self._B = solution[:, 0], solution[:, 1] * size**2

    def _rows(self, k: int, R: float) -> np.ndarray:
        """Displacement over R, and radial stress, of unit A and B/(outer radius)^2 in a layer: (2, 2)."""
        ratio = (self.ring.radii[-1] / R) ** 2
        lam, mu = self._lam[k], self._mu[k]
        return np.array([[1.0, ratio], [2 * (lam + mu), -2 * mu * ratio]])

    def _particular(self, k: int, R: float) -> np.ndarray:
        lam, mu = self._lam[k], self._mu[k]
        return self._cubic[k] * R**2 * np.array([1.0, 3 * (lam + 2 * mu) + lam])

    def displacement(self, R: np.ndarray) -> np.ndarray:
        """Return radial displacements [m] at initial radii R [m]."""
        R = np.asarray(R, dtype=float)
        k = self.ring.layer(R)
        return self._A[k] * R + self._B[k] / R + self._cubic[k] * R**3

    def stress(self, R: np.ndarray, side: str = "inner") -> np.ndarray:
        """Return radial, hoop and axial stresses [Pa] at initial radii R [m], shape (..., 3).

        On an interface, they are those on its ``side``: 'inner' or 'outer'.
        """
        R = np.asarray(R, dtype=float)
        k = self.ring.layer(R, side)
        lam, mu = self._lam[k], self._mu[k]
        hoop = self._A[k] + self._B[k] / R**2 + self._cubic[k] * R**2
        radial = self._A[k] - self._B[k] / R**2 + 3 * self._cubic[k] * R**2
        pressure = lam * (hoop + radial)
        return np.stack([pressure + 2 * mu * radial, pressure + 2 * mu * hoop, pressure], axis=-1)

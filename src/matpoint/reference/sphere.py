"""A bonded sphere in an infinite matrix under uniform strain far away: exact, small strain.

Inside, strain is uniform (Eshelby 1957): the mean strain is multiplied by 1/(1 + alpha (K'/K - 1)) and
the deviatoric one by 1/(1 + beta (mu'/mu - 1)), alpha = (1 + nu)/(3 (1 - nu)),
beta = (8 - 10 nu)/(15 (1 - nu)), with a dash for the sphere and nu of the matrix. Outside, Navier's
equations leave x/r^3 to the mean strain, and to a deviator E the two decaying fields
grad(x.E x/r^5) = 2 E x/r^5 - 5 x (x.E x)/r^7 and, by Papkovich and Neuber with the harmonic vector
E x/r^3, 2 (1 - 2 nu) E x/r^3 + 3 x (x.E x)/r^5. Continuous displacement gives their amounts.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from matpoint.errors import InputError


@dataclass(frozen=True)
class Sphere:
    """A sphere about the origin in an infinite matrix.

    Parameters
    ----------
    radius
        [m]
    youngs, poissons
        Young's modulus [Pa] and Poisson's ratio of the sphere and of the matrix.
    strain
        Strain far away: xx, yy, zz, xy, yz, xz (tensor components).

    Raises
    ------
    InputError
        If a count is wrong or a parameter out of range.
    """

    radius: float
    youngs: Sequence[float]
    poissons: Sequence[float]
    strain: Sequence[float]

    def __post_init__(self) -> None:
        for name, count in (("youngs", 2), ("poissons", 2), ("strain", 6)):
            values = tuple(float(x) for x in getattr(self, name))
            object.__setattr__(self, name, values)
            if len(values) != count or not np.isfinite(values).all():
                raise InputError(f"sphere: {name} = {values} must be {count} finite numbers")
        if not (np.isfinite(self.radius) and self.radius > 0):
            raise InputError(f"sphere: radius = {self.radius!r} must be a positive number")
        if min(self.youngs) <= 0:
            raise InputError(f"sphere: youngs = {self.youngs} must be positive")
        if not all(-1 < nu < 0.5 for nu in self.poissons):
            raise InputError(f"sphere: poissons = {self.poissons} must be in (-1, 0.5)")

    def _far(self) -> tuple[float, np.ndarray]:
        """Return mean and deviator of the strain far away."""
        xx, yy, zz, xy, yz, xz = self.strain
        mean = (xx + yy + zz) / 3
        return mean, np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) - mean * np.eye(3)

    def _lame(self) -> tuple[np.ndarray, np.ndarray]:
        young, nu = np.array(self.youngs), np.array(self.poissons)
        return young * nu / ((1 + nu) * (1 - 2 * nu)), young / (2 * (1 + nu))

    def concentration(self) -> tuple[float, float]:
        """Return the factors of mean and deviatoric strain inside over those far away."""
        (lam, mu), nu = self._lame(), self.poissons[1]
        bulk = lam + 2 * mu / 3
        alpha, beta = (1 + nu) / (3 * (1 - nu)), (8 - 10 * nu) / (15 * (1 - nu))
        return 1 / (1 + alpha * (bulk[0] / bulk[1] - 1)), 1 / (1 + beta * (mu[0] / mu[1] - 1))

    def _terms(self, r: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Amounts m, f, g of u = m x + f E x + g x (x.E x) outside and r times their slopes: (2, ...)."""
        nu, R, mean = self.poissons[1], self.radius, self._far()[0]
        swell, shear = self.concentration()
        near = 5 * (shear - 1) * R**3 / (16 - 20 * nu)  # of the field of Papkovich and Neuber
        far = 0.6 * R**2 * near  # of the gradient: both leave no x (x.E x) at r = R
        m = mean * (swell - 1) * (R / r) ** 3
        f_far, f_near = 2 * far / r**5, 2 * (1 - 2 * nu) * near / r**3
        g_far, g_near = -5 * far / r**7, 3 * near / r**5
        return (
            np.stack([mean + m, -3 * m]),
            np.stack([1 + f_far + f_near, -5 * f_far - 3 * f_near]),
            np.stack([g_far + g_near, -7 * g_far - 5 * g_near]),
        )

    def _points(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return points (..., 3) and their distances from the centre."""
        x = np.asarray(x, dtype=float)
        if x.ndim < 1 or x.shape[-1] != 3:
            raise InputError(f"sphere: points have shape {x.shape}; (..., 3) is needed")
        return x, np.linalg.norm(x, axis=-1)

    def displacement(self, x: np.ndarray) -> np.ndarray:
        """Return displacements [m] at points x (..., 3) [m]; the centre stays."""
        x, r = self._points(x)
        mean, E = self._far()
        swell, shear = self.concentration()
        Ex = x @ E
        m, f, g = (term[0][..., None] for term in self._terms(np.maximum(r, self.radius)))
        outside = m * x + f * Ex + g * (x * Ex).sum(axis=-1, keepdims=True) * x
        return np.where((r <= self.radius)[..., None], swell * mean * x + shear * Ex, outside)

    def stress(self, x: np.ndarray, side: str = "inner") -> np.ndarray:
        """Return stresses [Pa] at points x (..., 3) [m]: xx, yy, zz, xy, yz, xz, shape (..., 6).

        On the interface, they are those on its ``side``: 'inner' or 'outer'.
        """
        if side not in ("inner", "outer"):
            raise InputError(f"sphere: side = {side!r} must be 'inner' or 'outer'")
        x, r = self._points(x)
        mean, E = self._far()
        swell, shear = self.concentration()
        slack = 1e-12 if side == "inner" else -1e-12
        inside = (r <= self.radius * (1 + slack))[..., None, None]
        safe = np.maximum(r, self.radius)[..., None, None]
        m, f, g = self._terms(safe)
        Ex = x @ E
        q = (x * Ex).sum(axis=-1)[..., None, None]
        xx, xEx = x[..., :, None] * x[..., None, :] / safe**2, x[..., :, None] * Ex[..., None, :]
        both = xEx + np.swapaxes(xEx, -1, -2)
        # Symmetric gradient of m x + f E x + g q x with q = x.E x and slopes h' = (r h') x/r^2.
        strain = (m[0] + g[0] * q) * np.eye(3) + f[0] * E + (m[1] + g[1] * q) * xx
        strain = strain + (0.5 * f[1] / safe**2 + g[0]) * both
        strain = np.where(inside, swell * mean * np.eye(3) + shear * E, strain)
        lam, mu = (np.where(inside, *pair) for pair in self._lame())
        s = lam * np.trace(strain, axis1=-2, axis2=-1)[..., None, None] * np.eye(3) + 2 * mu * strain
        return np.stack([s[..., i, j] for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))], axis=-1)

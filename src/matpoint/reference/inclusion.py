"""A coated disc in an infinite plate in plane strain, under uniform strain far away: exact, small strain.

Complex potentials (Muskhelishvili) in each layer, in axes turned to the principal ones of the
deviatoric far strain, phi = a z + p/z + c z^3 and psi = b/z + q z + e/z^3 with real coefficients:
2 mu (u + i v) = kappa phi - z conj(phi') - conj(psi), kappa = 3 - 4 nu. Continuous displacement and
continuous resultant phi + z conj(phi') + conj(psi) hold harmonic by harmonic: a and b carry the mean
strain, the others the deviatoric strain.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from matpoint.errors import InputError


@dataclass(frozen=True)
class Inclusion:
    """A disc about the origin, coatings around it, and the plate that holds them, all bonded.

    Parameters
    ----------
    radii
        Of the disc and the coatings [m], increasing; one at least.
    youngs, poissons
        Young's modulus [Pa] and Poisson's ratio of the disc, the coatings and the plate, from the
        inside: one more than the radii.
    strain
        Strain far away: xx, yy, xy (half the engineering shear).

    Raises
    ------
    InputError
        If counts differ, radii don't increase from a positive one, or a parameter is out of range.
    """

    radii: Sequence[float]
    youngs: Sequence[float]
    poissons: Sequence[float]
    strain: Sequence[float]
    _table: np.ndarray = field(init=False, repr=False, compare=False)  # a, b, p, c, q, e of each layer
    _shear: np.ndarray = field(init=False, repr=False, compare=False)
    _turn: complex = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        if len(self.radii) == 0:
            raise InputError("inclusion: radii are empty; the disc needs one")
        layers = len(self.radii) + 1
        needed = {"radii": layers - 1, "youngs": layers, "poissons": layers, "strain": 3}
        for name, count in needed.items():
            values = tuple(float(x) for x in getattr(self, name))
            object.__setattr__(self, name, values)
            if len(values) != count or not np.isfinite(values).all():
                raise InputError(f"inclusion: {name} = {values} must be {count} finite numbers")
        if not (np.diff([0.0, *self.radii]) > 0).all():
            raise InputError(f"inclusion: radii = {self.radii} must be positive and increasing")
        if min(self.youngs) <= 0:
            raise InputError(f"inclusion: youngs = {self.youngs} must be positive")
        if not all(-1 < nu < 0.5 for nu in self.poissons):
            raise InputError(f"inclusion: poissons = {self.poissons} must be in (-1, 0.5)")
        shear = np.array(self.youngs) / (2 * (1 + np.array(self.poissons)))
        kappa = 3 - 4 * np.array(self.poissons)
        xx, yy, xy = self.strain
        mean, deviator = 0.5 * (xx + yy), complex(0.5 * (xx - yy), xy)
        r = np.array(self.radii) / self.radii[-1]
        table = np.zeros((len(shear), 6))  # lengths over the largest radius
        table[:, :2] = _solve(_mean_rows, r, kappa, shear, 2 * shear[-1] / (kappa[-1] - 1)) * mean
        table[:, 2:] = _solve(_deviator_rows, r, kappa, shear, -2 * shear[-1]) * abs(deviator)
        object.__setattr__(self, "_table", table)
        object.__setattr__(self, "_shear", shear)
        object.__setattr__(self, "_turn", np.exp(0.5j * np.angle(deviator)))

    def _local(self, x: np.ndarray, side: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return layers, turned complex positions, and their inverses (1 where the layer has none)."""
        if side not in ("inner", "outer"):
            raise InputError(f"inclusion: side = {side!r} must be 'inner' or 'outer'")
        x = np.asarray(x, dtype=float)
        if x.ndim < 1 or x.shape[-1] not in (2, 3):
            raise InputError(f"inclusion: points have shape {x.shape}; (..., 2) or (..., 3) is needed")
        z = (x[..., 0] + 1j * x[..., 1]) / (self.radii[-1] * self._turn)
        slack = 1e-12 if side == "inner" else -1e-12
        layer = np.searchsorted(np.array(self.radii) / self.radii[-1] + slack, np.abs(z))
        return layer, z, 1.0 / np.where(layer == 0, 1.0, z)

    def displacement(self, x: np.ndarray) -> np.ndarray:
        """Return displacements [m] at points x (..., 2 or 3) [m], shape (..., 2); the centre stays."""
        layer, z, w = self._local(x, "inner")
        a, b, p, c, q, e = np.moveaxis(self._table[layer], -1, 0)
        kappa = 3 - 4 * np.array(self.poissons)[layer]
        phi, slope = a * z + p * w + c * z**3, a - p * w**2 + 3 * c * z**2
        psi = b * w + q * z + e * w**3
        twice = kappa * phi - z * np.conj(slope) - np.conj(psi)
        move = twice / (2 * self._shear[layer]) * self.radii[-1] * self._turn
        return np.stack([move.real, move.imag], axis=-1)

    def stress(self, x: np.ndarray, side: str = "inner") -> np.ndarray:
        """Return stresses [Pa] at points x (..., 2 or 3) [m]: xx, yy, zz, xy, yz, xz, shape (..., 6).

        On an interface, they are those on its ``side``: 'inner' or 'outer'.
        """
        layer, z, w = self._local(x, side)
        a, b, p, c, q, e = np.moveaxis(self._table[layer], -1, 0)
        slope, second = a - p * w**2 + 3 * c * z**2, 2 * p * w**3 + 6 * c * z
        total = 4 * slope.real  # xx + yy
        difference = 2 * (np.conj(z) * second - b * w**2 + q - 3 * e * w**4)  # yy - xx + 2 i xy
        difference = difference * np.conj(self._turn) ** 2
        zero, nu = np.zeros_like(total), np.array(self.poissons)[layer]
        xx, yy = 0.5 * (total - difference.real), 0.5 * (total + difference.real)
        return np.stack([xx, yy, nu * total, 0.5 * difference.imag, zero, zero], axis=-1)


def _mean_rows(r: float, kappa: float, shear: float) -> np.ndarray:
    """Radial displacement and resultant at a radius, of a and b: shape (2, 2)."""
    half = 0.5 / shear
    return np.array([[(kappa - 1) * r * half, -half / r], [2 * r, 1 / r]])


def _deviator_rows(r: float, kappa: float, shear: float) -> np.ndarray:
    """exp(2 i theta) and exp(-2 i theta) of displacement and resultant, over exp(i theta): (4, 4).

    The columns are p, c, q and e.
    """
    moves = np.array([[1 / r, kappa * r**3, 0, -1 / r**3], [kappa / r, -3 * r**3, -r, 0]])
    pulls = np.array([[-1 / r, r**3, 0, 1 / r**3], [1 / r, 3 * r**3, r, 0]])
    return np.vstack([moves * (0.5 / shear), pulls])


def _solve(
    rows: Callable[[float, float, float], np.ndarray],
    r: np.ndarray,
    kappa: np.ndarray,
    shear: np.ndarray,
    far: float,
) -> np.ndarray:
    """Return the coefficients of all layers under a unit strain: shape (layers, 2 or 4).

    Regular at the centre and bounded far away: half of the columns there are given.
    """
    size = len(rows(1.0, 2.0, 1.0))
    layers = len(shear)
    matrix, right = np.zeros((size * (layers - 1), size * layers)), np.zeros(size * (layers - 1))
    scale = np.repeat([shear.max(), 1.0], size // 2)[:, None]  # displacements and stresses of one size
    for k, radius in enumerate(r):
        at = slice(size * k, size * (k + 1))
        matrix[at, size * k : size * (k + 1)] = scale * rows(radius, kappa[k], shear[k])
        matrix[at, size * (k + 1) : size * (k + 2)] = -scale * rows(radius, kappa[k + 1], shear[k + 1])
    singular, growing = ([1], [0]) if size == 2 else ([0, 3], [1, 2])
    last = size * (layers - 1)
    given = np.zeros(size * layers)
    given[last + growing[-1]] = far
    known = singular + [last + column for column in growing]
    free = np.setdiff1d(np.arange(size * layers), known)
    right -= matrix @ given
    given[free] = np.linalg.solve(matrix[:, free], right)
    return given.reshape(layers, size)

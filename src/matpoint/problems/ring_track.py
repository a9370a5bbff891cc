"""What a run of the bi-material ring leaves, and where it is read off."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from matpoint.simulation import Simulation

SECTOR = math.radians(12.0)  # over which the stresses of a row are averaged, about 45 degrees


@dataclass(frozen=True, eq=False)
class RingTrack:
    """What one run of the ring leaves, by a particle method or by finite elements.

    Attributes
    ----------
    times : ndarray, shape (t,)
        [s], from 0.
    inner : ndarray, shape (t,)
        Radial displacement [m] at 45 degrees of the inner face; of the innermost particle where domains
        share no corners.
    inner_radius : float
        Initial radius [m] of that point.
    sigma_b, sigma_c : ndarray, shape (t, around)
        Radial stress [Pa] of the rows of domains inside and outside the interface.
    """

    times: np.ndarray
    inner: np.ndarray
    inner_radius: float
    sigma_b: np.ndarray
    sigma_c: np.ndarray

    @property
    def middle(self) -> int:
        """The domain of a row that is nearest to 45 degrees."""
        return self.sigma_b.shape[1] // 2

    def sector(self, rows: np.ndarray) -> np.ndarray:
        """Return the means of a row's stresses over the middle 12 degrees, shape (t,)."""
        around = rows.shape[1]
        half = max(1, round(SECTOR / (0.5 * math.pi / around) / 2))
        return rows[:, max(0, self.middle - half) : self.middle + half + 1].mean(axis=1)


# sigma_r = xx c^2 + yy s^2 + 2 xy s c, as a product with (c^2, s^2, 2 s c).
_VOIGT = np.zeros((6, 3))
_VOIGT[(0, 1, 3), (0, 1, 2)] = 1.0


def _turn(x: np.ndarray) -> np.ndarray:
    """(c^2, s^2, 2 s c) at positions [m], shape (n, 3)."""
    angle = np.arctan2(x[:, 1], x[:, 0])
    c, s = np.cos(angle), np.sin(angle)
    return np.stack([c * c, s * s, 2 * s * c], axis=1)


def radial_stress(stress: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Return sigma_r [Pa] of stresses (..., n, 6) [Pa] at initial positions x (n, 3) [m], shape (..., n)."""
    return (stress @ _VOIGT * _turn(x)).sum(axis=-1)


def nearest(x: np.ndarray, radius: float) -> tuple[int, np.ndarray]:
    """Return the point nearest to 45 degrees on a circle, and the direction to it."""
    target = np.array([radius * math.sqrt(0.5)] * 2)
    k = int(np.argmin(((x[:, :2] - target) ** 2).sum(axis=1)))
    return k, np.array([*x[k, :2], 0.0]) / np.hypot(*x[k, :2])


def inner_point(sim: Simulation, inner: float) -> tuple[Any, float]:
    """Return what gives the displacement [m] of the inner face, and the initial radius [m] of its point.

    A vertex of the face where domains share corners; else the particle nearest to it.
    """
    v = sim.vertices
    if v is not None and sim.interpolation.shares_corners:
        k, axis = nearest(v.position0, inner)
        return lambda s: float((s.vertices.position[k] - s.vertices.position0[k]) @ axis), inner
    first = sim.particles.ordered("position0")
    r = np.hypot(first[:, 0], first[:, 1])
    k, axis = nearest(first, float(r.min()))
    return lambda s: float((s.particles.ordered("position")[k] - first[k]) @ axis), float(r[k])

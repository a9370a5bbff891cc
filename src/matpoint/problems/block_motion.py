"""The motion of the sheared block's driven faces, whose path is exact for a fixed step."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np


def smooth(s: float) -> float:
    """Return 0 before s = 0, 1 after s = 1, and between them a step with two smooth derivatives."""
    s = min(max(s, 0.0), 1.0)
    return s**3 * (10.0 - 15.0 * s + 6.0 * s * s)


@dataclass(frozen=True)
class FaceMotion:
    """Sheared about a centre, then turned about it.

    The halves below and above the centre share the shear as their compliances. In a neo-Hookean
    material simple shear at rest has sigma_xy = mu gamma and no stress across the layers, so this is
    equilibrium, exact at any angle.

    Parameters
    ----------
    centre
        [m]
    size
        Height [m].
    contrast
        Stiffness of the upper over that of the lower half.
    shear
        Final mean shear, tangent of the angle.
    turn
        Final angle [rad].
    sheared, turned
        Times at which shearing and turning end [s].
    """

    centre: tuple[float, float]
    size: float
    contrast: float
    shear: float
    turn: float
    sheared: float
    turned: float

    def angle(self, time: float) -> float:
        """Return the angle [rad] at a time [s]."""
        return self.turn * smooth((time - self.sheared) / (self.turned - self.sheared))

    def axes(self, time: float) -> np.ndarray:
        """Return the axes that turn with the faces as rows: along, normal; shape (2, 2)."""
        c, s = np.cos(self.angle(time)), np.sin(self.angle(time))
        return np.array([[c, s], [-s, c]])

    def position(self, X: np.ndarray, time: float) -> np.ndarray:
        """Return where points that began at X (m, 2 or 3) [m] are, shape (m, 2)."""
        x = X[:, :2] - self.centre
        half, lower = 0.5 * self.size, self.contrast / (1.0 + self.contrast)
        slid = self.size * np.interp(x[:, 1], (-half, 0.0, half), (-0.5, lower - 0.5, 0.5))
        x[:, 0] += self.shear * smooth(time / self.sheared) * slid
        return self.centre + x @ self.axes(time)

    def velocity(self, axis: int, step: float) -> Callable[[np.ndarray, float], np.ndarray]:
        """Return a component of the velocity at the end of a step that ends where the motion is [m/s].

        Symplectic Euler moves points with the velocity at the end of a step: the mean over the step
        makes their path exact.
        """

        def component(X: np.ndarray, time: float) -> np.ndarray:
            return (self.position(X, time) - self.position(X, time - step))[:, axis] / step

        return component

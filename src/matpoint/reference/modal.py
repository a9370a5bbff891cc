"""The two-layer bar in small strain: its modes, superposed after gravity is switched on.

With u = cos(k x) below the interface and u = R cos(psi + k s) above it (s the distance from the
interface), continuous displacement and stress give R cos(psi) = cos(theta) and
Z_t R sin(psi) = Z_b sin(theta), theta = w L_b/c_b, Z = rho c. The fixed end asks for
psi + w L_t/c_t = (n + 1/2) pi: the same as tan(w L_t/c_t) tan(w L_b/c_b) = Z_t/Z_b, but a phase
that grows with w, so that every root has a bracket of its own and none can be missed.
"""

from __future__ import annotations

import numpy as np

from matpoint.errors import InputError
from matpoint.reference.bar import LayeredBar


def _phase(frequency: np.ndarray, bar: LayeredBar) -> tuple[np.ndarray, np.ndarray]:
    """Return theta and the total phase psi + w L_t/c_t of circular frequencies [rad/s]."""
    below, above = bar.wave_speed(np.array([0.0, bar.length]))
    theta = frequency * bar.interface / below
    ratio = below / above  # Z_b/Z_t: the densities are equal
    sine, cosine = np.sin(theta), np.cos(theta)
    psi = theta + np.arctan((ratio - 1) * sine * cosine / (cosine**2 + ratio * sine**2))
    return theta, psi + frequency * (bar.length - bar.interface) / above


def natural_frequencies(bar: LayeredBar, count: int) -> np.ndarray:
    """Return the lowest circular frequencies [rad/s], shape (count,).

    Parameters
    ----------
    bar
        The bar.
    count
        How many, at least 1.

    Raises
    ------
    InputError
        If ``count`` is less than 1.
    """
    from scipy.optimize import brentq  # noqa: PLC0415 (loaded when used)

    if count < 1:
        raise InputError(f"modal solution: {count} modes asked for; at least 1 is needed")
    below, above = bar.wave_speed(np.array([0.0, bar.length]))
    travel = bar.interface / below + (bar.length - bar.interface) / above
    roots = []
    for n in range(count):
        target = (n + 0.5) * np.pi
        # The phase differs from w * travel by psi - theta, which is less than pi/2.
        low, high = max(target - 0.5 * np.pi, 0.0) / travel, (target + 0.5 * np.pi) / travel
        roots.append(brentq(lambda w, goal: _phase(w, bar)[1] - goal, low, high, args=(target,), xtol=1e-12))
    return np.array(roots)


class ModalBar:
    """The motion of the bar by superposition of its modes.

    The static sag is exact; the modes carry only the oscillation about it, so that the stress
    converges with the square of their number.

    Parameters
    ----------
    bar
        The bar.
    modes
        How many are superposed.

    Attributes
    ----------
    frequencies : ndarray, shape (modes,)
        Circular [rad/s].
    """

    def __init__(self, bar: LayeredBar, modes: int = 400) -> None:
        self.bar = bar
        self.frequencies = natural_frequencies(bar, modes)
        w = self.frequencies
        c_b, c_t = bar.wave_speed(np.array([0.0, bar.length]))
        self._k_b, self._k_t = w / c_b, w / c_t
        l_b, l_t = bar.interface, bar.length - bar.interface
        theta, total = _phase(w, bar)
        self._psi = psi = total - w * l_t / c_t
        ratio = c_b / c_t
        self._R = R = np.hypot(np.cos(theta), ratio * np.sin(theta))
        first = np.sin(theta) / self._k_b + R * (np.sin(total) - np.sin(psi)) / self._k_t
        square = 0.5 * (l_b + R**2 * l_t) + np.sin(2 * theta) / (4 * self._k_b)
        square += R**2 * (np.sin(2 * total) - np.sin(2 * psi)) / (4 * self._k_t)
        self._amplitude = bar.gravity * first / (square * w**2)

    @property
    def period(self) -> float:
        """The longest period [s]."""
        return float(2 * np.pi / self.frequencies[0])

    def _is_below(self, X: np.ndarray) -> np.ndarray:
        interface = self.bar.interface
        return interface > X

    def _modulus(self, X: np.ndarray) -> np.ndarray:
        lam, mu = self.bar.lame(X)
        return lam + 2 * mu

    def displacement(self, X: np.ndarray, times: np.ndarray) -> np.ndarray:
        """Return displacements [m] at positions X [m] and times [s], shape (times, positions)."""
        X, times = np.atleast_1d(X).astype(float), np.atleast_1d(times).astype(float)
        bar = self.bar
        below, above = (self._modulus(np.array([x]))[0] for x in (0.0, bar.length))
        weight = bar.density * bar.gravity
        top = weight * (bar.length**2 - np.maximum(X, bar.interface) ** 2) / (2 * above)
        static = top + weight * (bar.interface**2 - np.minimum(X, bar.interface) ** 2) / (2 * below)
        lower = np.cos(np.outer(X, self._k_b))
        upper = self._R * np.cos(self._psi + np.outer(X - bar.interface, self._k_t))
        shapes = np.where(self._is_below(X)[:, None], lower, upper)
        return static - np.cos(np.outer(times, self.frequencies)) @ (self._amplitude * shapes).T

    def stress(self, X: np.ndarray, times: np.ndarray) -> np.ndarray:
        """Return axial stresses [Pa] at positions X [m] and times [s], shape (times, positions)."""
        X, times = np.atleast_1d(X).astype(float), np.atleast_1d(times).astype(float)
        bar = self.bar
        static = -bar.density * bar.gravity * X
        lower = -self._k_b * np.sin(np.outer(X, self._k_b))
        upper = -self._k_t * self._R * np.sin(self._psi + np.outer(X - bar.interface, self._k_t))
        slopes = np.where(self._is_below(X)[:, None], lower, upper) * self._modulus(X)[:, None]
        return static - np.cos(np.outer(times, self.frequencies)) @ (self._amplitude * slopes).T

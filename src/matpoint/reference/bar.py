"""The two-layer bar under its own weight: the data that every reference solution takes."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from matpoint.errors import InputError


@dataclass(frozen=True)
class LayeredBar:
    """A bar of two elastic layers in uniaxial strain, free at X = 0 and fixed at X = length.

    Parameters
    ----------
    length, interface
        Length of the bar and position of the interface, from the free end [m].
    lower, upper
        Young's moduli below and above the interface [Pa].
    poisson
        Poisson's ratio of both.
    density
        Of both [kg/m^3].
    gravity
        Acceleration along the bar, switched on at t = 0 [m/s^2].

    Raises
    ------
    InputError
        If a size or modulus is not positive or Poisson's ratio is not in (-1, 0.5).
    """

    length: float = 9.0
    interface: float = 4.5
    lower: float = 5e6
    upper: float = 1e7
    poisson: float = 0.3
    density: float = 1050.0
    gravity: float = -10.0

    def __post_init__(self) -> None:
        for name in ("length", "interface", "lower", "upper", "density"):
            value = getattr(self, name)
            if not (math.isfinite(value) and value > 0):
                raise InputError(f"bar: {name} = {value!r} must be a positive number")
        if not self.interface < self.length:
            raise InputError(f"bar: interface = {self.interface:g} must lie below length = {self.length:g}")
        if not -1 < self.poisson < 0.5:
            raise InputError(f"bar: poisson = {self.poisson!r} must be in (-1, 0.5)")
        if not math.isfinite(self.gravity):
            raise InputError(f"bar: gravity = {self.gravity!r} must be finite")

    def young(self, X: np.ndarray) -> np.ndarray:
        """Return Young's modulus [Pa] at initial positions X [m]."""
        return np.where(np.asarray(X) < self.interface, self.lower, self.upper)

    def lame(self, X: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the Lamé parameters [Pa] at initial positions X [m]."""
        young, nu = self.young(X), self.poisson
        return young * nu / ((1 + nu) * (1 - 2 * nu)), young / (2 * (1 + nu))

    def wave_speed(self, X: np.ndarray) -> np.ndarray:
        """Return the speed of uniaxial-strain waves [m/s] at initial positions X [m]."""
        lam, mu = self.lame(X)
        return np.sqrt((lam + 2 * mu) / self.density)

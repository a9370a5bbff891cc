"""Layers of isotropic materials, bonded: the exact effective moduli at small strain.

Uniform fields in each layer solve the problem exactly. Across the layers the traction is the same in
all, so compliances are averaged; along them the strain is, so moduli are (Backus 1962).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from matpoint.errors import InputError


@dataclass(frozen=True)
class Layers:
    """A laminate in plane strain.

    Parameters
    ----------
    thickness
        Of each layer, from below [m].
    young
        Young's modulus of each layer [Pa].
    poisson
        Poisson's ratio of all.

    Raises
    ------
    InputError
        If there is no layer, numbers of layers differ, a thickness or modulus is not positive, or
        Poisson's ratio is not in (-1, 0.5).
    """

    thickness: tuple[float, ...]
    young: tuple[float, ...]
    poisson: float

    def __post_init__(self) -> None:
        if len(self.thickness) != len(self.young) or not self.young:
            raise InputError(
                f"layers: {len(self.thickness)} thicknesses and {len(self.young)} moduli; as many are needed"
            )
        for name, values in (("thickness", self.thickness), ("young", self.young)):
            if not all(0 < value < np.inf for value in values):
                raise InputError(f"layers: {name} = {list(values)} must be positive")
        if not -1 < self.poisson < 0.5:
            raise InputError(f"layers: poisson = {self.poisson!r} must be in (-1, 0.5)")

    def _mean(self, values: np.ndarray) -> float:
        return float(np.average(values, weights=self.thickness))

    @property
    def lame(self) -> np.ndarray:
        """Lamé's first parameter of each layer [Pa], shape (n,)."""
        return self.poisson / ((1 + self.poisson) * (1 - 2 * self.poisson)) * np.array(self.young)

    @property
    def rigidity(self) -> np.ndarray:
        """Shear modulus of each layer [Pa], shape (n,)."""
        return 0.5 / (1 + self.poisson) * np.array(self.young)

    @property
    def normal(self) -> float:
        """Stress over strain across the layers, the sides held: 1/<1/(lambda + 2 mu)> [Pa]."""
        return 1.0 / self._mean(1.0 / (self.lame + 2 * self.rigidity))

    @property
    def shear(self) -> float:
        """Stress over shear angle, sheared along the layers: 1/<1/mu> [Pa]."""
        return 1.0 / self._mean(1.0 / self.rigidity)

    @property
    def in_plane(self) -> float:
        """Mean stress over strain along the layers, lower and upper face free: <E/(1 - nu^2)> [Pa]."""
        return self._mean(np.array(self.young)) / (1 - self.poisson**2)

    def modulus(self, load: str) -> float:
        """Return ``normal``, ``shear`` or ``in_plane`` by its name [Pa]."""
        return {"normal": self.normal, "shear": self.shear, "in_plane": self.in_plane}[load]

    def strains(self, load: str, mean: float) -> np.ndarray:
        """Return the strain of each layer for a mean strain: normal, or angle of shear; shape (n,)."""
        if load == "in_plane":
            return np.full(len(self.young), mean)
        stiffness = self.rigidity if load == "shear" else self.lame + 2 * self.rigidity
        return self.modulus(load) * mean / stiffness

"""What a material is, and the base of the elastic ones.

A material is a frozen dataclass of the user's parameters. Its stress is *not* a method: it is a
plain function of tuples behind the door of :mod:`matpoint.kernels.laws`, the same for built-in
materials and for a user's. To add one, write a file like ``neohookean.py`` (a named tuple, a
function with ``@stress_law``, a dataclass) and register it in ``materials/__init__.py``.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
import numpy.typing as npt

from matpoint.kernels.laws import stress_law
from matpoint.kernels.stretches import determinants, largest_squares, principal_squares
from matpoint.materials import checks

if TYPE_CHECKING:
    from pathlib import Path

    from matplotlib.figure import Figure

__all__ = [
    "Array",
    "Elastic",
    "Material",
    "determinants",
    "largest_squares",
    "principal_squares",
    "stress_law",
]

Array = npt.NDArray[np.float64]


class Material(ABC):
    """Base of all materials: a density, a stress law, its state, wave speed and energy."""

    #: Keys of :mod:`matpoint.citations`.
    citation: ClassVar[tuple[str, ...]] = ()

    density: float  # in the reference configuration [kg/m³]

    @property
    @abstractmethod
    def params(self) -> Any:
        """The named tuple that the stress law takes; its class identifies the law."""

    @property
    def state_variables(self) -> Mapping[str, float]:
        """Internal variables, in the order of the state's columns: name → value at the start."""
        return MappingProxyType({})

    @abstractmethod
    def wave_speed(self, F: Array, state: Array | None = None) -> Array:
        """Return the fastest wave speed in the deformed state, in space, over all directions.

        Parameters
        ----------
        F
            Deformation gradients, (n, 3, 3).
        state
            Internal variables, (n, S), or None for those of the start. Only laws whose speed
            depends on them look at it.

        Returns
        -------
        array
            Speeds [m/s], (n,): the square root of the largest eigenvalue of the acoustic tensor
            over the density, or an upper bound where the law's own page says so.
        """

    @abstractmethod
    def energy(self, F: Array, state: Array | None = None) -> Array | None:
        """Return the stored energy per reference volume [J/m³], (n,); None if it isn't known.

        Parameters
        ----------
        F, state
            As in :meth:`wave_speed`.
        """

    @property
    def diffusivity(self) -> float:
        """Largest kinematic viscosity [m²/s] that an explicit step must resolve; 0 for most."""
        return 0.0

    @property
    def plotted_strain(self) -> float:
        """The strain up to which :meth:`plot` draws, where the law shows what it is."""
        return 0.3

    def initial_state(self, n: int) -> Array:
        """Return the internal variables of n particles at the start, (n, S)."""
        return np.tile(np.array(list(self.state_variables.values()), dtype=np.float64), (n, 1))

    def plot(self, path: str | Path | None = None) -> Figure:
        """Draw the response to uniaxial strain, uniaxial stress and simple shear.

        Parameters
        ----------
        path
            Where to write the picture, its suffix giving the format; None to write none.

        Returns
        -------
        matplotlib.figure.Figure
            The figure, independent of any screen.
        """
        from matpoint.materials.driver import plot  # noqa: PLC0415 - matplotlib and scipy only when drawn

        return plot(self, path)


@dataclass(frozen=True)
class Elastic(Material):
    """Base of the isotropic elastic materials.

    Parameters
    ----------
    E
        Young's modulus at rest [Pa], > 0.
    nu
        Poisson's ratio at rest, in (-1, 1/2).
    density
        Density in the reference configuration [kg/m³], > 0.

    Raises
    ------
    InputError
        A parameter is out of its range.
    """

    E: float
    nu: float
    density: float

    def __post_init__(self) -> None:
        checks.positive(self, "E", "Pa")
        checks.between(self, "nu", -1.0, 0.5)
        checks.positive(self, "density", "kg/m³")

    @property
    def lame(self) -> float:
        """Lamé's first parameter λ [Pa]."""
        return float(self.E * self.nu / ((1.0 + self.nu) * (1.0 - 2.0 * self.nu)))

    @property
    def shear(self) -> float:
        """Shear modulus μ [Pa]."""
        return float(self.E / (2.0 * (1.0 + self.nu)))

    @property
    def bulk(self) -> float:
        """Bulk modulus K [Pa]."""
        return float(self.E / (3.0 * (1.0 - 2.0 * self.nu)))

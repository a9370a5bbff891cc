"""Rings with free surfaces: the generalised vortex and the expanding ring (methods, section 6)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from matpoint.problems.manufactured import ManufacturedProblem

if TYPE_CHECKING:
    from matpoint.boundary import Condition
    from matpoint.domains import Domains
    from matpoint.grid import Grid
    from matpoint.mms import Manufactured


@lru_cache(maxsize=16)
def _vortex(amplitude: float) -> Manufactured:
    from matpoint import mms  # noqa: PLC0415 (loads sympy)
    from matpoint.materials import NeoHookean  # noqa: PLC0415 (compiles)

    return mms.Manufactured(mms.vortex(amplitude, 1.0), NeoHookean(E=1e3, nu=0.3, density=1e3))


@lru_cache(maxsize=16)
def _ring(amplitude: float) -> Manufactured:
    from matpoint import mms  # noqa: PLC0415 (loads sympy)
    from matpoint.materials import NeoHookean  # noqa: PLC0415 (compiles)

    law = mms.expanding_ring(amplitude, ExpandingRing.inner, ExpandingRing.outer, 100.0)
    return mms.Manufactured(law, NeoHookean(E=1e7, nu=0.0, density=1e3))


@dataclass(frozen=True)
class _Ring(ManufacturedProblem):
    """A ring whose two circles are free; domains follow it, about ``per_cell`` per cell and axis."""

    free_surfaces: ClassVar[bool] = True
    inner: ClassVar[float]
    outer: ClassVar[float]
    angles: ClassVar[tuple[float, float]]
    lower: ClassVar[float]
    upper: ClassVar[float]

    def grid(self) -> Grid:
        """Return a square around it."""
        from matpoint.grid import Grid  # noqa: PLC0415 (keeps the import of a case light)

        return Grid((self.lower,) * 2, (self.upper,) * 2, (self.upper - self.lower) / self.cells)

    def mesh(self) -> Domains:
        """Return the ring in quadrilaterals."""
        from matpoint.meshes import mesh_annulus  # noqa: PLC0415 (keeps the import of a case light)

        return mesh_annulus(self.inner, self.outer, self._divisions(), self.angles)

    def lattice(self) -> np.ndarray:
        """Return 17 circles, the two of the outside among them, of 33 places each."""
        R, a = np.meshgrid(np.linspace(self.inner, self.outer, 17), np.linspace(*self.angles, 33))
        return np.stack([(R * np.cos(a)).ravel(), (R * np.sin(a)).ravel(), np.zeros(R.size)], axis=1)

    def particle_count(self) -> float:
        """Return how many particles the mesh has."""
        across, along = self._divisions()
        return float(across) * float(along)

    def _divisions(self) -> tuple[int, int]:
        length = (self.upper - self.lower) / self.cells / self.per_cell
        middle = 0.5 * (self.inner + self.outer) * (self.angles[1] - self.angles[0])
        return max(1, round((self.outer - self.inner) / length)), max(3, round(middle / length))


@dataclass(frozen=True)
class Vortex(_Ring):
    """The generalised vortex: a ring sheared along its circles; amplitude in radians."""

    cells: int = 32
    amplitude: float = 1.0 / 3.0
    name: ClassVar[str] = "vortex"
    title: ClassVar[str] = "Generalised vortex"
    end: ClassVar[float] = 1.0
    longest: ClassVar[float] = 1e-3
    coarse: ClassVar[int] = 64
    sizes: ClassVar[tuple[int, ...]] = (16, 32, 64)
    inner: ClassVar[float] = 0.75
    outer: ClassVar[float] = 1.25
    angles: ClassVar[tuple[float, float]] = (0.0, 2 * math.pi)
    lower: ClassVar[float] = -1.5
    upper: ClassVar[float] = 1.5

    @property
    def solution(self) -> Manufactured:
        """The exact solution."""
        return _vortex(float(self.amplitude))

    def conditions(self) -> Sequence[Condition]:
        """Nothing is held."""
        return ()


@dataclass(frozen=True)
class ExpandingRing(_Ring):
    """A quarter of a ring that breathes, between planes of symmetry; amplitude in metres."""

    cells: int = 32
    amplitude: float = 0.1
    name: ClassVar[str] = "expanding-ring"
    title: ClassVar[str] = "Expanding ring"
    end: ClassVar[float] = 0.02
    longest: ClassVar[float] = 2e-5
    coarse: ClassVar[int] = 64
    sizes: ClassVar[tuple[int, ...]] = (16, 32, 64)
    inner: ClassVar[float] = 0.4
    outer: ClassVar[float] = 0.6
    angles: ClassVar[tuple[float, float]] = (0.0, math.pi / 2)
    lower: ClassVar[float] = 0.0
    upper: ClassVar[float] = 0.8

    @property
    def solution(self) -> Manufactured:
        """The exact solution."""
        return _ring(float(self.amplitude))

    def conditions(self) -> Sequence[Condition]:
        """Return the two planes of symmetry."""
        from matpoint.boundary import Symmetry  # noqa: PLC0415 (keeps the import of a case light)
        from matpoint.places import Plane  # noqa: PLC0415

        return [Symmetry(Plane("x", 0.0)), Symmetry(Plane("y", 0.0))]

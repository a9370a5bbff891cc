"""Standing waves in a unit box, in one, two and three dimensions (T 44-48; methods, section 6)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from matpoint.checks import whole
from matpoint.errors import InputError
from matpoint.problems.manufactured import ManufacturedProblem
from matpoint.problems.random_cells import MEAN_COUNT

if TYPE_CHECKING:
    from matpoint.boundary import Condition
    from matpoint.domains import Domains
    from matpoint.grid import Grid
    from matpoint.interpolation import Interpolation
    from matpoint.mms import Manufactured
    from matpoint.scheme import Scheme
    from matpoint.simulation import Simulation
    from matpoint.timestep import TimeStep
    from matpoint.transfers import Transfer

YOUNG, POISSON, DENSITY = 1e7, 0.3, 1000.0
SPEED = math.sqrt(YOUNG / DENSITY)  # [m/s]
_PLACES = {1: 65, 2: 33, 3: 13}  # along each axis, the middle and the walls among them


@lru_cache(maxsize=16)
def _solution(kind: str, amplitude: float) -> Manufactured:
    from matpoint import mms  # noqa: PLC0415 (loads sympy)
    from matpoint.materials import NeoHookean  # noqa: PLC0415 (compiles)

    laws = {
        "full": lambda: mms.full_wave(amplitude, SPEED),
        "half": lambda: mms.half_wave(amplitude, SPEED),
        "2d": lambda: mms.standing_waves(amplitude, SPEED, 2),
        "3d": lambda: mms.standing_waves(amplitude, SPEED, 3),
    }
    return mms.Manufactured(laws[kind](), NeoHookean(E=YOUNG, nu=POISSON, density=DENSITY))


@dataclass(frozen=True)
class _Waves(ManufacturedProblem):
    """Waves between walls that particles slide along.

    Parameters
    ----------
    random
        A seed > 0 puts 4 to 9 particles into every cell at random, instead of ``per_cell``; methods whose
        domains share corners can't take it. 0: regular.
    """

    random: int = 0

    end: ClassVar[float] = 0.02
    kind: ClassVar[str]
    dim: ClassVar[int]

    def __post_init__(self) -> None:
        super().__post_init__()
        whole(f"{self.name}: random", self.random, 0)

    @property
    def solution(self) -> Manufactured:
        """The exact solution."""
        return _solution(self.kind, float(self.amplitude))

    def grid(self) -> Grid:
        """Return the unit box."""
        from matpoint.grid import Grid  # noqa: PLC0415 (keeps the import of a case light)

        return Grid((0.0,) * self.dim, (1.0,) * self.dim, 1.0 / self.cells)

    def mesh(self) -> Domains:
        """Return the unit box in equal domains, or in random ones."""
        from matpoint.meshes import mesh_box  # noqa: PLC0415 (keeps the import of a case light)
        from matpoint.problems.random_cells import random_mesh  # noqa: PLC0415

        low, high = (0.0,) * self.dim, (1.0,) * self.dim
        if self.random:
            return random_mesh(low, high, self.cells, self.random)
        return mesh_box(low, high, (self.cells * self.per_cell,) * self.dim)

    def lattice(self) -> np.ndarray:
        """Return a lattice over the box with its walls: 65, 33 or 13 places along each axis."""
        lines = [np.linspace(0.0, 1.0, _PLACES[self.dim])] * self.dim + [np.zeros(1)] * (3 - self.dim)
        return np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1).reshape(-1, 3)

    def particle_count(self) -> float:
        """Return how many particles the mesh has; of random ones the mean."""
        each = MEAN_COUNT if self.random else float(self.per_cell) ** self.dim
        return each * float(self.cells) ** self.dim

    def conditions(self) -> Sequence[Condition]:
        """Return rollers on all walls."""
        from matpoint.boundary import Roller  # noqa: PLC0415 (keeps the import of a case light)
        from matpoint.places import Plane  # noqa: PLC0415

        return [Roller(Plane(axis, at)) for axis in "xyz"[: self.dim] for at in (0.0, 1.0)]

    def refuse(self, interpolation: Interpolation, transfer: Transfer | None = None) -> None:
        """Refuse a method that can never run, such as one whose domains share corners at random."""
        self._refuse_random(interpolation)
        super().refuse(interpolation, transfer)

    def _refuse_random(self, interpolation: Interpolation) -> None:
        if self.random and interpolation.shares_corners:
            raise InputError(
                f"{self.name}: {interpolation.name} needs domains that share corners, random ones don't;"
                " set random = 0"
            )

    def simulation(
        self,
        interpolation: Interpolation,
        *,
        scheme: Scheme | None = None,
        timestep: TimeStep | None = None,
        threads: int | None = None,
    ) -> Simulation:
        """Return the run on its exact start."""
        self._refuse_random(interpolation)
        return super().simulation(interpolation, scheme=scheme, timestep=timestep, threads=threads)


@dataclass(frozen=True)
class FullWave(_Waves):
    """A whole wave in a bar, the problem of the IMLS paper (T, section 5)."""

    per_cell: int = 3
    amplitude: float = 0.1
    name: ClassVar[str] = "mms-1d"
    title: ClassVar[str] = "Manufactured solution in one dimension"
    kind: ClassVar[str] = "full"
    dim: ClassVar[int] = 1
    sizes: ClassVar[tuple[int, ...]] = (8, 16, 32, 64, 128)
    longest: ClassVar[float] = 1e-5
    coarse: ClassVar[int] = 256


@dataclass(frozen=True)
class HalfWave(_Waves):
    """Half a wave in a bar."""

    per_cell: int = 3
    amplitude: float = 0.05
    name: ClassVar[str] = "mms-1d-half"
    title: ClassVar[str] = "Manufactured solution in one dimension, half a wave"
    kind: ClassVar[str] = "half"
    dim: ClassVar[int] = 1
    sizes: ClassVar[tuple[int, ...]] = (8, 16, 32, 64, 128)
    longest: ClassVar[float] = 1e-5
    coarse: ClassVar[int] = 256


@dataclass(frozen=True)
class Waves2D(_Waves):
    """Waves along both axes of a square, half a period apart."""

    cells: int = 16
    per_cell: int = 3
    amplitude: float = 0.05
    name: ClassVar[str] = "mms-2d"
    title: ClassVar[str] = "Manufactured solution in two dimensions, along the axes"
    kind: ClassVar[str] = "2d"
    dim: ClassVar[int] = 2
    longest: ClassVar[float] = 5e-5
    coarse: ClassVar[int] = 64


@dataclass(frozen=True)
class Waves3D(_Waves):
    """Waves along the axes of a cube, a third of a period apart; it begins deformed."""

    cells: int = 8
    per_cell: int = 2
    amplitude: float = 0.05
    name: ClassVar[str] = "mms-3d"
    title: ClassVar[str] = "Manufactured solution in three dimensions, along the axes"
    kind: ClassVar[str] = "3d"
    dim: ClassVar[int] = 3
    sizes: ClassVar[tuple[int, ...]] = (4, 8, 16)
    longest: ClassVar[float] = 5e-5
    coarse: ClassVar[int] = 64

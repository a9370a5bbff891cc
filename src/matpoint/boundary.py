"""Conditions on the velocity of nodes: fixed, roller, symmetry, prescribed."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from matpoint.errors import InputError
from matpoint.grid import Grid

_AXES = {"x": 0, "y": 1, "z": 2}
Velocity = Callable[[np.ndarray, float], np.ndarray]


class RegionLike(Protocol):
    """Anything that tells which points it contains."""

    def contains(self, points: np.ndarray) -> np.ndarray:
        """Return a flag for each of the points, shape (n, 3) [m]."""
        ...


@dataclass(frozen=True)
class Plane:
    """A grid plane: the nodes on it and beyond it.

    Parameters
    ----------
    axis
        ``"x"``, ``"y"``, ``"z"`` or 0, 1, 2: the axis normal to the plane.
    at
        Coordinate [m]; it must lie on a line of the grid.
    side
        ``"lower"``: the body lies above the plane; ``"upper"``: below it. None takes the face of
        the grid that is nearer.
    """

    axis: str | int
    at: float
    side: str | None = None

    def __post_init__(self) -> None:
        if self.axis not in (*_AXES, 0, 1, 2) or isinstance(self.axis, bool):
            raise InputError(f'plane: axis = {self.axis!r}; "x", "y", "z" are allowed')
        if not math.isfinite(self.at):
            raise InputError(f"plane: at = {self.at!r} must be finite")
        if self.side not in (None, "lower", "upper"):
            raise InputError(f'plane: side = {self.side!r}; "lower" and "upper" are allowed')

    @property
    def number(self) -> int:
        """The axis as 0, 1, 2."""
        return _AXES[self.axis] if isinstance(self.axis, str) else self.axis

    def check(self, grid: Grid, walls_only: bool) -> None:
        """Raise InputError if the plane does not lie on a line of the grid."""
        k = self.number
        if k >= grid.dim:
            raise InputError(f"plane: axis {'xyz'[k]} does not exist in {grid.dim}-D")
        cells = (self.at - grid.lower[k]) / grid.cell[k]
        if abs(cells - round(cells)) > 1e-6 or not 0 <= round(cells) <= grid.cells[k]:
            near = grid.lower[k] + min(max(round(cells), 0), grid.cells[k]) * grid.cell[k]
            raise InputError(
                f"plane: {'xyz'[k]} = {self.at:g} is not on a line of the grid; the nearest is {near:g}"
            )
        if walls_only and round(cells) not in (0, grid.cells[k]):
            raise InputError(
                f"plane: {'xyz'[k]} = {self.at:g} lies inside the grid; with B-splines a plane must be a"
                f" face of the grid ({grid.lower[k]:g} or {grid.upper[k]:g}): end the grid there"
            )

    def select(self, grid: Grid, points: np.ndarray) -> np.ndarray:
        """Return a flag for the points [m] on or beyond the plane."""
        k = self.number
        side = self.side
        if side is None:
            side = "lower" if self.at - grid.lower[k] <= grid.upper[k] - self.at else "upper"
        hair = 1e-7 * grid.cell[k]
        x = points[:, k]
        return x <= self.at + hair if side == "lower" else x >= self.at - hair


Where = Plane | RegionLike


def _select(where: Where, grid: Grid, points: np.ndarray, walls_only: bool) -> np.ndarray:
    if isinstance(where, Plane):
        where.check(grid, walls_only)
        return where.select(grid, points)
    return np.asarray(where.contains(points), dtype=bool)


def _unit(normal: Sequence[float]) -> np.ndarray:
    vector = np.zeros(3)
    vector[: len(normal)] = normal
    length = float(np.linalg.norm(vector))
    if not math.isfinite(length) or length == 0.0:
        raise InputError(f"roller: normal = {list(normal)} must be a finite vector that is not zero")
    return vector / length


@dataclass(frozen=True)
class Fixed:
    """All velocity components are zero.

    Parameters
    ----------
    where
        A :class:`Plane` or a region of nodes.
    """

    where: Where

    def components(self, dim: int) -> list[tuple[np.ndarray, float | Velocity]]:
        """Return the constrained directions and their velocities [m/s]."""
        return [(row, 0.0) for row in np.eye(3)[:dim]]


@dataclass(frozen=True)
class Roller:
    """The normal velocity component is zero, the others are free.

    Parameters
    ----------
    where
        A :class:`Plane` or a region of nodes.
    normal
        Direction that is held; a plane has its own.
    """

    where: Where
    normal: tuple[float, ...] | None = None

    def __post_init__(self) -> None:
        if self.normal is None and not isinstance(self.where, Plane):
            raise InputError("roller: a region of nodes needs a normal, for instance normal = (1, 0)")
        if self.normal is not None:
            _unit(self.normal)

    def components(self, dim: int) -> list[tuple[np.ndarray, float | Velocity]]:
        """Return the constrained directions and their velocities [m/s]."""
        if self.normal is not None:
            if len(self.normal) > dim:
                raise InputError(f"roller: normal {list(self.normal)} has more than {dim} components")
            return [(_unit(self.normal), 0.0)]
        assert isinstance(self.where, Plane)
        return [(np.eye(3)[self.where.number], 0.0)]


@dataclass(frozen=True)
class Symmetry:
    """A plane of symmetry: what a roller does, said by its reason.

    Parameters
    ----------
    where
        The plane.
    """

    where: Plane

    def components(self, dim: int) -> list[tuple[np.ndarray, float | Velocity]]:
        """Return the constrained directions and their velocities [m/s]."""
        return Roller(self.where).components(dim)


@dataclass(frozen=True)
class PrescribedVelocity:
    """Velocity components as numbers or functions of place and time.

    Parameters
    ----------
    where
        A :class:`Plane` or a region of nodes.
    velocity
        One entry per axis: a number [m/s], None (free), or a function (x, t) -> values for positions
        x of shape (m, 3) [m] and a time [s].
    """

    where: Where
    velocity: tuple[float | Velocity | None, ...]

    def __post_init__(self) -> None:
        if not self.velocity or all(v is None for v in self.velocity):
            raise InputError("prescribed velocity: every component is free; give at least one")
        for k, v in enumerate(self.velocity):
            if v is not None and not callable(v) and not math.isfinite(v):
                raise InputError(f"prescribed velocity: component {k} = {v!r} must be finite")

    def components(self, dim: int) -> list[tuple[np.ndarray, float | Velocity]]:
        """Return the constrained directions and their velocities [m/s]."""
        if len(self.velocity) != dim:
            raise InputError(
                f"prescribed velocity: {len(self.velocity)} components given, the grid has {dim} axes"
            )
        return [(np.eye(3)[k], v) for k, v in enumerate(self.velocity) if v is not None]


Condition = Fixed | Roller | Symmetry | PrescribedVelocity


class Constraints:
    """All conditions as arrays for the kernel ``constrain``.

    Attributes
    ----------
    index : ndarray of int64, shape (c,)
        Node records; a node may stand here up to three times, with orthogonal directions.
    normal : ndarray, shape (c, 3)
    points : ndarray, shape (c, 3)
        Initial positions [m].
    """

    def __init__(
        self, conditions: Sequence[Condition], grid: Grid, points: np.ndarray, walls_only: bool
    ) -> None:
        index: list[np.ndarray] = []
        normal: list[np.ndarray] = []
        self._moving: list[tuple[slice, float | Velocity, np.ndarray]] = []
        total = 0
        for number, condition in enumerate(conditions):
            chosen = np.flatnonzero(_select(condition.where, grid, points, walls_only))
            if len(chosen) == 0:
                raise InputError(
                    f"boundary {number} ({type(condition).__name__}): no node lies in its region;"
                    " enlarge it to hold at least one line of nodes"
                )
            for direction, velocity in condition.components(grid.dim):
                index.append(chosen)
                normal.append(np.tile(direction, (len(chosen), 1)))
                part = slice(total, total + len(chosen))
                total += len(chosen)
                if callable(velocity) or velocity != 0.0:
                    self._moving.append((part, velocity, points[chosen]))
        self.index = np.concatenate(index) if index else np.zeros(0, dtype=np.int64)
        self.normal = np.concatenate(normal) if normal else np.zeros((0, 3))
        self.points = points[self.index]
        self._refuse_oblique()

    def _refuse_oblique(self) -> None:
        order = np.argsort(self.index, kind="stable")
        for shift in (1, 2, 3):
            a, b = order[:-shift], order[shift:]
            same = self.index[a] == self.index[b]
            cosine = np.abs((self.normal[a] * self.normal[b]).sum(axis=1))
            if np.any(same & (cosine > 1e-9) & (cosine < 1 - 1e-9)):
                raise InputError("boundaries: one node is held along two directions that are not orthogonal")

    def velocities(self, time: float) -> np.ndarray:
        """Return the prescribed velocities [m/s] at a time [s], shape (c,)."""
        values = np.zeros(len(self.index))
        for part, velocity, x in self._moving:
            given = velocity(x, time) if callable(velocity) else velocity
            values[part] = given
            if not np.isfinite(values[part]).all():
                raise InputError(f"prescribed velocity: not a finite number at t = {time:g} s")
        return values

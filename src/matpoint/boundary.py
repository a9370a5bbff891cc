"""Conditions on the velocity of nodes: fixed, roller, symmetry, prescribed."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from matpoint.checks import number, numbers
from matpoint.errors import InputError, NotFiniteError
from matpoint.grid import Grid
from matpoint.places import Corners, Plane, RegionLike, Surface, Where

Velocity = Callable[[np.ndarray, float], np.ndarray]


def _select(where: Plane | RegionLike, grid: Grid, points: np.ndarray, walls_only: bool) -> np.ndarray:
    if isinstance(where, Plane):
        where.check(grid, walls_only)
        return where.select(grid, points)
    return np.asarray(where.contains(points), dtype=bool)


def _evaluate(velocity: Velocity, x: np.ndarray, time: float) -> np.ndarray:
    """Values [m/s] of a prescribed velocity, shape (m,)."""
    with np.errstate(all="ignore"):  # what is not finite is refused
        values = np.asarray(velocity(x, time), dtype=float)
    if values.shape not in ((), (len(x),)):
        raise InputError(
            f"prescribed velocity: the function returned shape {values.shape}; ({len(x)},) is needed"
        )
    bad = np.flatnonzero(~np.isfinite(np.broadcast_to(values, len(x))))
    if len(bad):
        at = ", ".join(f"{c:g}" for c in x[bad[0]])
        raise NotFiniteError(f"prescribed velocity: not a finite number at t = {time:g} s, at ({at}) m")
    return values


def _unit(normal: Sequence[float]) -> np.ndarray:
    vector = np.zeros(3)
    vector[: len(normal)] = numbers("roller: normal", normal)
    length = float(np.linalg.norm(vector))
    if not math.isfinite(length) or length == 0.0:
        raise InputError(f"roller: normal = {list(normal)} must be a finite vector that is not zero")
    return vector / length


def _check_place(what: str, where: object) -> None:
    if not isinstance(where, Plane | Surface | Corners) and not hasattr(where, "contains"):
        raise InputError(f"{what}: where = {where!r} must be a Plane, a Surface, Corners or a region")


@dataclass(frozen=True)
class Fixed:
    """All velocity components are zero.

    Parameters
    ----------
    where
        A :class:`Plane` or a region of nodes.
    """

    where: Where

    def __post_init__(self) -> None:
        _check_place("fixed", self.where)

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
        _check_place("roller", self.where)
        if self.normal is None and not isinstance(self.where, Plane):
            what = {Surface: "a surface needs", Corners: "corners need"}.get(
                type(self.where), "a region of nodes needs"
            )
            raise InputError(f"roller: {what} a normal, for instance normal = (1, 0)")
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

    def __post_init__(self) -> None:
        if not isinstance(self.where, Plane):
            raise InputError(f"symmetry: where = {self.where!r} must be a Plane")

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
        _check_place("prescribed velocity", self.where)
        if not self.velocity or all(v is None for v in self.velocity):
            raise InputError("prescribed velocity: every component is free; give at least one")
        for k, v in enumerate(self.velocity):
            if v is not None and not callable(v):
                number(f"prescribed velocity: component {k}", v, "a finite number, None or a function")

    def components(self, dim: int) -> list[tuple[np.ndarray, float | Velocity]]:
        """Return the constrained directions and their velocities [m/s]."""
        if len(self.velocity) != dim:
            raise InputError(
                f"prescribed velocity: {len(self.velocity)} components given, the grid has {dim} axes"
            )
        return [(np.eye(3)[k], v) for k, v in enumerate(self.velocity) if v is not None]


Condition = Fixed | Roller | Symmetry | PrescribedVelocity
#: Returns the node records of the vertices of a place.
VertexRecords = Callable[[Surface | Corners], np.ndarray]

_DEPENDENT = 1e-6  # what is left of a direction, below which it is held already


class Constraints:
    """All conditions as arrays for the kernel ``constrain``.

    One node may stand under several conditions along any directions. The later condition wins; of an
    earlier one the part remains that the later ones leave free (Gram-Schmidt, the last first).

    Attributes
    ----------
    index : ndarray of int64, shape (c,)
        Node records; a node stands here up to three times, with orthonormal directions.
    normal : ndarray, shape (c, 3)
    points : ndarray, shape (c, 3)
        Initial positions [m].
    """

    def __init__(
        self,
        conditions: Sequence[Condition],
        grid: Grid,
        points: np.ndarray,
        walls_only: bool,
        vertex_records: VertexRecords,
    ) -> None:
        index: list[np.ndarray] = []
        direction: list[np.ndarray] = []
        self._moving: list[tuple[slice, float | Velocity, np.ndarray]] = []
        total = 0
        for place, condition in reversed(list(enumerate(conditions))):
            where = condition.where
            if isinstance(where, Surface | Corners):
                chosen = vertex_records(where)
            else:
                chosen = np.flatnonzero(_select(where, grid, points, walls_only))
            if len(chosen) == 0:
                raise InputError(
                    f"boundary {place} ({type(condition).__name__}): no node lies in its region;"
                    " enlarge it to hold at least one line of nodes"
                )
            for towards, velocity in condition.components(grid.dim):
                index.append(chosen)
                direction.append(np.tile(towards, (len(chosen), 1)))
                part = slice(total, total + len(chosen))
                total += len(chosen)
                if callable(velocity) or velocity != 0.0:
                    self._moving.append((part, velocity, points[chosen]))
        self._raw = total
        self._orthonormalise(
            np.concatenate([np.zeros(0, dtype=np.int64), *index]),
            np.concatenate([np.zeros((0, 3)), *direction]),
        )
        self.points = points[self.index]

    def _orthonormalise(self, index: np.ndarray, direction: np.ndarray) -> None:
        """Keep, for each node, orthonormal directions, and how their values follow from those given."""
        nodes, place = np.unique(index, return_inverse=True)
        order = np.argsort(place, kind="stable")
        rank = np.arange(len(order)) - np.searchsorted(place[order], place[order])
        held = np.zeros((len(nodes), 3, 3))  # directions that each node has so far; zeros where it has none
        count = np.zeros(len(nodes), dtype=np.int64)
        slot = np.full(len(index), -1)  # which direction of its node a row becomes; -1: held already
        share, scale = np.zeros((len(index), 3)), np.zeros(len(index))
        for r in range(int(rank.max(initial=-1)) + 1):
            rows = order[rank == r]
            node = place[rows]
            along = np.einsum("nja,na->nj", held[node], direction[rows])
            rest = direction[rows] - np.einsum("nj,nja->na", along, held[node])
            length = np.sqrt((rest**2).sum(axis=1))
            free = length > _DEPENDENT
            rows, node, length = rows[free], node[free], length[free]
            held[node, count[node]] = rest[free] / length[:, None]
            slot[rows], scale[rows] = count[node], 1.0 / length
            share[rows] = along[free] / length[:, None]
            count[node] += 1
        self._rows = np.concatenate([np.flatnonzero(slot == j) for j in range(3)])
        self._slot, self._place = slot[self._rows], place[self._rows]
        self._share, self._scale = share[self._rows], scale[self._rows]
        self._nodes = len(nodes)
        self.index = index[self._rows]
        self.normal = np.ascontiguousarray(held[self._place, self._slot])

    def velocities(self, time: float) -> np.ndarray:
        """Return the prescribed velocities [m/s] at a time [s], shape (c,).

        Functions take the positions of grid nodes, and of vertices those where they began: where a
        material point is to be is a function of where it was.
        """
        if not self._moving:
            return np.zeros(len(self.index))
        given = np.zeros(self._raw)
        for part, velocity, x in self._moving:
            given[part] = _evaluate(velocity, x, time) if callable(velocity) else velocity
        values = np.zeros(len(self.index))
        so_far = np.zeros((self._nodes, 3))
        for slot in range(3):
            mine = self._slot == slot
            place, share = self._place[mine], self._share[mine]
            values[mine] = given[self._rows[mine]] * self._scale[mine] - (share * so_far[place]).sum(axis=1)
            so_far[place, slot] = values[mine]
        return values

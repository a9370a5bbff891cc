"""Regions of space: simple shapes and what can be made of them with ``|``, ``-`` and ``&``."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from matpoint.checks import instance, number, numbers, positive
from matpoint.errors import InputError

Bounds = tuple[np.ndarray, np.ndarray]
_HAIR = 1e-9  # of the extent: points on a face count as inside


def _point(what: str, values: Sequence[float], fill: float = 0.0) -> np.ndarray:
    given = numbers(what, values)
    return np.array([*given, *(fill,) * (3 - len(given))])


class Region(ABC):
    """A set of points."""

    @abstractmethod
    def contains(self, points: np.ndarray) -> np.ndarray:
        """Return a flag for each of the points, shape (n, 3) [m]."""

    @abstractmethod
    def bounds(self) -> Bounds:
        """Return the corners [m] of a box around it, shape (3,) each; infinite if not bounded."""

    def __or__(self, other: Region) -> Union:
        return Union(self, other)

    def __sub__(self, other: Region) -> Difference:
        return Difference(self, other)

    def __and__(self, other: Region) -> Intersection:
        return Intersection(self, other)


@dataclass(frozen=True)
class Box(Region):
    """A box along the axes; axes that are not given are unbounded.

    Parameters
    ----------
    lower, upper
        Corners [m].
    """

    lower: tuple[float, ...]
    upper: tuple[float, ...]

    def __post_init__(self) -> None:
        low, high = _point("box: lower", self.lower), _point("box: upper", self.upper)
        if len(self.lower) != len(self.upper):
            raise InputError(
                f"box: lower {list(self.lower)} and upper {list(self.upper)} must be equally long"
            )
        if not (high > low)[: len(self.lower)].all():
            raise InputError(
                f"box: upper = {list(self.upper)} must be greater than lower = {list(self.lower)}"
            )

    def contains(self, points: np.ndarray) -> np.ndarray:
        low, high = self.bounds()
        d = len(self.lower)
        hair = _HAIR * (high - low)[:d]
        inside = (points[:, :d] >= low[:d] - hair) & (points[:, :d] <= high[:d] + hair)
        return np.asarray(inside.all(axis=1))

    def bounds(self) -> Bounds:
        return _point("box: lower", self.lower, -np.inf), _point("box: upper", self.upper, np.inf)


@dataclass(frozen=True)
class Ball(Region):
    """A ball; a disc in 2-D, where the third coordinate is 0.

    Parameters
    ----------
    centre, radius
        [m]
    """

    centre: tuple[float, ...]
    radius: float

    def __post_init__(self) -> None:
        _point("ball: centre", self.centre)
        positive("ball: radius", self.radius)

    def contains(self, points: np.ndarray) -> np.ndarray:
        gap = points - _point("ball: centre", self.centre)
        return (gap**2).sum(axis=1) <= (self.radius * (1 + _HAIR)) ** 2

    def bounds(self) -> Bounds:
        centre = _point("ball: centre", self.centre)
        return centre - self.radius, centre + self.radius


@dataclass(frozen=True)
class Annulus(Region):
    """A ring around the z axis, or a sector of one; unbounded along z.

    Parameters
    ----------
    inner, outer
        Radii [m]; the inner one may be 0.
    angles
        First and last angle [rad], or None for the whole ring.
    centre
        [m]
    """

    inner: float
    outer: float
    angles: tuple[float, float] | None = None
    centre: tuple[float, ...] = (0.0, 0.0)

    def __post_init__(self) -> None:
        positive("annulus: outer", self.outer)
        if not 0 <= number("annulus: inner", self.inner) < self.outer:
            raise InputError(
                f"annulus: inner = {self.inner!r} must be from 0 to below outer = {self.outer:g}"
            )
        if self.angles is not None and not 0 < self.angles[1] - self.angles[0] <= 2 * math.pi + _HAIR:
            raise InputError(f"annulus: angles = {list(self.angles)} must grow by at most 2 pi")
        _point("annulus: centre", self.centre)

    def contains(self, points: np.ndarray) -> np.ndarray:
        gap = points - _point("annulus: centre", self.centre)
        r = np.hypot(gap[:, 0], gap[:, 1])
        hair = _HAIR * self.outer
        inside = (r >= self.inner - hair) & (r <= self.outer + hair)
        if self.angles is not None:
            first, last = self.angles
            turn = np.mod(np.arctan2(gap[:, 1], gap[:, 0]) - first + _HAIR, 2 * math.pi)
            inside &= turn <= last - first + 2 * _HAIR
        return inside

    def bounds(self) -> Bounds:
        centre, reach = _point("annulus: centre", self.centre), np.array([self.outer, self.outer, np.inf])
        return centre - reach, centre + reach


@dataclass(frozen=True)
class Polygon(Region):
    """A polygon in the x-y plane; unbounded along z.

    Parameters
    ----------
    points
        Its corners in order [m].
    """

    points: tuple[tuple[float, float], ...]

    def __post_init__(self) -> None:
        from shapely import Polygon as Shape  # noqa: PLC0415 (slow to import)
        from shapely.validation import explain_validity  # noqa: PLC0415

        if len(self.points) < 3 or any(len(p) != 2 for p in self.points):
            raise InputError(
                f"polygon: {len(self.points)} points given; 3 or more pairs of numbers are needed"
            )
        for p in self.points:
            _point("polygon: point", p)
        shape = Shape(self.points)
        if not shape.is_valid or shape.area == 0:
            raise InputError(f"polygon: it crosses or folds onto itself ({explain_validity(shape)})")

    def contains(self, points: np.ndarray) -> np.ndarray:
        import shapely  # noqa: PLC0415 (slow to import)

        shape = shapely.Polygon(self.points)
        low, high = self.bounds()
        hair = _HAIR * float((high - low)[:2].max())
        return np.asarray(shapely.dwithin(shape, shapely.points(points[:, 0], points[:, 1]), hair))

    def bounds(self) -> Bounds:
        corners = np.array(self.points, dtype=float)
        low, high = corners.min(axis=0), corners.max(axis=0)
        return np.array([*low, -np.inf]), np.array([*high, np.inf])


@dataclass(frozen=True)
class HalfSpace(Region):
    """The side of a plane that its normal points away from.

    Parameters
    ----------
    point
        A point of the plane [m].
    normal
        Outward normal, of any length.
    """

    point: tuple[float, ...]
    normal: tuple[float, ...]

    def __post_init__(self) -> None:
        _point("half-space: point", self.point)
        if not _point("half-space: normal", self.normal).any():
            raise InputError(f"half-space: normal = {list(self.normal)} must not be zero")

    def contains(self, points: np.ndarray) -> np.ndarray:
        normal = _point("half-space: normal", self.normal)
        normal = normal / np.linalg.norm(normal)
        return (points - _point("half-space: point", self.point)) @ normal <= _HAIR

    def bounds(self) -> Bounds:
        normal, point = _point("half-space: normal", self.normal), _point("half-space: point", self.point)
        low, high = np.full(3, -np.inf), np.full(3, np.inf)
        along = np.flatnonzero(normal)
        if len(along) == 1:
            (high if normal[along[0]] > 0 else low)[along[0]] = point[along[0]]
        return low, high


def _check_parts(*parts: object) -> None:
    for part in parts:
        instance("region", part, Region, "a region, to be combined with another")


@dataclass(frozen=True)
class Union(Region):
    """All points of either region."""

    first: Region
    second: Region

    def __post_init__(self) -> None:
        _check_parts(self.first, self.second)

    def contains(self, points: np.ndarray) -> np.ndarray:
        return self.first.contains(points) | self.second.contains(points)

    def bounds(self) -> Bounds:
        (a, b), (c, d) = self.first.bounds(), self.second.bounds()
        return np.minimum(a, c), np.maximum(b, d)


@dataclass(frozen=True)
class Difference(Region):
    """The points of the first region that are not in the second."""

    first: Region
    second: Region

    def __post_init__(self) -> None:
        _check_parts(self.first, self.second)

    def contains(self, points: np.ndarray) -> np.ndarray:
        return self.first.contains(points) & ~self.second.contains(points)

    def bounds(self) -> Bounds:
        return self.first.bounds()


@dataclass(frozen=True)
class Intersection(Region):
    """The points that both regions have."""

    first: Region
    second: Region

    def __post_init__(self) -> None:
        _check_parts(self.first, self.second)

    def contains(self, points: np.ndarray) -> np.ndarray:
        return self.first.contains(points) & self.second.contains(points)

    def bounds(self) -> Bounds:
        (a, b), (c, d) = self.first.bounds(), self.second.bounds()
        return np.maximum(a, c), np.minimum(b, d)


@dataclass(frozen=True)
class Where(Region):
    """The points that a Python function accepts.

    Parameters
    ----------
    predicate
        Takes points (n, 3) [m], returns flags (n,).
    lower, upper
        Corners [m] of a box around the region, needed to fill it.
    """

    predicate: Callable[[np.ndarray], np.ndarray]
    lower: tuple[float, ...]
    upper: tuple[float, ...]

    def __post_init__(self) -> None:
        Box(self.lower, self.upper)

    def contains(self, points: np.ndarray) -> np.ndarray:
        flags = np.asarray(self.predicate(points))
        if flags.shape != (len(points),) or flags.dtype != bool:
            raise InputError(
                f"where: the predicate returned {flags.dtype} of shape {flags.shape};"
                f" flags of shape ({len(points)},) are needed"
            )
        return flags & Box(self.lower, self.upper).contains(points)

    def bounds(self) -> Bounds:
        return Box(self.lower, self.upper).bounds()

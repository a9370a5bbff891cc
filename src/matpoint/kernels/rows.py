"""Rows of 1-D weights: what one grid axis gives to one particle.

An axis is a small named tuple. Its *type* chooses the basis when a kernel is compiled, so that
the loops over a row have a length known to the compiler, and one kernel text serves every basis
in one, two and three dimensions: a missing axis is ``Absent``, one node of weight 1, gradient 0.

``row(axis, x, l)`` returns ``(first node, weights, derivatives [1/m])``; ``methods`` section 2.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from numba import types
from numba.extending import overload

from matpoint.jit import FAST_MATH, device, set_item


class Absent(NamedTuple):
    """An axis that the run does not have."""

    nodes: int


class Hat(NamedTuple):
    """Linear hats, two nodes (MPM; the grid of the vertex family)."""

    origin: float
    inverse: float
    cells: int


class Gimp(NamedTuple):
    """Hats averaged over [x - l, x + l]; ``reach``: zeros, as many as the row is long (3 for 2l <= h)."""

    origin: float
    inverse: float
    reach: tuple[float, ...]


class EqualGimp(NamedTuple):
    """``Gimp`` for boxes of one size: ``half`` = l / h, ``share`` = h / 2l."""

    origin: float
    inverse: float
    half: float
    share: float
    reach: tuple[float, ...]


class Quadratic(NamedTuple):
    """Quadratic B-splines with open knots at both ends."""

    origin: float
    inverse: float
    cells: int


class Cubic(NamedTuple):
    """Cubic B-splines with open knots at both ends."""

    origin: float
    inverse: float
    cells: int


@device
def hat_integral(r):
    """Antiderivative of the unit hat over h, 0 for r <= -1 and 1 for r >= 1 (methods, section 2)."""
    r = min(max(r, -1.0), 1.0)
    return 0.5 + r - 0.5 * r * abs(r)


@device
def hat(r):
    """The unit hat S(r) = max(0, 1 - |r|)."""
    return 1.0 - min(abs(r), 1.0)


def _absent(axis, x, length):
    return 0, (1.0,), (0.0,)


def _hat(axis, x, length):
    r = (x - axis.origin) * axis.inverse
    cell = min(max(int(r), 0), axis.cells - 1)
    f = r - cell
    return cell, (1.0 - f, f), (-axis.inverse, axis.inverse)


def _quadratic(axis, x, length):
    """Three splines of the clamped knots around the cell; they sum to 1 by construction."""
    r = (x - axis.origin) * axis.inverse
    cell = min(max(int(r), 0), axis.cells - 1)
    down, up = cell + 1.0 - r, r - cell
    # One over the distance to the knot beyond: two cells, or one beside a wall.
    wide_left, wide_right = 0.5 if cell > 0 else 1.0, 0.5 if cell + 1 < axis.cells else 1.0
    w0, w2 = down * down * wide_left, up * up * wide_right
    d0, d2 = -2.0 * down * wide_left * axis.inverse, 2.0 * up * wide_right * axis.inverse
    return cell, (w0, 1.0 - w0 - w2, w2), (d0, -d0 - d2, d2)


def _cubic(axis, x, length):
    """Four splines by the Cox-de Boor recursion on clamped knots."""
    r = (x - axis.origin) * axis.inverse
    cell = min(max(int(r), 0), axis.cells - 1)
    l1, r1 = r - cell, cell + 1.0 - r
    l2, r2 = r - max(cell - 1, 0), min(cell + 2, axis.cells) - r
    l3, r3 = r - max(cell - 2, 0), min(cell + 3, axis.cells) - r
    a, b = r1 / (r1 + l2), l1 / (r2 + l1)
    m0, m1, m2 = r1 * a, l2 * a + r2 * b, l1 * b
    p, q, s = m0 / (r1 + l3), m1 / (r2 + l2), m2 / (r3 + l1)
    t = 3.0 * axis.inverse
    weights = (r1 * p, l3 * p + r2 * q, l2 * q + r3 * s, l1 * s)
    return cell, weights, (-t * p, t * (p - q), t * (q - s), t * s)


def _gimp(axis, x, length):
    half = length * axis.inverse
    return _averaged(axis, (x - axis.origin) * axis.inverse, half, 0.5 / half)


def _equal_gimp(axis, x, length):
    return _averaged(axis, (x - axis.origin) * axis.inverse, axis.half, axis.share)


@device
def _averaged(axis, r, half, c):
    """The hat's mean over [x - l, x + l]: one formula for every l / h (methods, section 2).

    The lower end v lies in [0, 1), so its integrals are 0 but for the first two; weights sum to 1.
    """
    first, last = int(r - half), len(axis.reach) - 1
    u, v = r + half - first, r - half - first
    s = c * axis.inverse
    over = max(u - last + 1.0, 0.0)
    w, d = c * 0.5 * over * over, s * over
    low, slope = c * 0.5 * v * v, s * v
    weights, slopes = set_item(axis.reach, last, w), set_item(axis.reach, last, d)
    rest, fall = 1.0 - w, -d
    for i in range(last - 1, 0, -1):
        w, d = c * hat_integral(u - i), s * hat(u - i)
        if i == 1:
            w, d = w - low, d - slope
        weights, slopes = set_item(weights, i, w), set_item(slopes, i, d)
        rest, fall = rest - w, fall - d
    return first, set_item(weights, 0, rest), set_item(slopes, 0, fall)


_ROWS = {
    Absent: _absent, Hat: _hat, Gimp: _gimp, EqualGimp: _equal_gimp, Quadratic: _quadratic, Cubic: _cubic,
}  # fmt: skip


def row(axis: Any, x: float, length: float) -> Any:
    """First node, weights and derivatives [1/m] of one axis at coordinate ``x`` [m].

    Parameters
    ----------
    axis
        One of this module's named tuples.
    x, length
        Coordinate [m] and half-length [m] of the particle's domain; only ``Gimp`` reads the latter.
    """
    raise TypeError("row() exists in compiled code only")


@overload(row, jit_options={"fastmath": FAST_MATH, "error_model": "numpy"}, inline="never")
def _row(axis, x, length):
    kind = getattr(axis, "instance_class", None)
    return _ROWS.get(kind) if isinstance(axis, types.BaseNamedTuple) else None

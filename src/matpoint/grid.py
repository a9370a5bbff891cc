"""The background grid: a box of equal cells, in one, two or three dimensions."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from numbers import Real

from matpoint.checks import numbers
from matpoint.errors import InputError

_EXACT = 1e-6  # how far, in cells, the box may be from a whole number of cells


def _numbers(name: str, values: Sequence[float] | float) -> tuple[float, ...]:
    return numbers(f"grid: {name}", (values,) if isinstance(values, Real) else values)


@dataclass(frozen=True)
class Grid:
    """A box of equal cells.

    Bodies must stay inside the box. Nodes beyond it, where an interpolation's domains overhang,
    are added by themselves.

    Parameters
    ----------
    lower, upper
        Corners of the box [m], one number per axis; their count is the dimension.
    cell
        Cell size [m], one number per axis or one for all.

    Raises
    ------
    InputError
        If sizes are not positive and finite, or the box is not a whole number of cells.
    """

    lower: tuple[float, ...]
    upper: tuple[float, ...]
    cell: tuple[float, ...]

    def __init__(
        self,
        lower: Sequence[float] | float,
        upper: Sequence[float] | float,
        cell: Sequence[float] | float,
    ) -> None:
        low, high, size = _numbers("lower", lower), _numbers("upper", upper), _numbers("cell", cell)
        if len(size) == 1:
            size = size * len(low)
        if not len(low) == len(high) == len(size):
            raise InputError(
                f"grid: lower, upper and cell have {len(low)}, {len(high)} and {len(size)} numbers;"
                " they must agree (cell may also be one number)"
            )
        for k, (a, b, h) in enumerate(zip(low, high, size, strict=True)):
            if h <= 0:
                raise InputError(f"grid: cell[{k}] = {h:g} must be positive")
            if b <= a:
                raise InputError(f"grid: upper[{k}] = {b:g} must be greater than lower[{k}] = {a:g}")
            count = (b - a) / h
            if abs(count - round(count)) > _EXACT * max(1.0, count) or round(count) < 1:
                raise InputError(
                    f"grid: axis {k} from {a:g} to {b:g} holds {count:g} cells of {h:g};"
                    f" it must be a whole number (upper[{k}] = {a + max(1, round(count)) * h:g} would do)"
                )
        if math.prod(round((b - a) / h) + 1 for a, b, h in zip(low, high, size, strict=True)) > 2**31:
            raise InputError("grid: more than 2^31 nodes; use larger cells or a smaller box")
        object.__setattr__(self, "lower", low)
        object.__setattr__(self, "upper", high)
        object.__setattr__(self, "cell", size)

    @property
    def dim(self) -> int:
        """The number of axes: 1, 2 or 3."""
        return len(self.lower)

    @property
    def cells(self) -> tuple[int, ...]:
        """The number of cells along each axis."""
        return tuple(round((b - a) / h) for a, b, h in zip(self.lower, self.upper, self.cell, strict=True))

    @property
    def finest(self) -> float:
        """The smallest cell size [m]."""
        return min(self.cell)

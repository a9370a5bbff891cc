"""Checks of what a user gives from Python: one message that says what, the value, and what is allowed."""

from __future__ import annotations

import math
from collections.abc import Sequence
from numbers import Integral, Real
from typing import Any

from matpoint.errors import InputError


def number(what: str, value: Any, allowed: str = "a finite number") -> float:
    """Return a finite number, Python's or NumPy's, as a float; raise InputError for anything else."""
    if isinstance(value, bool) or not isinstance(value, Real) or not math.isfinite(value):
        raise InputError(f"{what} = {value!r} must be {allowed}")
    return float(value)


def positive(what: str, value: Any) -> float:
    """Return a finite number > 0."""
    given = number(what, value, "a positive number")
    if given <= 0:
        raise InputError(f"{what} = {value!r} must be a positive number")
    return given


def not_negative(what: str, value: Any) -> float:
    """Return a finite number >= 0."""
    given = number(what, value, "a number >= 0")
    if given < 0:
        raise InputError(f"{what} = {value!r} must be a number >= 0")
    return given


def whole(what: str, value: Any, least: int = 1) -> int:
    """Return a whole number, Python's or NumPy's, that is not below ``least``."""
    if isinstance(value, bool) or not isinstance(value, Integral) or value < least:
        raise InputError(f"{what} = {value!r} must be a whole number >= {least}")
    return int(value)


def numbers(what: str, values: Any, most: int = 3) -> tuple[float, ...]:
    """Return 1 to ``most`` finite numbers as a tuple."""
    allowed = f"1 to {most} finite numbers"
    if isinstance(values, str) or not hasattr(values, "__iter__"):
        raise InputError(f"{what} = {values!r} must be {allowed}")
    given = tuple(number(what, v, allowed) for v in values)
    if not 1 <= len(given) <= most:
        raise InputError(f"{what} = {list(given)} must be {allowed}")
    return given


def instance(what: str, value: Any, kinds: Any, allowed: str) -> None:
    """Refuse a value that is not an instance of ``kinds``; a class or a name says so."""
    if not isinstance(value, kinds):
        raise InputError(f"{what} = {value!r}: it must be {allowed}")


def instances(what: str, values: Any, kinds: Any, allowed: str) -> None:
    """Refuse a value that is not a list or tuple of instances of ``kinds``."""
    if isinstance(values, str) or not isinstance(values, Sequence):
        raise InputError(f"{what} = {values!r}: it must be a list of {allowed}")
    for k, value in enumerate(values):
        instance(f"{what}[{k}]", value, kinds, allowed)


def function(what: str, value: Any) -> None:
    """Refuse a value that can't be called."""
    if not callable(value):
        raise InputError(f"{what} = {value!r} must be a function")

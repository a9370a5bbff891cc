"""Validation of material parameters: one message that says what, the value, and what is allowed."""

from __future__ import annotations

import math
from typing import Any

from matpoint.errors import InputError


def _number(owner: object, name: str) -> tuple[float | None, str]:
    """Return an attribute as a finite float, or None; and how an error message shows it."""
    value: Any = getattr(owner, name)
    shown = f"{type(owner).__name__}: {name} = {value!r}"
    if isinstance(value, bool | str | bytes):
        return None, shown
    try:
        number = float(value)
    except (TypeError, ValueError, OverflowError):
        return None, shown
    return (number if math.isfinite(number) else None), shown


def positive(owner: object, name: str, unit: str) -> None:
    """Refuse an attribute that is not a finite number > 0."""
    number, shown = _number(owner, name)
    if number is None or number <= 0.0:
        raise InputError(f"{shown} is not allowed: it must be a finite number > 0 [{unit}]")


def not_negative(owner: object, name: str, unit: str) -> None:
    """Refuse an attribute that is not a finite number ≥ 0."""
    number, shown = _number(owner, name)
    if number is None or number < 0.0:
        raise InputError(f"{shown} is not allowed: it must be a finite number >= 0 [{unit}]")


def between(owner: object, name: str, lower: float, upper: float) -> None:
    """Refuse an attribute that is not a number strictly between two bounds."""
    number, shown = _number(owner, name)
    if number is None or not lower < number < upper:
        raise InputError(f"{shown} is not allowed: it must be a number > {lower:g} and < {upper:g}")


def boolean(owner: object, name: str) -> None:
    """Refuse an attribute that is not true or false."""
    value: Any = getattr(owner, name)
    if not isinstance(value, bool):
        shown = f"{type(owner).__name__}: {name} = {value!r}"
        raise InputError(f"{shown} is not allowed: it must be true or false")

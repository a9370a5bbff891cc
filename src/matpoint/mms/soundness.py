"""Fields that are no finite numbers, found before a run."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from matpoint.checks import number
from matpoint.errors import InputError

#: A field of reference positions (n, 3) [m] and a time [s].
Field = Callable[[np.ndarray, float], np.ndarray]
_SHAPE = "reference positions [m], an array of numbers of shape (n, 3)"


def places(X: Any) -> np.ndarray:
    """Return reference positions as an array of floats (n, 3).

    Raises
    ------
    InputError
        If they are of another shape, or no finite numbers.
    """
    try:
        found = np.asarray(X, dtype=float)
    except (TypeError, ValueError):
        raise InputError(f"manufactured solution: X = {X!r} must be {_SHAPE}") from None
    if found.ndim != 2 or found.shape[1] != 3:
        raise InputError(
            f"manufactured solution: X has shape {found.shape}; it must be {_SHAPE}, with 0 for axes that are"
            " not there"
        )
    return found


def some_places(X: Any) -> np.ndarray:
    """Return reference positions to look at: as :func:`places`, at least one, and finite."""
    found = places(X)
    if len(found) == 0 or not np.isfinite(found).all():
        raise InputError(f"manufactured solution: X must be {_SHAPE}, at least one, all of them finite")
    return found


def instants(times: Any) -> list[float]:
    """Return times [s] as floats.

    Raises
    ------
    InputError
        If there are none, or one is no finite number.
    """
    if isinstance(times, str) or not hasattr(times, "__iter__"):
        raise InputError(f"manufactured solution: times = {times!r} must be a list of finite numbers [s]")
    found = [number("manufactured solution: time", t) for t in times]
    if not found:
        raise InputError("manufactured solution: times = []: at least one is needed [s]")
    return found


def refuse_infinite(fields: Mapping[str, Field], X: np.ndarray, times: Sequence[float]) -> None:
    """Refuse a solution with a field that is no finite number at one of some places and times.

    Parameters
    ----------
    fields
        Name -> field.
    X
        The places [m], (n, 3).
    times
        [s].

    Raises
    ------
    InputError
        With the field, and the first place and time.
    """
    for name, field in fields.items():
        for time in times:
            with np.errstate(all="ignore"):
                values = field(X, time).reshape(len(X), -1)
            if not math.isfinite(values.sum()):  # a sum may overflow too, hence the second look
                bad = np.flatnonzero(~np.isfinite(values).all(axis=1))
                if len(bad):
                    place = ", ".join(f"{x:.4g}" for x in X[bad[0]])
                    raise InputError(
                        f"manufactured solution: {name} is no finite number at X = ({place}) m,"
                        f" t = {time:.4g} s; u must be real, finite and twice differentiable wherever and"
                        " whenever there is a body"
                    )

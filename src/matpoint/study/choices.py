"""Interpolations and transfers as JSON, for other processes and for the keys of the store."""

from __future__ import annotations

import dataclasses
import inspect
from functools import cache
from typing import Any

from matpoint.errors import InputError


@cache
def _known() -> dict[str, type]:
    """The choices of matpoint's own that a task may hold, by the names of their classes."""
    from matpoint import interpolation, regions, transfers  # noqa: PLC0415 (compiles)

    kinds = [
        (name, kind)
        for module in (interpolation, regions, transfers)
        for name, kind in inspect.getmembers(module, inspect.isclass)
        if dataclasses.is_dataclass(kind)
    ]
    return dict(kinds)


def packed(choice: Any) -> Any:
    """Return a choice as JSON knows it: each class by its name under ``is``, beside its parameters.

    Raises
    ------
    InputError
        If something in it is not matpoint's own: another process could not make it again.
    """
    if choice is None or isinstance(choice, bool | int | float | str):
        return choice
    if isinstance(choice, list | tuple):
        return [packed(part) for part in choice]
    name = type(choice).__name__
    if _known().get(name) is not type(choice):
        raise InputError(
            f"converge: {choice!r} can't be sent to the processes of a study; only interpolations, transfers"
            " and regions of matpoint, numbers and texts can"
        )
    fields = [f.name for f in dataclasses.fields(choice) if f.init]
    return {"is": name, **{field: packed(getattr(choice, field)) for field in fields}}


def unpacked(given: Any) -> Any:
    """Return the choice that :func:`packed` put away."""
    if isinstance(given, list):
        return tuple(unpacked(part) for part in given)
    if not isinstance(given, dict):
        return given
    kind = _known()[given["is"]]
    return kind(**{name: unpacked(value) for name, value in given.items() if name != "is"})


def changed(choice: Any) -> str:
    """Return what differs from the defaults of a choice's class, ``degree = 1, points = 1``, or nothing."""
    fields = dataclasses.fields(choice)
    pairs = [(f, getattr(choice, f.name)) for f in fields if f.init]
    return ", ".join(f"{f.name} = {value!r}" for f, value in pairs if value != f.default)

"""Materials by name: what case files and plugins use."""

from __future__ import annotations

import difflib
import inspect
from collections.abc import Callable
from typing import Any

from matpoint.errors import InputError
from matpoint.materials.contract import Material

#: Name in case files → what makes the material from keyword arguments.
MATERIALS: dict[str, Callable[..., Material]] = {}


def register_material(name: str, factory: Callable[..., Material]) -> None:
    """Make a material available to case files under a name.

    Parameters
    ----------
    name
        The ``law`` of a case file, such as "neo-hookean".
    factory
        A :class:`Material` class, or a function of keyword arguments that returns a material.

    Raises
    ------
    InputError
        The name is taken by something else.
    """
    if MATERIALS.get(name, factory) is not factory:
        raise InputError(f"a material named {name!r} is registered already; choose another name")
    MATERIALS[name] = factory


def material_from(law: str, **parameters: Any) -> Material:
    """Return the material of a name with the given parameters.

    Raises
    ------
    InputError
        The name is unknown, a parameter is unknown or missing, or a value is out of range.
    """
    if law not in MATERIALS:
        raise InputError(f"unknown material {law!r}{_hint(law, MATERIALS)}; there are {', '.join(MATERIALS)}")
    known = inspect.signature(MATERIALS[law]).parameters
    names = [name for name, p in known.items() if p.kind not in (p.VAR_POSITIONAL, p.VAR_KEYWORD)]
    if not any(p.kind is p.VAR_KEYWORD for p in known.values()):
        for name in parameters:
            if name not in names:
                raise InputError(
                    f"material {law!r} has no parameter {name!r}{_hint(name, names)};"
                    f" it takes {', '.join(names)}"
                )
    needed = [name for name in names if known[name].default is inspect.Parameter.empty]
    missing = [name for name in needed if name not in parameters]
    if missing:
        raise InputError(f"material {law!r} lacks {', '.join(missing)}; it takes {', '.join(names)}")
    return MATERIALS[law](**parameters)


def _hint(word: str, known: Any) -> str:
    """Return ", did you mean ...?" or nothing."""
    near = difflib.get_close_matches(str(word).lower().replace("_", "-"), list(known), n=1)
    near = near or difflib.get_close_matches(str(word), list(known), n=1)
    return f" (did you mean {near[0]!r}?)" if near else ""

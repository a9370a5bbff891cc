"""What a run is, in words that are the same in every process; and what a restart must agree with."""

from __future__ import annotations

import dataclasses
import hashlib
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from matpoint.simulation import Simulation


def spelled(thing: Any) -> str:
    """Return a text that says what a choice of the user is: classes, parameters, functions by their names.

    Unlike ``repr`` it never holds an address, so it is the same in the next process.
    """
    if isinstance(thing, np.ndarray):
        data = np.ascontiguousarray(thing)
        return f"array {data.dtype} {data.shape} {hashlib.sha256(data.tobytes()).hexdigest()[:16]}"
    if isinstance(thing, Mapping):
        return "{" + ", ".join(f"{key}={spelled(value)}" for key, value in thing.items()) + "}"
    if isinstance(thing, list | tuple):
        return "(" + ", ".join(spelled(value) for value in thing) + ")"
    if dataclasses.is_dataclass(thing) and not isinstance(thing, type):
        fields = {f.name: getattr(thing, f.name) for f in dataclasses.fields(thing) if f.repr}
        return f"{type(thing).__name__}({', '.join(f'{k}={spelled(v)}' for k, v in fields.items())})"
    if isinstance(thing, np.generic):
        return repr(thing.item())
    if isinstance(thing, float | int | str | bytes) or thing is None:
        return repr(thing)
    return _named(thing)


def _named(thing: Any) -> str:
    """A function by its name, also if it was compiled; anything else by its class and its attributes."""
    function = getattr(thing, "py_func", thing)
    name = getattr(function, "__qualname__", None)
    if name is not None:
        return str(name)
    # functools.partial, callable objects, classes of the user that are no dataclasses
    inner = [spelled(getattr(thing, key)) for key in ("func", "args", "keywords") if hasattr(thing, key)]
    held = getattr(thing, "__dict__", {})
    parts = inner + [f"{key}={spelled(value)}" for key, value in held.items()]
    return f"{type(thing).__name__}({', '.join(parts)})"


def identity(sim: Simulation) -> dict[str, str]:
    """Return what a checkpoint and the run that takes it up must agree on, each as a hash.

    Loads, time step, end time, writers and threads may differ: they act on what is to come only.
    """
    p = sim.particles
    names = ("position0", "mass", "volume0", "material", "body")
    parts: dict[str, Any] = {
        "grid": sim.grid,
        "interpolation": sim.interpolation,
        "scheme": sim.scheme,
        "materials": sim.materials,
        "bodies": [b.name if b.start is None else (b.name, b.start) for b in sim.bodies],
        "particles": [p.ordered(name) for name in names],
        "boundaries": sim.boundaries,
        "damping": sim.engine.damping,
    }
    return {name: hashlib.sha256(spelled(part).encode()).hexdigest() for name, part in parts.items()}

"""The memory that a simulation holds, and what one needs."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from matpoint.errors import InputError
from matpoint.simulation import Simulation
from matpoint.vertices import Vertices


def held(sim: Simulation) -> Iterator[tuple[str, str, np.ndarray]]:
    """Yield group, name and array of all that a simulation holds; views of one array only once.

    Groups are ``particles``, ``domains`` (corners and their weights), ``nodes`` and ``transfers``.
    """
    seen: set[int] = set()

    def walk(thing: Any, group: str, name: str) -> Iterator[tuple[str, str, np.ndarray]]:
        if isinstance(thing, np.ndarray):
            while isinstance(thing.base, np.ndarray):
                thing = thing.base
            if id(thing) not in seen:
                seen.add(id(thing))
                yield group, name, thing
        elif isinstance(thing, dict):
            for key, value in thing.items():
                yield from walk(value, group, f"{name}.{key}")
        elif isinstance(thing, list | tuple):
            for value in thing:
                yield from walk(value, group, name)
        elif id(thing) not in seen and type(thing).__module__.startswith("matpoint"):
            seen.add(id(thing))
            group = "domains" if isinstance(thing, Vertices) else group
            for key, value in getattr(thing, "__dict__", {}).items():
                yield from walk(value, group, key)

    engine = sim.engine
    yield from walk(engine.particles, "particles", "")
    yield from walk(engine.mapping.nodes, "nodes", "")
    yield from walk(engine, "transfers", "")


@dataclass(frozen=True)
class Need:
    """What one thing needs: how many there are, and bytes of each.

    Attributes
    ----------
    count
        Particles, or nodes.
    bytes_each
        Bytes by group.
    """

    count: float
    bytes_each: dict[str, float]

    @property
    def total(self) -> float:
        """All bytes."""
        return self.count * sum(self.bytes_each.values())


@dataclass(frozen=True)
class Forecast:
    """Memory of a run [bytes], to within a few per cent.

    Attributes
    ----------
    particles, nodes
        What they need; ``nodes`` includes what setting up takes for a while.
    free
        What the machine has free now.
    """

    particles: Need
    nodes: Need
    free: float

    @property
    def total(self) -> float:
        """All of it."""
        return self.particles.total + self.nodes.total

    def check(self) -> None:
        """Refuse a run that needs more memory than is free.

        Raises
        ------
        InputError
            With the sizes, and what would help.
        """
        if self.total <= self.free:
            return
        larger = self.nodes if self.nodes.total > self.particles.total else self.particles
        help_ = "use larger cells or a smaller box" if larger is self.nodes else (
            "use a smaller per_cell, smaller regions, larger cells or a method that keeps less"
        )  # fmt: skip
        raise InputError(
            f"memory: {self.particles.count:.3g} particles of {sum(self.particles.bytes_each.values()):.0f}"
            f" bytes and {self.nodes.count:.3g} nodes of {sum(self.nodes.bytes_each.values()):.0f} bytes need"
            f" about {self.total / 1e9:.3g} GB, this machine has {self.free / 1e9:.3g} GB free; {help_}"
        )

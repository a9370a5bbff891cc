"""One row of the benchmark: a run whose steps, stages and sorts are timed."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from statistics import median
from typing import Any

from matpoint.bench.block import METHODS, block, cells_for
from matpoint.engine import Engine
from matpoint.scheme import USL, Stage
from matpoint.simulation import Simulation
from matpoint.timestep import FixedStep

STEPS = 10  #: in a round: a ledger entry falls into each
WARM_UP = 2  # steps, after which all code is loaded and all memory has been touched


class Clock:
    """Seconds spent under each name."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}

    def timed(self, name: str, call: Callable[..., None]) -> Callable[..., None]:
        """Return the call, with its time added to ``name``."""

        def run(*arguments: Any) -> None:
            begin = time.perf_counter()
            call(*arguments)
            self.seconds[name] = self.seconds.get(name, 0.0) + time.perf_counter() - begin

        return run


@dataclass(frozen=True)
class ClockedUSL(USL):
    """USL, each stage under a clock."""

    clock: Clock = field(default_factory=Clock)

    @property
    def stages(self) -> tuple[Stage, ...]:
        return tuple(replace(s, run=self._timed(s)) for s in super().stages)

    def _timed(self, stage: Stage) -> Callable[[Engine], None]:
        return self.clock.timed(stage.name, stage.run)


class ClockedSimulation(Simulation):
    """A simulation that also keeps the times of its sorts apart."""

    def sort(self) -> None:
        assert isinstance(self.scheme, ClockedUSL)
        self.scheme.clock.timed("sort", super().sort)()


class Row:
    """A method in one dimension on some threads, ready to be measured.

    Parameters
    ----------
    name
        A key of ``METHODS``.
    dim, particles, threads
        About so many particles; the block is a cube of whole cells.

    Attributes
    ----------
    rounds : list of dict
        Seconds per step in each round: of each stage, and of the rest; sorting is left out.
    """

    def __init__(self, name: str, dim: int, particles: int, threads: int) -> None:
        self.name, self.dim, self.threads = name, dim, threads
        self.rounds: list[dict[str, float]] = []
        self._sorts: list[float] = []
        self._clock = Clock()
        cells = cells_for(particles, dim)
        grid, body, gravity, dt = block(dim, cells)
        self._simulation = ClockedSimulation(
            grid,
            [body],
            interpolation=METHODS[name](dim, cells),
            timestep=FixedStep(dt),
            scheme=ClockedUSL(clock=self._clock),
            loads=[gravity],
            threads=threads,
        )
        self.particles = len(self._simulation.particles)
        vertices = self._simulation.vertices
        self.enriched = None if vertices is None else len(vertices.enriched) / len(vertices)
        self.sort_every = self._simulation.sort_every
        self._advance(WARM_UP)
        self._simulation.book()
        self._simulation.sort()
        self._clock.seconds.clear()

    def measure(self) -> None:
        """Make one round of steps."""
        self._clock.seconds.clear()
        begin = time.perf_counter()
        self._advance(STEPS)
        wall = time.perf_counter() - begin
        seconds = self._clock.seconds
        if "sort" in seconds:
            self._sorts.append(seconds["sort"])
        parts = {name: s / STEPS for name, s in seconds.items() if name != "sort"}
        whole = (wall - seconds.get("sort", 0.0)) / STEPS
        self.rounds.append(parts | {"rest": max(0.0, whole - sum(parts.values()))})

    def finish(self) -> None:
        """Measure one sort if none has come, and let go of the run."""
        if not self._sorts:
            self._clock.seconds.clear()
            self._simulation.sort()
            self._sorts.append(self._clock.seconds["sort"])
        self._simulation.engine.team.close()
        del self._simulation

    @property
    def steps_ns(self) -> list[float]:
        """Nanoseconds per particle-step in each round, each with its share of a sort (``sort_every``)."""
        return [1e9 * (sum(parts.values()) + self._sort()) / self.particles for parts in self.rounds]

    def stages_ns(self) -> dict[str, float]:
        """Return the nanoseconds per particle-step of each stage, of sorting, and of the rest.

        The rest is the ledger, and Python between the stages. They add up to the median of ``steps_ns``.
        """
        seconds = {name: median(parts[name] for parts in self.rounds) for name in self.rounds[0]}
        rest = seconds.pop("rest")
        seconds |= {"sort": self._sort(), "rest": rest}
        scale = median(self.steps_ns) / sum(seconds.values())
        return {name: scale * s for name, s in seconds.items()}

    def _sort(self) -> float:
        """Seconds of sorting that fall to one step."""
        return sum(self._sorts) / max(1, len(self._sorts)) / self.sort_every

    def _advance(self, steps: int) -> None:
        for _ in range(steps):
            self._simulation.advance(self._simulation.dt)

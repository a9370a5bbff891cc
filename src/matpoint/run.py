"""The loop over steps: triggers, writers, progress, interruption."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from functools import partial
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from matpoint.errors import InputError, RunError
from matpoint.interrupts import Interrupt, interruptible
from matpoint.timestep import FixedStep, stable_step

if TYPE_CHECKING:
    from matpoint.output.contract import Writer
    from matpoint.simulation import Simulation

_LOOKS = 100  # steps between two looks at the limit of a fixed step


class Observer(Protocol):
    """Something that is told of a run's progress."""

    def start(self, sim: Simulation, until: float) -> None:
        """Take note that the run begins."""
        ...

    def advance(self, sim: Simulation) -> None:
        """Take note that a step is done."""
        ...

    def stop(self, error: BaseException | None) -> None:
        """Take note that the run has ended, and how."""
        ...


def _lengths(sim: Simulation, until: float) -> Iterator[float]:
    """Yield the length of each step [s]."""
    if isinstance(sim.timestep, FixedStep):
        dt, start = sim.timestep.dt, sim.time
        count = math.ceil((until - start) / dt - 1e-9)
        for number in range(1, count + 1):
            # Ends of steps are multiples of dt, not sums: no drift over many steps.
            yield start + number * dt - sim.time
            _watch(sim, dt)
        return
    rule, dt = sim.timestep, sim.dt
    while sim.time < until * (1.0 - 1e-12):
        if sim.step % rule.every == 0:
            dt = min(rule.fraction * stable_step(sim), rule.largest)
        yield min(dt, until - sim.time)


def _watch(sim: Simulation, dt: float) -> None:
    """Note once that a fixed step has come over the limit of the deformed state."""
    if sim.step % _LOOKS or any("has come over" in note for note in sim.notes):
        return
    limit = stable_step(sim)
    if dt > limit:
        sim.notes.append(
            f"time step: dt = {dt:.4g} s has come over the limit of {limit:.4g} s at step {sim.step}"
        )


def run_steps(sim: Simulation, until: float, writers: Sequence[Writer], progress: Observer | None) -> None:
    """Step ``sim`` to the time ``until`` [s]; writers are closed whatever happens.

    Raises
    ------
    RunError
        If a step fails, or a file can't be written any more.
    """
    try:
        with ExitStack() as stack:
            for writer in writers:
                writer.open(sim)
                stack.push(partial(_close, writer, sim))
            if progress is not None:
                progress.start(sim, until)
                stack.push(partial(_stop, progress))
            with interruptible() as interrupt:
                _loop(sim, until, writers, progress, interrupt)
    except OSError as error:  # the folder was fine at the start: the disk is full, or is gone
        raise _failed(sim, error) from None


def _failed(sim: Simulation, error: OSError) -> RunError:
    what = f"{error.filename}: {error.strerror}" if error.filename else str(error)
    return RunError(what, step=sim.step, time=sim.time)


def _close(writer: Writer, sim: Simulation, _kind: Any, error: BaseException | None, _trace: Any) -> None:
    try:
        writer.close(sim, error)
    except OSError:
        if error is None:  # else what ended the run says more
            raise


def _stop(progress: Observer, _kind: Any, error: BaseException | None, _trace: Any) -> None:
    progress.stop(error)


def _loop(
    sim: Simulation,
    until: float,
    writers: Sequence[Writer],
    progress: Observer | None,
    interrupt: Interrupt,
) -> None:
    previous = -math.inf
    if sim.step == 0:
        _write(sim, writers, previous)
    for dt in _lengths(sim, until):
        previous = sim.time
        _advance(sim, dt)
        _write(sim, writers, previous)
        if progress is not None:
            progress.advance(sim)
        if interrupt.asked is not None:
            sim.book()
            raise interrupt.asked
    sim.book()


def _advance(sim: Simulation, dt: float) -> None:
    """Make a step; whatever stops it says when, and that the step was too long if it was."""
    try:
        # What is no number is found by the checks of each stage; NumPy need not warn of it as well.
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            sim.advance(dt)
    except InputError as error:
        raise RunError(str(error), step=sim.step, time=sim.time) from None
    except RunError as error:
        over = [note for note in sim.notes if note.startswith("time step: ")]
        if not over:
            raise
        raise RunError(
            f"{error.cause}; {over[-1]}",
            step=error.step, time=error.time, particle=error.particle, position=error.position,
        ) from None  # fmt: skip


def _write(sim: Simulation, writers: Sequence[Writer], previous: float) -> None:
    for writer in writers:
        if writer.trigger.due(sim.step, sim.time, previous):
            try:
                writer.write(sim)
            except OSError as error:
                raise _failed(sim, error) from None

"""The loop over steps: triggers, writers, progress, interruption."""

from __future__ import annotations

import math
import signal
import threading
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from functools import partial
from typing import TYPE_CHECKING, Any, Protocol

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


class _Interrupt:
    """Ctrl-C once: remembered until the step is done. Twice: at once."""

    def __init__(self) -> None:
        self.asked = False

    def __call__(self, signum: int, frame: Any) -> None:
        if self.asked:
            raise KeyboardInterrupt
        self.asked = True


@contextmanager
def _interruptible() -> Iterator[_Interrupt]:
    """Hold back Ctrl-C between the ends of steps, so that no file is cut in the middle."""
    interrupt = _Interrupt()
    if threading.current_thread() is not threading.main_thread():
        yield interrupt
        return
    previous = signal.signal(signal.SIGINT, interrupt)
    try:
        yield interrupt
    finally:
        signal.signal(signal.SIGINT, previous)


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
    """Step ``sim`` to the time ``until`` [s]; writers are closed whatever happens."""
    with ExitStack() as stack:
        for writer in writers:
            writer.open(sim)
            stack.push(partial(_close, writer, sim))
        if progress is not None:
            progress.start(sim, until)
            stack.push(partial(_stop, progress))
        with _interruptible() as interrupt:
            _loop(sim, until, writers, progress, interrupt)


def _close(writer: Writer, sim: Simulation, _kind: Any, error: BaseException | None, _trace: Any) -> None:
    writer.close(sim, error)


def _stop(progress: Observer, _kind: Any, error: BaseException | None, _trace: Any) -> None:
    progress.stop(error)


def _loop(
    sim: Simulation,
    until: float,
    writers: Sequence[Writer],
    progress: Observer | None,
    interrupt: _Interrupt,
) -> None:
    previous = -math.inf
    if sim.step == 0:
        _write(sim, writers, previous)
    for dt in _lengths(sim, until):
        previous = sim.time
        sim.advance(dt)
        _write(sim, writers, previous)
        if progress is not None:
            progress.advance(sim)
        if interrupt.asked:
            raise KeyboardInterrupt


def _write(sim: Simulation, writers: Sequence[Writer], previous: float) -> None:
    for writer in writers:
        if writer.trigger.due(sim.step, sim.time, previous):
            writer.write(sim)

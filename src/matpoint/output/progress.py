"""What a run shows while it goes on: a bar on a terminal, lines elsewhere."""

from __future__ import annotations

import sys
import time
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matpoint.simulation import Simulation

_REFRESH = 0.1  # seconds between two updates of the bar
_LINE = 5.0  # seconds between two lines


class Progress:
    """Step, time, dt, particles a second and time left, on standard error.

    Parameters
    ----------
    quiet
        Show nothing.
    """

    def __init__(self, quiet: bool = False) -> None:
        self.quiet = quiet
        self._bar: Any = None
        self._task: Any = None

    def start(self, sim: Simulation, until: float) -> None:
        """Begin."""
        self._until, self._from = until, sim.time
        self._begin = self._last = time.perf_counter()
        self._first, self._said = sim.step, 0
        if self.quiet:
            return
        if sys.stderr.isatty():
            self._open_bar()
        else:
            print(
                f"{sim.interpolation.name}: {len(sim.particles)} particles to t = {until:g} s",
                file=sys.stderr,
            )

    def advance(self, sim: Simulation) -> None:
        """Take note of a step; the clock decides whether anything is shown."""
        if self.quiet:
            return
        now = time.perf_counter()
        if now - self._last < (_REFRESH if self._bar is not None else _LINE):
            return
        self._last = now
        if self._bar is not None:
            self._bar.update(self._task, completed=self._share(sim), info=self._info(sim, now))
        else:
            print(f"  {100 * self._share(sim):5.1f} %  {self._info(sim, now)}", file=sys.stderr, flush=True)

    def stop(self, error: BaseException | None) -> None:
        """End."""
        if self._bar is not None:
            if error is None:
                self._bar.update(self._task, completed=1.0)
            self._bar.stop()
            self._bar = None

    def _share(self, sim: Simulation) -> float:
        return (sim.time - self._from) / (self._until - self._from)

    def _info(self, sim: Simulation, now: float) -> str:
        steps, wall, share = sim.step - self._first, now - self._begin, self._share(sim)
        speed = steps * len(sim.particles) / wall if wall > 0 else 0.0
        left = wall * (1.0 - share) / share if share > 0 else 0.0
        return (
            f"step {sim.step}  t = {sim.time:.4g} s  dt = {sim.dt:.3g} s"
            f"  {speed / 1e6:.3g} M particle-steps/s  {left:.0f} s left"
        )

    def _open_bar(self) -> None:
        from rich.console import Console  # noqa: PLC0415 (slow to import)
        from rich.progress import BarColumn, TaskProgressColumn, TextColumn  # noqa: PLC0415
        from rich.progress import Progress as Bar  # noqa: PLC0415

        self._bar = Bar(
            BarColumn(), TaskProgressColumn(), TextColumn("{task.fields[info]}"), console=Console(stderr=True)
        )
        self._bar.start()
        self._task = self._bar.add_task("run", total=1.0, info="compiling or loading kernels ...")

"""What a writer is."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

from matpoint.output.triggers import Trigger

if TYPE_CHECKING:
    from matpoint.simulation import Simulation


class Writer(Protocol):
    """Something that looks at a run when its trigger says so, and never changes it."""

    @property
    def trigger(self) -> Trigger:
        """When ``write`` is called."""
        ...

    def open(self, sim: Simulation) -> None:
        """Get ready before the first step; raise InputError if that can't be done."""
        ...

    def write(self, sim: Simulation) -> None:
        """Take note of the present state."""
        ...

    def close(self, sim: Simulation, error: BaseException | None) -> None:
        """Finish; called whatever happened, with what ended the run, or None."""
        ...

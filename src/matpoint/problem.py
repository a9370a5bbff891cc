"""A problem: a case with a reference solution, and the norms that measure a method against it."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

from matpoint.errors import InputError, StudyError

if TYPE_CHECKING:
    from matpoint.interpolation import Interpolation
    from matpoint.output.history import Probe
    from matpoint.scheme import Scheme
    from matpoint.simulation import Simulation
    from matpoint.timestep import TimeStep

#: Method -> name of the norm -> value; under "failed", if there, None or where and why a run ended early.
Result = dict[str, dict[str, Any]]
#: Told of every method before it runs: its name, its number from 0, how many there are.
Announce = Callable[[str, int, int], None]


_ROUND_OFF = 1e-8  # of a norm: what is 0 in truth


def shown(value: float) -> str:
    """Return a norm with four digits; round-off is 0."""
    return "0" if abs(value) < _ROUND_OFF else f"{value:.4g}"


def failures(result: Result) -> dict[str, str]:
    """Return the methods whose runs ended early: name -> where and why."""
    return {name: values["failed"] for name, values in result.items() if values.get("failed")}


class Problem(ABC):
    """A verification problem.

    A subclass is a frozen dataclass: its fields are the choices a user has.

    Attributes
    ----------
    name
        As in case files and on the command line.
    title
        One line for lists and figures.
    methods
        Methods that ``verify`` compares; the reference stands last.
    norms
        Name of each norm -> what it measures, in a few words.
    end, step
        End time and time step [s].
    files
        Names, or patterns of names, of what ``verify`` writes into its folder.
    """

    name: ClassVar[str]
    title: ClassVar[str]
    methods: ClassVar[tuple[str, ...]]
    norms: ClassVar[dict[str, str]]
    end: ClassVar[float]
    step: ClassVar[float]
    files: ClassVar[tuple[str, ...]] = ("figure-*.png", "histories.csv")

    @property
    @abstractmethod
    def probes(self) -> tuple[Probe, ...]:
        """The particles that the problem watches."""

    @abstractmethod
    def simulation(
        self,
        interpolation: Interpolation,
        *,
        scheme: Scheme | None = None,
        timestep: TimeStep | None = None,
        threads: int | None = None,
    ) -> Simulation:
        """Return the problem's simulation, ready to run.

        Parameters
        ----------
        interpolation
            The method.
        scheme, timestep
            None takes the problem's own.
        threads
            None takes all processors.

        Raises
        ------
        InputError
            If the choices can't work together.
        """

    @abstractmethod
    def verify(
        self,
        methods: Sequence[str] | None = None,
        out: Path | None = None,
        progress: Announce | None = None,
    ) -> Result:
        """Run methods and the reference, and measure the one against the other.

        Parameters
        ----------
        methods
            Names out of ``self.methods``; None takes all.
        out
            A folder that exists, for figures and histories; None draws nothing.
        progress
            Told of every method before it runs.

        Raises
        ------
        InputError
            If a method is not one of the problem's.
        """

    def chosen(self, methods: Sequence[str] | None) -> tuple[str, ...]:
        """Return the names to run, once each.

        Raises
        ------
        InputError
            If there are none, or one is not among ``self.methods``.
        """
        names = self.methods if methods is None else tuple(dict.fromkeys(methods))
        for name in names:
            if name not in self.methods:
                raise InputError(f"{self.name}: method {name!r}; {', '.join(self.methods)} are allowed")
        if not names:
            raise InputError(f"{self.name}: no method given; {', '.join(self.methods)} are allowed")
        return names

    def refuse_methods(self, methods: Sequence[str]) -> None:  # noqa: B027 (most take all that they name)
        """Refuse methods that can't run on the problem as it stands, before anything is run or written.

        Parameters
        ----------
        methods
            Names, as :meth:`chosen` returns them.

        Raises
        ------
        InputError
            With the method, and what would do instead.
        """

    def refuse_failure(self, result: Result) -> None:
        """Raise StudyError if none of the runs of :meth:`verify` reached its end."""
        reasons = failures(result)
        if result and len(reasons) == len(result):
            method, why = next(iter(reasons.items()))
            raise StudyError(f"none of {len(result)} runs reached its end; {method} failed: {why}")

    def table(self, result: Result) -> str:
        """Return the norms as aligned text, one line per method."""
        width = max(len("method"), *(len(name) for name in result))
        columns = {norm: max(10, len(norm) + 2) for norm in self.norms}
        lines = ["method".ljust(width) + "".join(norm.rjust(w) for norm, w in columns.items())]
        lines.append("-" * len(lines[0]))
        for method, values in result.items():
            numbers = "".join(f"{shown(values[norm]):>{w}}" for norm, w in columns.items())
            lines.append(method.ljust(width) + numbers)
        lines.append("")
        lines += [f"{norm.ljust(width)}  {meaning}" for norm, meaning in self.norms.items()]
        return "\n".join(lines)

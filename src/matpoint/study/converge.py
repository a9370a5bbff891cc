"""A convergence study: every method at every size."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from matpoint.checks import whole
from matpoint.errors import StudyError
from matpoint.problems import ManufacturedProblem
from matpoint.study.orders import orders, tables
from matpoint.study.plan import Methods, Plan, plan
from matpoint.study.pool import answers
from matpoint.study.store import keep, key, recall
from matpoint.study.worker import entry
from matpoint.threads import available_threads
from matpoint.transfers import Transfer

#: Told of every run that is done: a line of text.
Announce = Callable[[str], None]


@dataclass(frozen=True, eq=False)
class Study:
    """What a study found.

    Attributes
    ----------
    plan
        What was run: problem, methods with their options, cells, transfer.
    entries
        Method, or its label -> an entry for each size, in order of cells: ``cells``, the norms (None where a
        run did not get so far), ``particle_steps``, ``wall_s`` [s], ``failed`` (None, or where and why it
        ended).
    """

    plan: Plan
    entries: dict[str, list[dict[str, Any]]]

    @property
    def problem(self) -> ManufacturedProblem:
        """The problem, at its own size."""
        return self.plan.problem

    @property
    def finished(self) -> int:
        """How many runs reached their end."""
        return sum(e["failed"] is None for entries in self.entries.values() for e in entries)

    def refuse_failure(self) -> None:
        """Raise StudyError if no run reached its end."""
        if not self.finished:
            failed = [(label, e) for label, entries in self.entries.items() for e in entries]
            label, first = failed[0]
            raise StudyError(
                f"none of {len(failed)} runs reached its end; {label} with {first['cells']} cells failed:"
                f" {first['failed']}"
            )

    def json(self) -> dict[str, Any]:
        """Return method -> entries, and under ``order`` method -> fitted slopes."""
        return {**self.entries, "order": orders(self.entries)}

    def tables(self) -> str:
        """Return what was run, and the errors with orders between neighbours, as aligned text."""
        return f"{self.plan.heading()}\n\n{tables(self.entries)}"


def converge(
    problem: ManufacturedProblem,
    methods: Methods | None = None,
    cells: Sequence[int] | None = None,
    *,
    transfer: Transfer | None = None,
    fresh: bool = False,
    processes: int | None = None,
    announce: Announce | None = None,
) -> Study:
    """Run methods at several sizes, in parallel processes; what was run before is taken from the store.

    Parameters
    ----------
    problem
        Its settings but for ``cells`` are kept; its ``scheme`` is the order of stages.
    methods
        Names, or label -> interpolation to compare variants; None takes the problem's.
    cells
        Sizes; None takes the problem's.
    transfer
        How velocities come back to the particles, in all runs; None takes FLIP().
    fresh
        Run again what is in the store.
    processes
        How many side by side; None takes all processors.
    announce
        Told of every run.

    Raises
    ------
    InputError
        If a method or a size does not exist, a method can't go with the transfer or the order of stages, or
        a run would be too large.
    """
    return carry_out(plan(problem, methods, cells, transfer), fresh, processes, announce)


def carry_out(
    planned: Plan, fresh: bool = False, processes: int | None = None, announce: Announce | None = None
) -> Study:
    """Run what :func:`plan` has checked; the parameters are those of :func:`converge`."""
    count = whole("converge: processes", available_threads() if processes is None else processes)
    given = planned.tasks
    runs = list(given)
    keys = [key(task) for task in given.values()]
    done: dict[tuple[str, int], dict[str, Any]] = {}

    def take(run: tuple[str, int], result: dict[str, Any], how: str = "") -> None:
        done[run] = result
        if announce is not None:
            announce(f"[{len(done)}/{len(runs)}] {run[0]} {run[1]} cells: {_told(result)}{how}")

    open_ = []
    for number, run in enumerate(runs):
        kept = None if fresh else recall(keys[number])
        if kept is None:
            open_.append(number)
        else:
            take(run, kept, " (kept)")
    for place, answer in answers([given[runs[n]] for n in open_], count):
        number = open_[place]
        if isinstance(answer, str):  # nothing is known of why, so nothing is kept
            take(runs[number], entry(runs[number][1], failed=f"step unknown: {answer}"))
            continue
        if "MemoryError" not in (answer["failed"] or ""):  # tomorrow there may be more
            keep(keys[number], answer)
        take(runs[number], answer)
    entries = {label: [done[label, n] for n in planned.cells] for label in planned.methods}
    return Study(planned, entries)


def _told(result: dict[str, Any]) -> str:
    if result["failed"]:
        return f"failed, {result['failed']}"
    return f"velocity {result['velocity']:.3g} m/s, {result['wall_s']:.2f} s"

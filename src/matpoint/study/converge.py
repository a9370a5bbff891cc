"""A convergence study: every method at every size."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

from matpoint.checks import whole
from matpoint.errors import InputError
from matpoint.problems import ManufacturedProblem
from matpoint.study.orders import orders, tables
from matpoint.study.pool import answers
from matpoint.study.store import keep, key, recall
from matpoint.study.worker import entry, task
from matpoint.threads import available_threads

#: Told of every run that is done: a line of text.
Announce = Callable[[str], None]


@dataclass(frozen=True, eq=False)
class Study:
    """What a study found.

    Attributes
    ----------
    problem
        The problem, at its own size.
    entries
        Method -> an entry for each size, in order of cells: ``cells``, the norms (None where a run did not
        get so far), ``particle_steps``, ``wall_s`` [s], ``failed`` (None, or where and why it ended).
    """

    problem: ManufacturedProblem
    entries: dict[str, list[dict[str, Any]]]

    def json(self) -> dict[str, Any]:
        """Return method -> entries, and under ``order`` method -> fitted slopes."""
        return {**self.entries, "order": orders(self.entries)}

    def tables(self) -> str:
        """Return the errors, with orders between neighbours, as aligned text."""
        return tables(self.entries)


def converge(
    problem: ManufacturedProblem,
    methods: Sequence[str] | None = None,
    cells: Sequence[int] | None = None,
    *,
    fresh: bool = False,
    processes: int | None = None,
    announce: Announce | None = None,
) -> Study:
    """Run methods at several sizes, in parallel processes; what was run before is taken from the store.

    Parameters
    ----------
    problem
        Its settings but for ``cells`` are kept.
    methods
        Names; None takes the problem's.
    cells
        Sizes; None takes the problem's.
    fresh
        Run again what is in the store.
    processes
        How many side by side; None takes all processors.
    announce
        Told of every run.

    Raises
    ------
    InputError
        If a method or a size does not exist.
    """
    names = problem.chosen(methods)
    sizes = sorted({whole("converge: cells", n, 2) for n in (problem.sizes if cells is None else cells)})
    if not sizes:
        raise InputError("converge: no cells given, for instance --cells 8,16,32")
    count = whole("converge: processes", available_threads() if processes is None else processes)
    # The finest grids take longest: they go first, so that no processor is left alone with one.
    runs = [(name, n) for n in reversed(sizes) for name in names]
    given = [task(replace(problem, cells=n), name) for name, n in runs]
    keys = [key(g) for g in given]
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
    for place, answer in answers([given[n] for n in open_], count):
        number = open_[place]
        if isinstance(answer, str):  # nothing is known of why, so nothing is kept
            take(runs[number], entry(runs[number][1], failed=f"step unknown: {answer}"))
            continue
        keep(keys[number], answer)
        take(runs[number], answer)
    return Study(problem, {name: [done[name, n] for n in sizes] for name in names})


def _told(result: dict[str, Any]) -> str:
    if result["failed"]:
        return f"failed, {result['failed']}"
    return f"velocity {result['velocity']:.3g} m/s, {result['wall_s']:.2f} s"

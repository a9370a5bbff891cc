"""One run of a study, and the loop of a worker process: a task in JSON a line, an answer in JSON a line."""

from __future__ import annotations

import dataclasses
import json
import os
import sys
import threading
import time
import warnings
from typing import TYPE_CHECKING, Any

from matpoint.errors import InputError
from matpoint.problems import PROBLEMS, ManufacturedProblem
from matpoint.problems.errors_track import NORMS
from matpoint.problems.sampler import Sampler
from matpoint.study.choices import packed, unpacked

if TYPE_CHECKING:
    from matpoint.interpolation import Interpolation
    from matpoint.transfers import Transfer

_warm: set[tuple[str, str]] = set()


def run_choice(
    problem: ManufacturedProblem,
    interpolation: Interpolation,
    label: str,
    transfer: Transfer | None = None,
) -> dict[str, Any]:
    """Run an interpolation on a problem, on one thread; return its entry of the study.

    Compiled code is loaded by two steps of another run first, so that ``wall_s`` is time of the run.

    Parameters
    ----------
    problem, interpolation
        What is run.
    label
        A name of its own for these options and the transfer.
    transfer
        How velocities come back; None takes FLIP().
    """
    try:
        if (problem.name, label) not in _warm:
            scheme = problem.scheme_for(interpolation, transfer)
            first = problem.simulation(interpolation, scheme=scheme, threads=1)
            first.run(2 * first.dt, writers=[Sampler(1, problem.errors)])
            _warm.add((problem.name, label))
        track = problem.track(interpolation, threads=1, transfer=transfer)
    except InputError as error:
        return entry(problem.cells, failed=f"step 0: {error}")
    except (ArithmeticError, ValueError, MemoryError) as error:
        return entry(problem.cells, failed=f"step 0: {type(error).__name__}: {error}")
    return entry(problem.cells, problem.measure(track), track.particle_steps, track.wall, track.failed)


def entry(
    cells: int,
    norms: dict[str, float] | None = None,
    particle_steps: int = 0,
    wall: float = 0.0,
    failed: str | None = None,
) -> dict[str, Any]:
    """Return the entry of a run; norms that it did not reach are None."""
    known = norms or {}
    rows = {name: known.get(name) for name in NORMS}
    finite = {k: v if v is not None and abs(v) < float("inf") else None for k, v in rows.items()}
    return {
        "cells": cells, **finite, "particle_steps": particle_steps, "wall_s": round(wall, 4),
        "failed": failed,
    }  # fmt: skip


def task(problem: ManufacturedProblem, interpolation: Interpolation, transfer: Transfer) -> dict[str, Any]:
    """Return what a worker needs to know; a run depends on it and on the sources alone."""
    return {
        "problem": problem.name, "settings": dataclasses.asdict(problem),
        "interpolation": packed(interpolation), "transfer": packed(transfer),
    }  # fmt: skip


def leave_with(parent: int) -> None:
    """End this process once that of the study, which may have been killed in the middle of a run, is gone."""
    while os.getppid() == parent:
        time.sleep(1.0)
    os._exit(1)


def main() -> None:
    """Answer tasks from the standard input until it closes."""
    threading.Thread(target=leave_with, args=(os.getppid(),), daemon=True).start()
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)  # nothing else may come between the answers
    warnings.simplefilter("ignore")
    for line in sys.stdin:
        given = json.loads(line)
        problem: Any = PROBLEMS[given["problem"]]
        choice, transfer = unpacked(given["interpolation"]), unpacked(given["transfer"])
        label = json.dumps([given["interpolation"], given["transfer"]])
        found = run_choice(problem(**given["settings"]), choice, label, transfer)
        answers.write(json.dumps(found) + "\n")
        answers.flush()

"""From the output tables of a case to its writers."""

from __future__ import annotations

from fnmatch import fnmatchcase
from pathlib import Path
from typing import TYPE_CHECKING, Any

from matpoint.case.describe import choose
from matpoint.case.load import Case
from matpoint.case.schema import FigureTable, HistoryTable, TriggerTable
from matpoint.errors import InputError, naming
from matpoint.output import (
    VTKHDF,
    AtTimes,
    Checkpoint,
    EverySteps,
    EveryTime,
    History,
    HistoryFigure,
    ParticleFigure,
    Probe,
    Summary,
    Trigger,
    inside,
)
from matpoint.output.figures import COLOURS
from matpoint.output.history import FIELDS
from matpoint.quantities import QUANTITIES

if TYPE_CHECKING:
    from matpoint.output import Writer
    from matpoint.simulation import Simulation


def make_trigger(table: TriggerTable, where: str) -> Trigger | None:
    """Return the trigger of a table, or None if it gives none.

    Raises
    ------
    InputError
        If it gives more than one.
    """
    given = {
        k: getattr(table, k) for k in ("every_steps", "every_time", "at") if getattr(table, k) is not None
    }
    if len(given) > 1:
        raise InputError(f"{where}: give one of every_steps, every_time, at; {', '.join(given)} are given")
    if not given:
        return None
    (kind, value), *_ = given.items()
    makers: dict[str, Any] = {"every_steps": EverySteps, "every_time": EveryTime, "at": AtTimes}
    with naming(f"{where}.{kind}"):
        return makers[kind](value)


def _needed(table: TriggerTable, where: str) -> Trigger:
    trigger = make_trigger(table, where)
    if trigger is None:
        raise InputError(f"{where}: give one of every_steps, every_time, at")
    return trigger


def build_writers(case: Case, folder: Path, simulation: Simulation | None = None) -> list[Writer]:
    """Return the writers of a case; nothing is created on disk yet.

    Parameters
    ----------
    case
        The case.
    folder
        Where their files will be.
    simulation
        Its simulation, in which probes must find their particles; None leaves that for later.

    Raises
    ------
    InputError
        If a table can't work, or a name leads out of the folder.
    """
    output = case.tables.output
    writers: list[Any] = []
    if output.vtk is not None:
        writers.append(VTKHDF(folder / "results.vtkhdf", _needed(output.vtk, "output.vtk")))
    if output.history is not None:
        history = _history(output.history, folder, simulation)
        writers.append(history)
        if output.history.figure:
            writers.append(HistoryFigure(folder / "history.png", history))
    figures = [_figure(table, number, folder) for number, table in enumerate(output.figures)]
    _refuse_doubles(figures)
    writers += figures
    if output.checkpoint is not None:
        writers.append(Checkpoint(folder / "checkpoint.h5", _needed(output.checkpoint, "output.checkpoint")))
    return [*writers, Summary(folder / "summary.json", {"name": case.name, "title": case.tables.title})]


def planned(writers: list[Writer]) -> list[str]:
    """Return names, or patterns of names, of the files that writers will write."""
    return [name for writer in writers for name in getattr(writer, "files", ())]


def _history(table: HistoryTable, folder: Path, simulation: Simulation | None) -> History:
    where = "output.history"
    for number, name in enumerate(table.quantities):
        choose(name, QUANTITIES, f"{where}.quantities.{number}")
    probes = []
    for number, given in enumerate(table.probes):
        place = f"{where}.probes.{number}"
        choose(given.field, FIELDS, f"{place}.field")
        choose(given.component, FIELDS[given.field][1], f"{place}.component")
        with naming(f"{place}.at"):
            probe = Probe(given.name, tuple(given.at), given.field, given.component)
            if simulation is not None:
                probe.find(simulation)
        probes.append(probe)
    trigger = _needed(table, where)
    with naming(where):
        return History(folder / "history.csv", trigger, table.quantities, probes)


def _figure(table: FigureTable, number: int, folder: Path) -> ParticleFigure:
    where = f"output.figures.{number}"
    choose(table.colour, COLOURS, f"{where}.colour")
    trigger = make_trigger(table, where)
    with naming(f"{where}.name"):
        inside(folder, f"{table.name}.png")
        return ParticleFigure(folder, table.name, table.colour, trigger)


def _refuse_doubles(figures: list[ParticleFigure]) -> None:
    """Refuse figures that would write to one file."""
    for number, figure in enumerate(figures):
        if figure.stem == "history" or any(_clash(figure, other) for other in figures[:number]):
            raise InputError(
                f"output.figures.{number}.name = {figure.stem!r} is taken; give each figure a name of its own"
            )


def _clash(a: ParticleFigure, b: ParticleFigure) -> bool:
    pairs = ((a, b), (b, a))
    return a.stem == b.stem or any(fnmatchcase(f"{x.stem}.png", y.files[0]) for x, y in pairs)

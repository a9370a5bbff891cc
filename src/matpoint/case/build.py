"""From a case to a simulation and its writers: the one place where strings become objects."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from matpoint.body import Body
from matpoint.case.files import MeshFiles
from matpoint.case.load import Case
from matpoint.case.memory import check_memory
from matpoint.case.objects import (
    make_condition,
    make_damping,
    make_interpolation,
    make_load,
    make_material,
    make_mesh,
    make_region,
    make_scheme,
    make_timestep,
    make_velocity,
)
from matpoint.case.schema import BodyTable, CaseTable, ProblemTable, TriggerTable
from matpoint.case.shapes import FileMesh
from matpoint.domains import Domains
from matpoint.errors import InputError, did_you_mean
from matpoint.grid import Grid
from matpoint.materials import Material
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
from matpoint.problems import PROBLEMS
from matpoint.regions import Region
from matpoint.simulation import Simulation

if TYPE_CHECKING:
    from matpoint.output import Writer
    from matpoint.problem import Problem

_MOST_STEPS = 1e12


def make_problem(table: ProblemTable) -> Problem:
    """Return the problem of a table.

    Raises
    ------
    InputError
        If its name or one of its parameters does not exist.
    """
    if table.name not in PROBLEMS:
        hint = did_you_mean(table.name, PROBLEMS)
        raise InputError(f"problem.name = {table.name!r}{hint}; there are {', '.join(PROBLEMS)}")
    kind: Any = PROBLEMS[table.name]
    allowed = [f.name for f in dataclasses.fields(kind)]
    parameters = dict(table.model_extra or {})
    for key in parameters:
        if key not in allowed:
            shown = key if key.isprintable() else repr(key)
            raise InputError(
                f"problem.{shown}: unknown key{did_you_mean(key, allowed)}; allowed are {', '.join(allowed)}"
            )
    return kind(**parameters)


def _problem_only(tables: CaseTable) -> None:
    for key in ("grid", "materials", "bodies", "boundaries", "loads", "damping"):
        if getattr(tables, key):
            raise InputError(f"{key}: the problem gives it; leave it out, or leave the problem out")


def _check_end(tables: CaseTable) -> None:
    end, step = tables.time.end, tables.time.step
    if end <= 0:
        raise InputError(f"time.end = {end:g} must lie after the start, 0 s")
    if step is not None and step > 0 and end > _MOST_STEPS * step:
        raise InputError(
            f"time.end = {end:g} s in steps of {step:g} s makes more than {_MOST_STEPS:g} steps; too many"
        )


def build_simulation(case: Case, threads: int | None = None) -> Simulation:
    """Return the simulation of a case.

    Parameters
    ----------
    case
        What :func:`matpoint.case.load` returned.
    threads
        How many; None takes all processors.

    Raises
    ------
    InputError
        If anything in the case can't work.
    """
    tables = case.tables
    _check_end(tables)
    interpolation, scheme = make_interpolation(tables.interpolation), make_scheme(tables.scheme)
    timestep = make_timestep(tables.time)
    if tables.problem is not None:
        _problem_only(tables)
        problem = make_problem(tables.problem)
        return problem.simulation(interpolation, scheme=scheme, timestep=timestep, threads=threads)
    if tables.grid is None:
        raise InputError("grid: this table is missing (lower, upper, cell)")
    grid = Grid(tables.grid.lower, tables.grid.upper, tables.grid.cell)
    materials = {name: make_material(name, table) for name, table in tables.materials.items()}
    bodies = _bodies(tables.bodies, materials, grid.dim, MeshFiles(case.folder))
    check_memory(grid, bodies)
    return Simulation(
        grid,
        bodies,
        interpolation=interpolation,
        scheme=scheme,
        timestep=timestep,
        boundaries=[make_condition(t, number, grid.dim) for number, t in enumerate(tables.boundaries)],
        loads=[make_load(t, number, grid.dim) for number, t in enumerate(tables.loads)],
        damping=make_damping(tables.damping),
        threads=threads,
    )


def _bodies(
    tables: Sequence[BodyTable], materials: dict[str, Material], dim: int, files: MeshFiles
) -> list[Body]:
    """The bodies of all tables; a group of a mesh file makes one for each shape of cell in it."""
    bodies = []
    for number, table in enumerate(tables):
        where = f"bodies.{number}"
        if table.material not in materials:
            hint = did_you_mean(table.material, materials)
            known = ", ".join(materials) or "none; add a table [materials.NAME]"
            raise InputError(f"{where}.material = {table.material!r}{hint}; there are {known}")
        name = table.name or (table.mesh.group if isinstance(table.mesh, FileMesh) else f"{number}")
        per_cell = tuple(table.per_cell) if isinstance(table.per_cell, list) else table.per_cell
        velocity = make_velocity(table, number, dim)
        bodies += [
            Body(geometry, materials[table.material], per_cell, velocity, name)
            for geometry in _geometries(table, where, files)
        ]
    files.check_use()
    return bodies


def _geometries(table: BodyTable, where: str, files: MeshFiles) -> Sequence[Region | Domains]:
    if (table.region is None) == (table.mesh is None):
        raise InputError(f"{where}: give either region or mesh")
    try:
        if isinstance(table.mesh, FileMesh):
            return files.domains(table.mesh)
        return [make_region(table.region) if table.mesh is None else make_mesh(table.mesh)]
    except InputError as error:
        raise InputError(f"{where}: {error}") from None


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
    try:
        return makers[kind](value)
    except InputError as error:
        raise InputError(f"{where}: {error}") from None


def _needed(table: TriggerTable, where: str) -> Trigger:
    trigger = make_trigger(table, where)
    if trigger is None:
        raise InputError(f"{where}: give one of every_steps, every_time, at")
    return trigger


def build_writers(case: Case, folder: Path) -> list[Writer]:
    """Return the writers of a case; nothing is created on disk yet.

    Parameters
    ----------
    case
        The case.
    folder
        Where their files will be.

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
        table = output.history
        probes = [Probe(p.name, tuple(p.at), p.field, p.component) for p in table.probes]
        trigger = _needed(table, "output.history")
        history = History(folder / "history.csv", trigger, table.quantities, probes)
        writers.append(history)
        if table.figure:
            writers.append(HistoryFigure(folder / "history.png", history))
    for number, table in enumerate(output.figures):
        inside(folder, f"{table.name}.png")
        trigger = make_trigger(table, f"output.figures.{number}")
        writers.append(ParticleFigure(folder, table.name, table.colour, trigger))
    names = [table.name for table in output.figures]
    _refuse_doubles(names)
    if output.checkpoint is not None:
        writers.append(Checkpoint(folder / "checkpoint.h5", _needed(output.checkpoint, "output.checkpoint")))
    return [*writers, Summary(folder / "summary.json", {"name": case.name, "title": case.tables.title})]


def _refuse_doubles(names: Sequence[str]) -> None:
    for name in names:
        if names.count(name) > 1 or name == "history":
            raise InputError(
                f"output.figures: the name {name!r} is taken; give each figure a name of its own"
            )

"""From a case to a simulation."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from matpoint.body import Body
from matpoint.case.conditions import make_condition
from matpoint.case.files import MeshFiles
from matpoint.case.load import Case
from matpoint.case.loads import make_damping, make_load
from matpoint.case.memory import forecast_run
from matpoint.case.objects import (
    make_interpolation,
    make_material,
    make_mesh,
    make_region,
    make_scheme,
    make_timestep,
    make_velocity,
)
from matpoint.case.schema import BodyTable, CaseTable, ProblemTable
from matpoint.case.shapes import CombinedRegion, FileMesh
from matpoint.domains import Domains
from matpoint.errors import InputError, RunError, did_you_mean, naming
from matpoint.grid import Grid
from matpoint.interpolation.contract import Interpolation
from matpoint.materials import Material
from matpoint.problems import PROBLEMS, ManufacturedProblem
from matpoint.regions import Region
from matpoint.scheme import Scheme
from matpoint.simulation import Simulation

if TYPE_CHECKING:
    from matpoint.footprint import Forecast
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


def _check_end(end: float, step: float, about: str = "") -> None:
    """Refuse a run that would never end."""
    if end <= 0:
        raise InputError(f"time.end = {end:g} must lie after the start, 0 s")
    if 0 < step < end / _MOST_STEPS:
        raise InputError(
            f"time.end = {end:g} s in steps of {about}{step:g} s makes over {_MOST_STEPS:g} steps; too many"
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
    times = case.tables.time
    _check_end(times.end, times.step or 0.0)
    simulation = _simulation(case, threads)
    _check_end(times.end, simulation.dt, "about ")
    simulation.sample_every = times.sample_every or simulation.sample_every
    simulation.sort_every = times.sort_every or simulation.sort_every
    return simulation


def build_forecast(case: Case) -> Forecast:
    """Return the memory that a run of a case needs; nothing large is made, but for problems.

    Raises
    ------
    InputError
        As :func:`build_simulation`, as far as the grid and the bodies go.
    """
    tables = case.tables
    interpolation = make_interpolation(tables.interpolation)
    scheme = make_scheme(tables.scheme, interpolation)
    if tables.problem is not None:
        sim = build_simulation(case, threads=1)
        return forecast_run(case, sim.grid, sim.bodies, interpolation, scheme)
    return forecast_run(case, *_grid_and_bodies(case), interpolation, scheme)


def _grid_and_bodies(case: Case) -> tuple[Grid, list[Body]]:
    tables = case.tables
    if tables.grid is None:
        raise InputError("grid: this table is missing (lower, upper, cell)")
    with naming("grid"):
        grid = Grid(tables.grid.lower, tables.grid.upper, tables.grid.cell)
    materials = {name: make_material(name, table) for name, table in tables.materials.items()}
    return grid, _bodies(tables.bodies, materials, grid.dim, MeshFiles(case.folder))


def _check_memory(
    case: Case, grid: Grid, bodies: Sequence[Body], interpolation: Interpolation, scheme: Scheme
) -> None:
    """Refuse a run that needs more memory than is free."""
    try:
        need = forecast_run(case, grid, bodies, interpolation, scheme)
    except (InputError, RunError):
        return  # something else is wrong, and said where it matters
    need.check()


def _simulation(case: Case, threads: int | None) -> Simulation:
    tables = case.tables
    interpolation = make_interpolation(tables.interpolation)
    scheme = make_scheme(tables.scheme, interpolation)
    timestep = make_timestep(tables.time)
    if tables.problem is not None:
        _problem_only(tables)
        problem = make_problem(tables.problem)
        if isinstance(problem, ManufacturedProblem):
            from matpoint.study.plan import refuse_problem_size  # noqa: PLC0415 (for these alone)

            refuse_problem_size(problem)
            # What the problem is told of its own counts, and so does its own choice of an order of stages.
            scheme = scheme if tables.scheme.order else problem.scheme_for(interpolation, scheme.transfer)
            timestep = None if problem.dt else timestep
        return problem.simulation(interpolation, scheme=scheme, timestep=timestep, threads=threads)
    grid, bodies = _grid_and_bodies(case)
    walls_only = interpolation.walls_only
    conditions = [make_condition(t, k, grid, walls_only) for k, t in enumerate(tables.boundaries)]
    loads = [make_load(t, number, grid.dim) for number, t in enumerate(tables.loads)]
    _check_memory(case, grid, bodies, interpolation, scheme)
    try:
        return Simulation(
            grid, bodies, interpolation=interpolation, scheme=scheme, timestep=timestep,
            boundaries=conditions, loads=loads, damping=make_damping(tables.damping), threads=threads,
        )  # fmt: skip
    except InputError as error:
        raise InputError(_in_case(str(error))) from None


def _in_case(text: str) -> str:
    """Say where in the case it is, if a simulation says it in its own words."""
    text = re.sub(r"^boundary (\d+) \(", r"boundaries.\1 (", text)
    text = re.sub(r"^load (\d+) \(", r"loads.\1 (", text)
    return f"time.step: {text}" if text.startswith("time step: dt") else text


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
        _refuse_axes(f"{where}.region", table.region, dim)
        with naming(where):
            bodies += [
                Body(geometry, materials[table.material], per_cell, velocity, name)
                for geometry in _geometries(table, where, files)
            ]
    files.check_use()
    return bodies


def _refuse_axes(where: str, region: Any, dim: int) -> None:
    """Refuse a region whose centre or plane lies beside the axes of the grid, where no particle would be."""
    if isinstance(region, CombinedRegion):
        for number, part in enumerate(region.of):
            _refuse_axes(f"{where}.of.{number}", part, dim)
        return
    for key in ("centre", "point", "normal"):
        given = getattr(region, key, None)
        if given is not None and len(given) > dim and any(given[dim:]):
            raise InputError(f"{where}.{key}: {len(given)} components given; the grid has {dim} axes")


def _geometries(table: BodyTable, where: str, files: MeshFiles) -> Sequence[Region | Domains]:
    if (table.region is None) == (table.mesh is None):
        raise InputError(f"{where}: give either region or mesh")
    try:
        if isinstance(table.mesh, FileMesh):
            return files.domains(table.mesh)
        return [make_region(table.region) if table.mesh is None else make_mesh(table.mesh)]
    except InputError as error:
        raise InputError(f"{where}: {error}") from None

"""Tables of boundary conditions to conditions."""

from __future__ import annotations

from typing import Any

import numpy as np

from matpoint.boundary import Condition, Fixed, PrescribedVelocity, Roller, Symmetry
from matpoint.case.objects import make_region
from matpoint.case.schema import BoundaryTable, PlaneTable, SurfaceTable
from matpoint.errors import InputError, naming
from matpoint.expressions import Expression
from matpoint.grid import Grid
from matpoint.places import Corners, Plane, Surface


def make_condition(table: BoundaryTable, number: int, grid: Grid, walls_only: bool = False) -> Condition:
    """Return the boundary condition of a table, on a grid whose inner planes ``walls_only`` forbids."""
    where = f"boundaries.{number}"
    given = [name for name in ("plane", "region", "surface", "corners") if getattr(table, name) is not None]
    if len(given) != 1:
        raise InputError(f"{where}: give one of plane, region, surface, corners; given are {given or 'none'}")
    if table.velocity is not None and table.kind != "velocity":
        raise InputError(f"{where}.velocity: only kind = 'velocity' has one")
    if table.normal is not None and table.kind != "roller":
        raise InputError(f"{where}.normal: only kind = 'roller' has one")
    place: Any
    if table.plane is not None:
        place = _plane(table.plane, f"{where}.plane", grid, walls_only)
    else:
        with naming(f"{where}.{given[0]}"):
            place = _place(table)
    with naming(where):
        condition = _condition(table, where, place)
    with naming(f"{where}.{'velocity' if table.velocity is not None else 'normal'}"):
        condition.components(grid.dim)
    return condition


def _place(table: BoundaryTable) -> Any:
    if table.surface is not None:
        return make_surface(table.surface)
    if table.corners is not None:
        return Corners(make_region(table.corners))
    return make_region(table.region)


def make_surface(table: str | SurfaceTable) -> Surface:
    """Return the boundary set of a name, or of a table with a body."""
    return Surface(table) if isinstance(table, str) else Surface(table.name, table.body)


def _plane(table: PlaneTable, where: str, grid: Grid, walls_only: bool) -> Plane:
    if "xyz".index(table.axis) >= grid.dim:
        allowed = ", ".join("xyz"[: grid.dim])
        raise InputError(
            f"{where}.axis = {table.axis!r}: this axis does not exist in {grid.dim}-D; allowed are {allowed}"
        )
    plane = Plane(table.axis, table.at, table.side)
    with naming(f"{where}.at"):
        plane.check(grid, walls_only)
    return plane


def _condition(table: BoundaryTable, where: str, place: Any) -> Condition:
    if table.kind == "fixed":
        return Fixed(place)
    if table.kind == "roller":
        return Roller(place, None if table.normal is None else tuple(table.normal))
    if table.kind == "symmetry":
        if not isinstance(place, Plane):
            raise InputError(f"{where}: symmetry needs a plane")
        return Symmetry(place)
    if table.velocity is None:
        raise InputError(f"{where}: kind = 'velocity' needs velocity = [...], one entry per axis")
    parts = [_component(v, f"{where}.velocity[{k}]") for k, v in enumerate(table.velocity)]
    return PrescribedVelocity(place, tuple(parts))


def _component(value: float | str, where: str) -> Any:
    if not isinstance(value, str):
        return float(value)
    if value == "free":
        return None
    formula = Expression(value, ("x", "y", "z", "t"), where)
    return lambda x, t: np.broadcast_to(formula(x=x[:, 0], y=x[:, 1], z=x[:, 2], t=t), (len(x),))

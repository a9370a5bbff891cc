"""Strings and tables to matpoint's objects: regions, meshes, materials, conditions, loads."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np

from matpoint.case.schema import (
    BodyTable,
    InterpolationTable,
    MaterialTable,
    SchemeTable,
    TimeTable,
)
from matpoint.case.shapes import (
    AnnulusMesh,
    AnnulusRegion,
    ArrayMesh,
    BallRegion,
    BoxMesh,
    BoxRegion,
    CombinedRegion,
    ExtrusionMesh,
    HalfSpaceRegion,
    PolygonRegion,
)
from matpoint.domains import Domains, Kind
from matpoint.errors import InputError, did_you_mean, naming
from matpoint.expressions import vector_field
from matpoint.interpolation import METHODS, BSpline, Interpolation, Linear
from matpoint.materials import MATERIALS, Material, material_from
from matpoint.meshes import domains_from_arrays, extrude, mesh_annulus, mesh_box
from matpoint.regions import Annulus, Ball, Box, HalfSpace, Polygon, Region
from matpoint.scheme import SCHEMES, Scheme
from matpoint.timestep import CFL, FixedStep, TimeStep
from matpoint.transfers import FLIP, FMPM, TRANSFERS, XPIC, Transfer


def make_region(table: Any) -> Region:
    """Return the region of a table."""
    match table:
        case BoxRegion():
            return Box(tuple(table.lower), tuple(table.upper))
        case BallRegion():
            return Ball(tuple(table.centre), table.radius)
        case AnnulusRegion():
            angles = None if table.angles is None else (table.angles[0], table.angles[1])
            return Annulus(table.inner, table.outer, angles, tuple(table.centre))
        case PolygonRegion():
            return Polygon(tuple((p[0], p[1]) for p in table.points))
        case HalfSpaceRegion():
            return HalfSpace(tuple(table.point), tuple(table.normal))
        case CombinedRegion():
            first, *others = (make_region(part) for part in table.of)
            for other in others:
                if table.shape == "union":
                    first = first | other
                elif table.shape == "intersection":
                    first = first & other
                else:
                    first = first - other
            return first
    raise InputError(f"region: {table!r} is not a region")


def make_mesh(table: BoxMesh | AnnulusMesh | ArrayMesh | ExtrusionMesh) -> Domains:
    """Return the domains of a mesh table."""
    if isinstance(table, ExtrusionMesh):
        return extrude(make_mesh(table.base), table.heights)
    if isinstance(table, BoxMesh):
        return mesh_box(table.lower, table.upper, table.divisions)
    if isinstance(table, AnnulusMesh):
        angles, centre = (table.angles[0], table.angles[1]), (table.centre[0], table.centre[1])
        return mesh_annulus(table.inner, table.outer, table.divisions, angles, centre)
    widths = {len(row) for row in table.cells} | {0}
    if len(widths) > 2 or len({len(v) for v in table.vertices}) != 1:
        raise InputError("mesh: all vertices must have equally many numbers, and all cells too")
    cells = np.array(table.cells, dtype=np.int64) if table.cells else np.zeros((0, 0), dtype=np.int64)
    return domains_from_arrays(np.array(table.vertices), cells, Kind[table.kind.upper()])


def make_material(name: str, table: MaterialTable) -> Material:
    """Return the material of a table."""
    if table.law not in MATERIALS:
        raise InputError(
            f"materials.{name}.law = {table.law!r}{did_you_mean(table.law, MATERIALS)}; there are"
            f" {', '.join(MATERIALS)}; a law of your own needs --plugin FILE.py"
        )
    parameters = dict(table.model_extra or {})
    for key, value in parameters.items():
        if isinstance(value, bool) or not isinstance(value, int | float | str):
            raise InputError(f"materials.{name}.{key} = {value!r}: must be a number")
    try:
        return material_from(table.law, **parameters)
    except InputError as error:
        raise InputError(f"materials.{name}: {error}") from None


def make_velocity(body: BodyTable, number: int, dim: int) -> Any:
    """Return a body's initial velocity: numbers, or a function of position."""
    where = f"bodies.{number}.velocity"
    if len(body.velocity) > dim:
        raise InputError(f"{where}: {len(body.velocity)} components given; the grid has {dim} axes")
    if not any(isinstance(v, str) for v in body.velocity):
        return tuple(float(v) for v in body.velocity)
    field = vector_field(list(body.velocity), dim, where, time=False)
    return lambda x: field(x, x, 0.0)


def make_interpolation(table: InterpolationTable) -> Interpolation:
    """Return the interpolation of a table."""
    if table.method not in METHODS:
        raise InputError(
            f"interpolation.method = {table.method!r}{did_you_mean(table.method, METHODS)};"
            f" allowed are {', '.join(METHODS)}"
        )
    choice = METHODS[table.method]
    given = ((name, getattr(table, name)) for name in type(table).model_fields if name != "method")
    options: dict[str, Any] = {name: value for name, value in given if value is not None}
    allowed = _options(choice)
    for key in options:
        if key not in allowed:
            others = [name for name, m in METHODS.items() if key in _options(m)]
            raise InputError(
                f"interpolation.{key}: {table.method} has no such option; it has"
                f" {', '.join(allowed) or 'none'}; use {' or '.join(others)}"
            )
    with naming("interpolation"):
        if not isinstance(options.get("where", ""), str):
            options["where"] = make_region(options["where"])
        if "basis" in options:
            options["basis"] = _BASES[options["basis"]]
        return dataclasses.replace(choice, **options)


def _options(choice: Interpolation) -> list[str]:
    """Names of its options; the degree of plain B-splines is in the method's name."""
    fixed = {"degree"} if isinstance(choice, BSpline) else set()
    return [f.name for f in dataclasses.fields(choice) if f.name not in fixed]


_BASES = {"linear": Linear(), "bspline2": BSpline(2), "bspline3": BSpline(3)}


def make_scheme(table: SchemeTable, interpolation: Interpolation) -> Scheme:
    """Return the scheme of a table; without an order, that of the interpolation."""
    return SCHEMES[table.order or interpolation.default_scheme](make_transfer(table))


def make_transfer(table: SchemeTable) -> Transfer:
    """Return the velocity transfer of a table.

    Raises
    ------
    InputError
        If an option belongs to another transfer, or is out of range.
    """
    if table.blend is not None and table.transfer != "flip":
        raise InputError(f"scheme.blend: {table.transfer} has no blend; it belongs to flip")
    if table.terms is not None and table.transfer not in ("xpic", "fmpm"):
        raise InputError(f"scheme.terms: {table.transfer} has no series; it belongs to xpic and fmpm")
    choice = TRANSFERS[table.transfer]
    if choice is FLIP and table.blend is not None:
        with naming("scheme.blend"):
            return FLIP(table.blend)
    if choice in (XPIC, FMPM) and table.terms is not None:
        with naming("scheme.terms"):
            return (XPIC if choice is XPIC else FMPM)(table.terms)
    return choice()


def make_timestep(table: TimeTable) -> TimeStep:
    """Return the time step of a table."""
    if (table.step is None) == (table.cfl is None):
        raise InputError("time: give either step (seconds) or cfl (a share of the stable step)")
    if table.step is not None:
        if table.largest is not None:
            raise InputError("time.largest: it belongs to cfl, not to a fixed step")
        with naming("time.step"):
            return FixedStep(table.step, table.allow_unstable)
    if table.allow_unstable:
        raise InputError("time.allow_unstable: it belongs to a fixed step; cfl is always stable")
    assert table.cfl is not None
    with naming("time.cfl"):
        rule = CFL(table.cfl)
    with naming("time.largest"):
        return rule if table.largest is None else CFL(table.cfl, largest=table.largest)

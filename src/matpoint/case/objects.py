"""Strings and tables to matpoint's objects: regions, meshes, materials, conditions, loads."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np

from matpoint.boundary import Condition, Fixed, Plane, PrescribedVelocity, Roller, Symmetry
from matpoint.case.describe import did_you_mean, naming
from matpoint.case.schema import (
    BodyTable,
    BoundaryTable,
    DampingTable,
    InterpolationTable,
    LoadTable,
    MaterialTable,
    PlaneTable,
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
from matpoint.errors import InputError
from matpoint.expressions import Expression, vector_field
from matpoint.grid import Grid
from matpoint.interpolation import METHODS, Interpolation
from matpoint.loads import BodyForce, Damping, Gravity, Load, LocalDamping, MassDamping, NoDamping
from matpoint.materials import MATERIALS, Material, material_from
from matpoint.meshes import domains_from_arrays, extrude, mesh_annulus, mesh_box
from matpoint.regions import Annulus, Ball, Box, HalfSpace, Polygon, Region
from matpoint.scheme import APIC, FLIP, PIC, SCHEMES, Scheme
from matpoint.timestep import CFL, FixedStep, TimeStep


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
    options = {k: v for k, v in table.model_dump(exclude={"method"}).items() if v is not None}
    allowed = [f.name for f in dataclasses.fields(choice) if f.name != "degree"]
    for key in options:
        if key not in allowed:
            raise InputError(
                f"interpolation.{key}: {table.method} has no such option; it has"
                f" {', '.join(allowed) or 'none'}"
            )
    return dataclasses.replace(choice, **options)


def make_scheme(table: SchemeTable) -> Scheme:
    """Return the scheme of a table."""
    if table.blend is not None and table.transfer != "flip":
        raise InputError(f"scheme.blend: {table.transfer} has no blend; it belongs to flip")
    blend = 1.0 if table.blend is None else table.blend
    with naming("scheme.blend"):
        transfers = {"flip": FLIP(blend), "pic": PIC(), "apic": APIC()}
    return SCHEMES[table.order](transfers[table.transfer])


def make_condition(table: BoundaryTable, number: int, grid: Grid, walls_only: bool = False) -> Condition:
    """Return the boundary condition of a table, on a grid whose inner planes ``walls_only`` forbids."""
    where = f"boundaries.{number}"
    if (table.plane is None) == (table.region is None):
        raise InputError(f"{where}: give either plane or region")
    if table.velocity is not None and table.kind != "velocity":
        raise InputError(f"{where}.velocity: only kind = 'velocity' has one")
    if table.normal is not None and table.kind != "roller":
        raise InputError(f"{where}.normal: only kind = 'roller' has one")
    if table.plane is None:
        with naming(f"{where}.region"):
            place: Any = make_region(table.region)
    else:
        place = _plane(table.plane, f"{where}.plane", grid, walls_only)
    with naming(where):
        condition = _condition(table, where, place)
    with naming(f"{where}.{'velocity' if table.velocity is not None else 'normal'}"):
        condition.components(grid.dim)
    return condition


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
            raise InputError(f"{where}: symmetry needs a plane, not a region")
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


def make_load(table: LoadTable, number: int, dim: int) -> Load:
    """Return the load of a table."""
    where = f"loads.{number}"
    if table.kind == "body-force":
        if table.ramp or table.history is not None:
            raise InputError(
                f"{where}: a body force has its time in its expressions; ramp and history don't apply"
            )
        field = vector_field(list(table.value), dim, f"{where}.value")
        return BodyForce(field)
    if any(isinstance(v, str) for v in table.value):
        raise InputError(
            f"{where}.value = {table.value!r}: gravity takes numbers; use history, or a body-force"
        )
    if len(table.value) > dim:
        raise InputError(f"{where}.value: gravity has {len(table.value)} components; the grid has {dim} axes")
    history = None
    if table.history is not None:
        formula = Expression(table.history, ("t",), f"{where}.history")
        history = lambda t: float(formula(t=t))  # noqa: E731
    with naming(f"{where}.ramp"):  # all else has been checked
        return Gravity(tuple(float(v) for v in table.value), table.ramp, history)


def make_damping(table: DampingTable | None) -> Damping:
    """Return the damping of a table."""
    if table is None or table.kind == "none":
        return NoDamping()
    wanted, other = ("rate", "factor") if table.kind == "mass" else ("factor", "rate")
    value = getattr(table, wanted)
    if value is None or getattr(table, other) is not None:
        raise InputError(f"damping: kind = {table.kind!r} takes {wanted}, and nothing else")
    with naming(f"damping.{wanted}"):
        return MassDamping(value) if table.kind == "mass" else LocalDamping(value)


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

"""Tables of loads and damping to loads and damping."""

from __future__ import annotations

from matpoint.case.conditions import make_surface
from matpoint.case.schema import DampingTable, LoadTable
from matpoint.errors import InputError, naming
from matpoint.expressions import Expression, vector_field
from matpoint.face_loads import FaceLoad, Pressure, Traction
from matpoint.loads import BodyForce, Damping, Gravity, History, Load, LocalDamping, MassDamping, NoDamping


def make_load(table: LoadTable, number: int, dim: int) -> Load | FaceLoad:
    """Return the load of a table."""
    where = f"loads.{number}"
    if table.kind in ("pressure", "traction"):
        return _face_load(table, where, dim)
    for key in ("surface", "per"):
        if getattr(table, key) is not None:
            raise InputError(f"{where}.{key}: only pressure and traction have one")
    if not isinstance(table.value, list):
        raise InputError(f"{where}.value = {table.value!r}: a list is needed, one entry per axis")
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
    with naming(f"{where}.ramp"):  # all else has been checked
        return Gravity(tuple(float(v) for v in table.value), table.ramp, _history(table, where))


def _history(table: LoadTable, where: str) -> History | None:
    if table.history is None:
        return None
    formula = Expression(table.history, ("t",), f"{where}.history")
    return lambda t: float(formula(t=t))


def _face_load(table: LoadTable, where: str, dim: int) -> FaceLoad:
    if table.surface is None:
        raise InputError(f"{where}: {table.kind} needs surface = the name of a boundary set")
    surface, history = make_surface(table.surface), _history(table, where)
    if table.kind == "pressure":
        if not isinstance(table.value, float | int):
            raise InputError(f"{where}.value = {table.value!r}: a pressure is one number")
        if table.per is not None:
            raise InputError(f"{where}.per: a pressure acts on the deformed area; per belongs to traction")
        with naming(f"{where}.ramp"):
            return Pressure(surface, float(table.value), table.ramp, history)
    if not isinstance(table.value, list) or any(isinstance(v, str) for v in table.value):
        raise InputError(f"{where}.value = {table.value!r}: a traction is a list of numbers, one per axis")
    if len(table.value) > dim:
        raise InputError(f"{where}.value: traction has {len(table.value)} components for {dim} axes")
    value = tuple(float(v) for v in table.value)
    with naming(f"{where}.ramp"):
        return Traction(surface, value, table.ramp, history, table.per or "initial")


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

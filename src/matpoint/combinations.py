"""What a simulation is given: the right kinds of things, and only such as work together."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, get_args

from matpoint.body import Body
from matpoint.boundary import Condition
from matpoint.checks import instance, instances
from matpoint.errors import InputError
from matpoint.face_loads import FaceLoad
from matpoint.grid import Grid
from matpoint.interpolation.contract import Interpolation
from matpoint.loads import Damping, Load
from matpoint.places import Corners, Surface
from matpoint.scheme import Scheme
from matpoint.timestep import TimeStep
from matpoint.transfers import APIC, FMPM, XPIC


def _names(union: Any) -> str:
    return ", ".join(f"{kind.__name__}(...)" for kind in get_args(union))


def check_arguments(
    grid: Any,
    bodies: Any,
    interpolation: Any,
    timestep: Any,
    scheme: Any,
    boundaries: Any,
    loads: Any,
    damping: Any,
) -> None:
    """Refuse what is not of the kind that :class:`~matpoint.Simulation` takes.

    Raises
    ------
    InputError
        With the argument's name, what was given, and what is allowed.
    """
    instance("simulation: grid", grid, Grid, "a Grid")
    instances("simulation: bodies", bodies, Body, "Body objects")
    instance(
        "simulation: interpolation", interpolation, Interpolation,
        "an interpolation, for instance CPDI2(); names are keys of matpoint.METHODS",
    )  # fmt: skip
    instance("simulation: timestep", timestep, TimeStep, _names(TimeStep))
    if scheme is not None:
        instance("simulation: scheme", scheme, Scheme, "a scheme, for instance USL() or MUSL(FLIP(0.99))")
    instances("simulation: boundaries", boundaries, Condition, f"conditions: {_names(Condition)}")
    instances("simulation: loads", loads, Load | FaceLoad, f"loads: {_names(Load | FaceLoad)}")
    if damping is not None:
        instance("simulation: damping", damping, Damping, _names(Damping))


def refuse_combinations(
    dim: int,
    interpolation: Interpolation,
    scheme: Scheme,
    boundaries: Sequence[Condition],
    loads: Sequence[Load | FaceLoad],
) -> None:
    """Refuse an interpolation that can't serve the dimension, the transfer, the conditions or the loads.

    Raises
    ------
    InputError
        With what would do instead.
    """
    name = interpolation.name
    if dim not in interpolation.dimensions:
        allowed = ", ".join(f"{d}-D" for d in interpolation.dimensions)
        raise InputError(f"{name} serves {allowed}; the grid is {dim}-D")
    if interpolation.default_scheme not in (scheme.name, "usl"):
        raise InputError(
            f"{name}: reproject = true is the order of stages of {interpolation.default_scheme}; leave the"
            " scheme out, or set reproject = false"
        )
    if isinstance(scheme.transfer, APIC) and not interpolation.affine:
        raise InputError(
            f"{name} with APIC: an affine velocity needs a point with a block of nodes;"
            " use FLIP or PIC, or a box-family interpolation (mpm, ugimp, cpgimp, bspline2, bspline3)"
        )
    if isinstance(scheme.transfer, XPIC | FMPM) and interpolation.consistent:
        raise InputError(
            f"{name} with {type(scheme.transfer).__name__}: its mass is the full one, solved exactly, so that"
            " there is no series to sum; use PIC, the limit of many terms, or FLIP"
        )
    on_corners = [type(c).__name__ for c in boundaries if isinstance(c.where, Surface | Corners)]
    on_corners += [type(load).__name__ for load in loads if isinstance(load, FaceLoad)]
    if on_corners and not interpolation.shares_corners:
        raise InputError(
            f"{on_corners[0]} on corners or faces of particle domains: {name} has none that are shared;"
            " use cpdi2 or enriched-cpdi2"
        )

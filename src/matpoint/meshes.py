"""Structured meshes of particle domains, and meshes from arrays."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from matpoint.coincident import first_in_place
from matpoint.domains import Domains, Kind
from matpoint.errors import InputError
from matpoint.faces import split_by
from matpoint.fill import lattice_domains


def _divisions(what: str, values: Sequence[int], count: int) -> tuple[int, ...]:
    numbers = tuple(values)
    if len(numbers) != count or any(isinstance(n, bool) or n != int(n) or n < 1 for n in numbers):
        raise InputError(f"{what}: divisions = {list(values)} must be {count} whole numbers >= 1")
    return tuple(int(n) for n in numbers)


def mesh_box(lower: Sequence[float], upper: Sequence[float], divisions: Sequence[int]) -> Domains:
    """Return a box of equal lines, quadrilaterals or hexahedra.

    Its boundary sets are ``x-``, ``x+``, and so on for the other axes.

    Parameters
    ----------
    lower, upper
        Its corners [m], one number per axis.
    divisions
        Domains along each axis.

    Raises
    ------
    InputError
        If sizes or divisions are not positive.
    """
    low, high = np.array(lower, dtype=float), np.array(upper, dtype=float)
    if low.shape != high.shape or not 1 <= len(low) <= 3:
        raise InputError(
            f"mesh box: lower = {list(lower)} and upper = {list(upper)} must have 1 to 3 numbers each"
        )
    if not (np.isfinite(low).all() and np.isfinite(high).all() and (high > low).all()):
        raise InputError(f"mesh box: upper = {list(upper)} must be greater than lower = {list(lower)}")
    count = np.array(_divisions("mesh box", divisions, len(low)))
    box = lattice_domains(np.ones(count, dtype=bool), np.zeros(len(low)), low, (high - low) / count)
    hair = 1e-9 * (high - low)
    sides = {}
    for k, axis in enumerate("xyz"[: len(low)]):
        sides[f"{axis}-"] = box.vertices[:, k] <= low[k] + hair[k]
        sides[f"{axis}+"] = box.vertices[:, k] >= high[k] - hair[k]
    return replace(box, sets=split_by(box, sides))


def mesh_annulus(
    inner: float,
    outer: float,
    divisions: Sequence[int],
    angles: tuple[float, float] = (0.0, math.pi / 2),
    centre: Sequence[float] = (0.0, 0.0),
) -> Domains:
    """Return a sector of a ring in quadrilaterals, or a whole ring.

    Its boundary sets are ``inner`` and ``outer``, and ``start`` and ``end`` where the angles begin and end.

    Parameters
    ----------
    inner, outer
        Radii [m].
    divisions
        Domains along the radius and along the angle.
    angles
        First and last angle [rad]; a span of 2 pi closes the ring.
    centre
        [m]

    Raises
    ------
    InputError
        If radii or angles are out of order, or divisions are not positive.
    """
    if not (math.isfinite(inner) and math.isfinite(outer) and 0 < inner < outer):
        raise InputError(f"mesh annulus: inner = {inner:g} and outer = {outer:g} must be 0 < inner < outer")
    span = angles[1] - angles[0]
    if not 0 < span <= 2 * math.pi + 1e-9:
        raise InputError(f"mesh annulus: angles = {list(angles)} must grow by at most 2 pi")
    radial, tangential = _divisions("mesh annulus", divisions, 2)
    closed = abs(span - 2 * math.pi) < 1e-9
    if closed and tangential < 3:
        raise InputError("mesh annulus: a whole ring needs 3 divisions along the angle, or more")
    r = np.linspace(inner, outer, radial + 1)
    columns = tangential if closed else tangential + 1
    a = angles[0] + span * np.arange(columns) / tangential
    x = np.zeros(((radial + 1) * columns, 3))
    x[:, 0] = centre[0] + np.outer(r, np.cos(a)).ravel()
    x[:, 1] = centre[1] + np.outer(r, np.sin(a)).ravel()
    # Symmetry planes must be met exactly, not to a rounding of the cosine.
    x[np.abs(x) < 1e-12 * outer] = 0.0
    i, j = (m.ravel() for m in np.meshgrid(np.arange(radial), np.arange(tangential), indexing="ij"))
    k = (j + 1) % columns
    cells = np.stack([i * columns + j, (i + 1) * columns + j, (i + 1) * columns + k, i * columns + k], axis=1)
    ring = Domains(x, cells, Kind.QUAD)
    row, column = np.divmod(np.arange(len(x)), columns)
    sides = {"inner": row == 0, "outer": row == radial}
    if not closed:
        sides |= {"start": column == 0, "end": column == columns - 1}
    return replace(ring, sets=split_by(ring, sides))


def extrude(domains: Domains, heights: Sequence[float]) -> Domains:
    """Return hexahedra: quadrilaterals drawn along z.

    Boundary sets of the quadrilaterals become walls of the same name; ``z-`` and ``z+`` are added.

    Parameters
    ----------
    domains
        Quadrilaterals.
    heights
        Increasing z levels [m], one more than layers.

    Raises
    ------
    InputError
        If the domains are not quadrilaterals or the heights don't increase.
    """
    if domains.kind != Kind.QUAD:
        raise InputError(f"extrude: {domains.kind.name.lower()} domains given; quadrilaterals are needed")
    z = np.array(heights, dtype=float)
    if z.ndim != 1 or len(z) < 2 or not (np.isfinite(z).all() and (np.diff(z) > 0).all()):
        raise InputError(f"extrude: heights = {list(heights)} must increase, and be two or more")
    nv = len(domains.vertices)
    x = np.tile(domains.vertices, (len(z), 1))
    x[:, 2] = np.repeat(z, nv)
    cells = [np.hstack([domains.cells + k * nv, domains.cells + (k + 1) * nv]) for k in range(len(z) - 1)]
    walls = {
        name: np.concatenate(
            [np.hstack([rows + k * nv, rows[:, ::-1] + (k + 1) * nv]) for k in range(len(z) - 1)]
        )
        for name, rows in domains.sets.items()
    }
    ends = {"z-": domains.cells[:, ::-1], "z+": domains.cells + (len(z) - 1) * nv}
    return Domains(x, np.concatenate(cells), Kind.HEX, sets=walls | ends)


def mapped(domains: Domains, function: Callable[[np.ndarray], np.ndarray]) -> Domains:
    """Return domains with their vertices moved: turned, sheared, bent to another shape.

    Parameters
    ----------
    domains
        Any domains; boundary sets stay.
    function
        Takes positions [m] of shape (nv, 3) and returns the new ones.

    Raises
    ------
    InputError
        As :class:`Domains`: if a domain turns over, or a missing axis gets coordinates.
    """
    return replace(domains, vertices=np.asarray(function(domains.vertices.copy())), checked=False)


def _join_twins(x: np.ndarray, cells: np.ndarray, tolerance: float) -> tuple[np.ndarray, np.ndarray]:
    """Make one vertex of those that lie in one place, so that neighbours share it."""
    first = first_in_place(x, tolerance * float(np.ptp(x, axis=0).max()))
    kept, number = np.unique(first, return_inverse=True)
    return x[kept], number[cells]


def domains_from_arrays(
    vertices: np.ndarray, cells: np.ndarray, kind: Kind | str, tolerance: float = 1e-9
) -> Domains:
    """Return domains from vertex and connectivity arrays.

    Parameters
    ----------
    vertices
        Positions [m], shape (nv, 1), (nv, 2) or (nv, 3).
    cells
        Corners of each domain in VTK's order, shape (n, corners).
    kind
        Their shape.
    tolerance
        Vertices nearer than this share of the mesh's extent become one, so that their domains are joined.

    Raises
    ------
    InputError
        As :class:`Domains`.
    """
    try:
        given = np.asarray(vertices, dtype=float)
        numbered = np.asarray(cells)
    except (TypeError, ValueError):
        raise InputError("mesh: vertices and cells must be arrays of numbers, rows equally long") from None
    if given.ndim != 2 or not 1 <= given.shape[1] <= 3:
        raise InputError(f"mesh: vertices have shape {given.shape}; (number, 1 to 3) is needed")
    x = np.zeros((len(given), 3))
    x[:, : given.shape[1]] = given
    ready = numbered.ndim == 2 and np.issubdtype(numbered.dtype, np.integer) and np.isfinite(x).all()
    if ready and len(x) and numbered.size and numbered.min() >= 0 and numbered.max() < len(x):
        x, numbered = _join_twins(x, numbered, tolerance)
    return Domains(x, numbered, kind)  # type: ignore[arg-type] (names are taken too)

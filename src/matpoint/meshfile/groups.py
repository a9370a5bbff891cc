"""From the cells of a mesh file to the domains of its groups, mended and checked, with boundary sets."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from matpoint.coincident import first_in_place
from matpoint.domains import Domains, Kind
from matpoint.errors import InputError
from matpoint.faces import all_faces
from matpoint.meshfile.mend import corners_text, flatten, orient, refuse_bad_cells
from matpoint.meshfile.read import KINDS, Patch


def grouped_domains(
    points: np.ndarray, patches: Sequence[Patch], tolerance: float, gmsh: bool, where: str
) -> dict[str, tuple[Domains, ...]]:
    """Return the domains of each group, one entry for each shape of cell, with the sets that touch them.

    Parameters
    ----------
    points
        Vertices [m], shape (nv, 3).
    patches
        Cells of all dimensions; the highest become domains, those one lower sets.
    tolerance
        Vertices closer than this share of the diagonal are one.
    gmsh
        Whether the groups are Gmsh's, for messages.
    where
        What messages begin with.

    Raises
    ------
    InputError
        If a cell is in no group or in two, is tangled or has no volume, or a set holds what is not a face.
    """
    top = max(patch.dim for patch in patches)
    solid = [patch for patch in patches if patch.dim == top]
    sides = [patch for patch in patches if patch.dim == top - 1]
    _check_names(solid, gmsh, where)
    points, place = _mended_points(points, [*solid, *sides], top, tolerance, where)
    cells = _mended_cells(points, place, solid, where)
    _check_sides(points, place, sides, cells, where)
    sets: dict[str, list[np.ndarray]] = {}
    for patch in sides:
        for name in patch.names:
            sets.setdefault(name, []).append(place[patch.cells])
    return {
        name: tuple(
            _domains(points, rows[owners == name], kind, sets)
            for kind, (rows, owners) in cells.items()
            if (owners == name).any()
        )
        for name in dict.fromkeys(patch.names[0] for patch in solid)
    }


def _check_names(solid: Sequence[Patch], gmsh: bool, where: str) -> None:
    """Each cell of the highest dimension is in one group."""
    for patch in solid:
        which = f"{patch.shape} {patch.numbers[0]} (from 0; {len(patch.cells)} such)"
        if len(patch.names) > 1:
            raise InputError(
                f"{where}: {which} is in the groups {' and '.join(map(repr, patch.names))}; one is allowed"
            )
        if not patch.names:
            how = ("", "Physical Curve", "Physical Surface", "Physical Volume")[patch.dim]
            hint = f'in Gmsh write {how}("name") = {{...}}' if gmsh else "number groups from 1"
            raise InputError(f"{where}: {which} belongs to no physical group; {hint}")


def _mended_points(
    points: np.ndarray, patches: Sequence[Patch], dim: int, tolerance: float, where: str
) -> tuple[np.ndarray, np.ndarray]:
    """Points on the axes of the mesh, and for each one the first in its place."""
    used = np.unique(np.concatenate([patch.cells.ravel() for patch in patches]))
    size = float(np.linalg.norm(np.ptp(points[used], axis=0)))
    flat = points.copy()
    flat[used] = flatten(points[used], dim, max(tolerance, 1e-9) * size, where)
    place = np.arange(len(points))
    place[used] = used[first_in_place(flat[used], tolerance * size)]
    return flat, place


def _mended_cells(
    points: np.ndarray, place: np.ndarray, solid: Sequence[Patch], where: str
) -> dict[Kind, tuple[np.ndarray, np.ndarray]]:
    """Oriented and checked cells of each kind, and the group of each, in the file's order."""
    found = {}
    for shape in dict.fromkeys(patch.shape for patch in solid):
        mine = [patch for patch in solid if patch.shape == shape]
        numbers = np.concatenate([patch.numbers for patch in mine])
        order = np.argsort(numbers)
        cells = place[np.concatenate([patch.cells for patch in mine])[order]]
        owners = np.repeat([patch.names[0] for patch in mine], [len(patch.cells) for patch in mine])[order]
        kind = KINDS[shape]
        cells = orient(points, cells, kind)
        refuse_bad_cells(points, cells, kind, numbers[order], where)
        found[kind] = (cells, owners)
    return found


def _among(rows: np.ndarray, faces: np.ndarray, count: int) -> np.ndarray:
    """Whether rows of vertices (m, w), in any order, are among faces (n, w); count is that of vertices."""
    if rows.shape[1] != faces.shape[1]:
        return np.zeros(len(rows), dtype=bool)
    touched = np.zeros(count, dtype=bool)
    touched[rows] = True
    near = np.sort(faces[touched[faces].all(axis=1)], axis=1)
    both = np.concatenate([near, np.sort(rows, axis=1)])
    number = np.unique(both, axis=0, return_inverse=True)[1].ravel()
    return np.isin(number[len(near) :], number[: len(near)])


def _check_sides(
    points: np.ndarray,
    place: np.ndarray,
    sides: Sequence[Patch],
    cells: Mapping[Kind, tuple[np.ndarray, np.ndarray]],
    where: str,
) -> None:
    """Cells one dimension lower are faces of the others."""
    for patch in sides:
        rows = place[patch.cells]
        known = np.zeros(len(rows), dtype=bool)
        for kind, (corners, _) in cells.items():
            known |= _among(rows, all_faces(corners, kind), len(points))
        if not known.all():
            k = int(np.flatnonzero(~known)[0])
            of = f" of boundary set {patch.names[0]!r}" if patch.names else ""
            raise InputError(
                f"{where}: {patch.shape} {patch.numbers[k]} (from 0){of} is not a face of any"
                f" {' or '.join(kind.name.lower() for kind in cells)};"
                f" its vertices are {corners_text(points[rows[k]], patch.dim + 1)}"
            )


def _domains(
    points: np.ndarray, cells: np.ndarray, kind: Kind, sets: Mapping[str, Sequence[np.ndarray]]
) -> Domains:
    """Domains with their own vertices only, and the sets that touch them."""
    faces, mine = all_faces(cells, kind), {}
    for name, parts in sets.items():
        rows = [part[_among(part, faces, len(points))] for part in parts if part.shape[1] == faces.shape[1]]
        if sum(map(len, rows)):
            _, first = np.unique(np.sort(np.concatenate(rows), axis=1), axis=0, return_index=True)
            mine[name] = np.concatenate(rows)[np.sort(first)]
    used = np.unique(cells)
    local = np.zeros(len(points), dtype=np.int64)
    local[used] = np.arange(len(used))
    return Domains(points[used], local[cells], kind, sets={name: local[rows] for name, rows in mine.items()})

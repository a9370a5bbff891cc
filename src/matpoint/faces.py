"""Faces of particle domains: which corners make them, and which way they look.

A face is a row of corner numbers: one corner in 1-D, two in 2-D, three or four in 3-D. Seen from outside
its domain it runs counter-clockwise, so that the normal that it defines points outward.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from matpoint.domains import Domains, Kind
from matpoint.errors import InputError
from matpoint.measures import BLOCK

#: Corners of each face of a domain, in VTK's order of corners, seen from outside.
FACES: dict[Kind, tuple[tuple[int, ...], ...]] = {
    Kind.LINE: ((0,), (1,)),
    Kind.QUAD: ((0, 1), (1, 2), (2, 3), (3, 0)),
    Kind.HEX: ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)),
    Kind.TRI: ((0, 1), (1, 2), (2, 0)),
    Kind.TET: ((0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)),
}


def all_faces(cells: np.ndarray, kind: Kind) -> np.ndarray:
    """Return all faces of domains, shape (n * faces, corners of a face), seen from outside.

    Parameters
    ----------
    cells
        Corners of each domain in VTK's order, shape (n, corners).
    kind
        Their shape.
    """
    return cells[:, np.array(FACES[kind])].reshape(-1, len(FACES[kind][0]))


def flagged_faces(cells: np.ndarray, kind: Kind, flags: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return those of :func:`all_faces` all of whose corners carry a flag, and their places among all.

    Parameters
    ----------
    cells, kind
        As for :func:`all_faces`.
    flags
        Flag of each vertex, shape (nv,).
    """
    found, places = [all_faces(cells[:0], kind)], [np.zeros(0, dtype=np.int64)]
    for start in range(0, len(cells), BLOCK):
        faces = all_faces(cells[start : start + BLOCK], kind)
        keep = np.flatnonzero(flags[faces].all(axis=1))
        found.append(faces[keep])
        places.append(start * len(FACES[kind]) + keep)
    return np.concatenate(found), np.concatenate(places)


@dataclass(frozen=True, eq=False)
class Facets:
    """A boundary set of one body, once the bodies are joined.

    Attributes
    ----------
    name, body
        Names of the set and of the body.
    corners : ndarray of int64, shape (m, k)
        Vertices of each face, seen from outside its body.
    sign : ndarray, shape (m,)
        1-D only: -1 where the body's outside lies along -x; 1 elsewhere.
    outer : ndarray of bool, shape (m,)
        False for faces that two domains share once the bodies are joined.
    """

    name: str
    body: str
    corners: np.ndarray
    sign: np.ndarray
    outer: np.ndarray


def flag(vertices: np.ndarray, count: int) -> np.ndarray:
    """Return a flag for each of ``count`` vertices: whether it is among some."""
    flags = np.zeros(count, dtype=bool)
    flags[vertices] = True
    return flags


def _unshared(faces: np.ndarray) -> np.ndarray:
    """The faces that stand once in a list, in its order."""
    if len(faces) == 0:
        return faces
    _, first, count = np.unique(np.sort(faces, axis=1), axis=0, return_index=True, return_counts=True)
    return faces[np.sort(first[count == 1])]


def outer_faces(domains: Domains) -> np.ndarray:
    """Return the faces that belong to one domain only, seen from outside, shape (m, corners of a face)."""
    return _unshared(all_faces(domains.cells, domains.kind))


def split_by(domains: Domains, sides: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Return the outer faces whose corners all carry a flag, one set for each name.

    Parameters
    ----------
    domains
        The mesh.
    sides
        Name of the set -> flag of each vertex, shape (nv,).
    """
    return {
        name: _unshared(flagged_faces(domains.cells, domains.kind, flags)[0]) for name, flags in sides.items()
    }


def orient(rows: np.ndarray, cells: np.ndarray, kind: Kind, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Return faces as seen from outside their domain, and their sign (see :class:`Facets`).

    Parameters
    ----------
    rows
        Faces in any orientation, shape (m, k); each must be a face of a domain.
    cells, kind
        The domains.
    count
        The number of vertices.
    """
    faces, places = flagged_faces(cells, kind, flag(rows, count))
    known = {tuple(sorted(face)): q for q, face in enumerate(faces.tolist())}
    found = np.array([known[tuple(sorted(row))] for row in rows.tolist()], dtype=np.int64)
    sign = np.ones(len(found))
    if kind == Kind.LINE:
        sign[places[found] % 2 == 0] = -1.0
    return faces[found].astype(np.int64), sign


def shared_faces(rows: np.ndarray, parts: Sequence[tuple[np.ndarray, Kind]], count: int) -> np.ndarray:
    """Return a flag for each of the faces ``rows``: whether more than one domain has it.

    Parameters
    ----------
    rows
        Faces, shape (m, k).
    parts
        Cells and shape of each body.
    count
        The number of vertices.
    """
    tally: Counter[tuple[int, ...]] = Counter()
    for cells, kind in parts:
        faces, _ = flagged_faces(cells, kind, flag(rows, count))
        tally.update(tuple(sorted(face)) for face in faces.tolist())
    return np.array([tally[tuple(sorted(row))] > 1 for row in rows.tolist()], dtype=bool)


def check_sets(domains: Domains) -> None:
    """Refuse boundary sets that are not sets of faces.

    Raises
    ------
    InputError
        If a set is empty or has the wrong shape, or a row is not a face of one of the domains.
    """
    kind, count = domains.kind, len(domains.vertices)
    width = len(FACES[kind][0])
    for name, rows in domains.sets.items():
        if rows.ndim != 2 or rows.shape[1] != width or not np.issubdtype(rows.dtype, np.integer):
            raise InputError(
                f"mesh: boundary set {name!r} has shape {rows.shape}; faces of {kind.name.lower()}"
                f" domains are whole numbers of shape (number, {width})"
            )
        if len(rows) == 0:
            raise InputError(f"mesh: boundary set {name!r} is empty")
        inside = ((rows >= 0) & (rows < count)).all(axis=1)
        close, _ = flagged_faces(domains.cells, kind, flag(rows[inside], count))
        known = {tuple(sorted(face)) for face in close.tolist()}
        for row in rows.tolist():
            if tuple(sorted(row)) not in known:
                raise InputError(f"mesh: boundary set {name!r}: {row} is not a face of any domain")

"""Faces of particle domains: which corners make them, and which way they look.

A face is a row of corner numbers: one corner in 1-D, two in 2-D, three or four in 3-D. Seen from outside
its domain it runs counter-clockwise, so that the normal that it defines points outward.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from matpoint.domains import Domains, Kind
from matpoint.errors import InputError

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


def outer_faces(domains: Domains) -> np.ndarray:
    """Return the faces that belong to one domain only, seen from outside."""
    faces = all_faces(domains.cells, domains.kind)
    _, first, count = np.unique(np.sort(faces, axis=1), axis=0, return_index=True, return_counts=True)
    return faces[np.sort(first[count == 1])]


def split_by(domains: Domains, sides: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Return the outer faces whose corners all carry a flag, one set for each name.

    Parameters
    ----------
    domains
        The mesh.
    sides
        Name of the set -> flag of each vertex, shape (nv,).
    """
    faces = outer_faces(domains)
    return {name: faces[flags[faces].all(axis=1)] for name, flags in sides.items()}


def check_sets(domains: Domains) -> None:
    """Refuse boundary sets that are not sets of faces.

    Raises
    ------
    InputError
        If a set is empty or has the wrong shape, or a row is not a face of one of the domains.
    """
    faces = np.sort(all_faces(domains.cells, domains.kind), axis=1)
    width = faces.shape[1]
    known = {tuple(f) for f in faces.tolist()} if domains.sets else set()
    for name, rows in domains.sets.items():
        if rows.ndim != 2 or rows.shape[1] != width or not np.issubdtype(rows.dtype, np.integer):
            raise InputError(
                f"mesh: boundary set {name!r} has shape {rows.shape}; faces of {domains.kind.name.lower()}"
                f" domains are whole numbers of shape (number, {width})"
            )
        if len(rows) == 0:
            raise InputError(f"mesh: boundary set {name!r} is empty")
        for row in rows.tolist():
            if tuple(sorted(row)) not in known:
                raise InputError(f"mesh: boundary set {name!r}: {row} is not a face of any domain")

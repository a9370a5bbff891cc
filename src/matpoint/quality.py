"""The shape of particle domains: how near they are to turning over, how slender they are."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from matpoint.domains import Domains, Kind
from matpoint.faces import FACES
from matpoint.vertices import Vertices

_QUAD = ((0, 1), (1, 2), (2, 3), (3, 0))
#: Edges of each shape as pairs of corners.
EDGES: dict[Kind, tuple[tuple[int, int], ...]] = {
    Kind.LINE: ((0, 1),),
    Kind.QUAD: _QUAD,
    Kind.HEX: (*_QUAD, (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)),
    Kind.TRI: ((0, 1), (1, 2), (2, 0)),
    Kind.TET: ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)),
}


def _by_kind(vertices: Vertices) -> Iterator[tuple[np.ndarray, Kind, np.ndarray]]:
    """Yield particles of one shape, the shape, and their corners."""
    for kind in Kind:
        rows = np.flatnonzero(vertices.kind == kind)
        if len(rows):
            yield rows, kind, vertices.connectivity[rows, : kind.corners]


def corner_jacobians(vertices: Vertices) -> np.ndarray:
    """Return the smallest corner Jacobian of each domain over its mean, shape (n,).

    1 for parallelograms, parallelepipeds and simplices; 0 or less for a domain that has turned over.
    """
    result = np.ones(len(vertices.kind))
    for rows, kind, cells in _by_kind(vertices):
        domains = Domains(vertices.position, cells, kind, checked=True)
        result[rows] = domains.corner_jacobians().min(axis=1) / np.abs(domains.volumes())
    return result


def edge_lengths(vertices: Vertices) -> tuple[np.ndarray, np.ndarray]:
    """Return the shortest and the longest edge [m] of each domain, shape (n,) each."""
    shortest, longest = np.empty(len(vertices.kind)), np.empty(len(vertices.kind))
    for rows, kind, cells in _by_kind(vertices):
        a, b = np.array(EDGES[kind]).T
        gap = vertices.position[cells[:, b]] - vertices.position[cells[:, a]]
        length = np.sqrt((gap**2).sum(axis=2))
        shortest[rows], longest[rows] = length.min(axis=1), length.max(axis=1)
    return shortest, longest


def altitudes(vertices: Vertices) -> np.ndarray:
    """Return the smallest height [m] of each domain: its volume over its largest face, shape (n,).

    A wave crosses a skewed domain along its height, which is shorter than any of its edges.
    """
    result = np.empty(len(vertices.kind))
    for rows, kind, cells in _by_kind(vertices):
        domains = Domains(vertices.position, cells, kind, checked=True)
        largest = np.zeros(len(rows))
        for face in FACES[kind]:
            largest = np.maximum(largest, _size(vertices.position[cells[:, face]]))
        # A simplex has a third or half of the volume of the prism over its face.
        fold = kind.dim if kind in (Kind.TRI, Kind.TET) else 1
        result[rows] = fold * np.abs(domains.volumes()) / largest
    return result


def _size(x: np.ndarray) -> np.ndarray:
    """Lengths or areas of faces with corners x (m, k, 3) [m]; 1 for points."""
    if x.shape[1] == 1:
        return np.ones(len(x))
    if x.shape[1] == 2:
        return np.sqrt(((x[:, 1] - x[:, 0]) ** 2).sum(axis=1))
    across = np.cross(x[:, 2] - x[:, 0], x[:, -1] - x[:, 1] if x.shape[1] == 4 else x[:, 1] - x[:, 0])
    return 0.5 * np.sqrt((across**2).sum(axis=1))


def aspect_ratios(vertices: Vertices) -> np.ndarray:
    """Return the longest over the shortest edge of each domain, shape (n,)."""
    shortest, longest = edge_lengths(vertices)
    return longest / shortest


def warps(vertices: Vertices) -> np.ndarray:
    """Return how far corners lie from an affine image of their initial domain, shape (n,).

    The largest distance in each domain over its shortest edge. For quadrilaterals this is the
    hourglass mode alone: their F by corners follows the diagonals, as F by rates does, so that the two agree
    to round-off however far the corners drift.
    """
    R, G = vertices.initial_weights()[..., 0], vertices.initial_weights()[..., 1:]
    inside = (np.arange(R.shape[1]) < vertices.count[:, None])[..., None]
    x, X = vertices.position[vertices.connectivity], vertices.position0[vertices.connectivity]
    x = x - np.einsum("nc,nca->na", R, x * inside)[:, None]
    X = X - np.einsum("nc,nca->na", R, X * inside)[:, None]
    F = np.einsum("nca,ncb->nab", x * inside, G)
    gap = (x - np.einsum("nab,ncb->nca", F, X)) * inside
    return np.sqrt((gap**2).sum(axis=2).max(axis=1)) / edge_lengths(vertices)[0]

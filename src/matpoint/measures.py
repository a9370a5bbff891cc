"""What domains measure: volume, centroid, edges; in blocks of rows, so that nothing large is made.

The multilinear map of a domain is written in its modes: x(xi) = sum over subsets S of the axes of
a_S prod_(k in S) xi_k. Sums and differences of opposite corners give them, and a derivative along an
axis is again such a sum, with one axis less.
"""

from __future__ import annotations

from collections.abc import Callable
from enum import IntEnum

import numpy as np

#: Rows that are looked at in one go: their corners fit into a processor's cache.
BLOCK = 8192


class Kind(IntEnum):
    """The shape of a domain; corners are in VTK's order."""

    LINE = 0
    QUAD = 1
    HEX = 2
    TRI = 3
    TET = 4

    @property
    def dim(self) -> int:
        """The dimension of the shape."""
        return (1, 2, 3, 2, 3)[self]

    @property
    def corners(self) -> int:
        """The number of corners."""
        return (2, 4, 8, 3, 4)[self]

    @property
    def simplex(self) -> bool:
        """Whether it is a triangle or tetrahedron."""
        return self in (Kind.TRI, Kind.TET)


#: A measure: corners (m, corners, 3) [m] and their shape to an array with a row for each domain.
Measure = Callable[[np.ndarray, Kind], np.ndarray]

_GAUSS = 1.0 / np.sqrt(3.0)  # two points an axis are exact for volumes and centroids
# Place of each VTK corner in the lexicographic order, the first axis slowest.
_PLACE = {Kind.LINE: (0, 1), Kind.QUAD: (0, 2, 3, 1), Kind.HEX: (0, 4, 6, 2, 1, 5, 7, 3)}


def measured(
    measure: Measure, vertices: np.ndarray, cells: np.ndarray, kind: Kind | np.ndarray, shape: tuple[int, ...]
) -> np.ndarray:
    """Return a measure of all domains, block by block, shape (n, *shape).

    Parameters
    ----------
    measure
        One of this module's functions.
    vertices, cells
        Positions (nv, 3) [m] and the corners of each domain (n, K), padded with anything.
    kind
        One shape for all domains, or the shape of each, (n,).
    shape
        That of one domain's result.
    """
    result = np.empty((len(cells), *shape))
    for start in range(0, len(cells), BLOCK):
        some = slice(start, start + BLOCK)
        if isinstance(kind, Kind):
            result[some] = measure(vertices[cells[some]], kind)
            continue
        for one in Kind:
            rows = start + np.flatnonzero(kind[some] == one)
            if len(rows):
                result[rows] = measure(vertices[cells[rows, : one.corners]], one)
    return result


def _modes(x: np.ndarray, kind: Kind) -> np.ndarray:
    """The modes of multilinear maps with corners x (m, corners, c): shape (2,) * d + (c, m)."""
    order = np.argsort(_PLACE[kind])
    modes = np.ascontiguousarray(x[:, order].transpose(1, 2, 0)).reshape(*(2,) * kind.dim, x.shape[2], len(x))
    for axis in range(kind.dim):
        a, b = np.moveaxis(modes, axis, 0)
        modes = np.stack([a + b, b - a], axis=axis)
    modes *= 0.5**kind.dim
    return modes


def _spread(modes: np.ndarray, axes: range, at: float) -> np.ndarray:
    """Evaluate modes at -at and at along each of their leading axes."""
    for axis in axes:
        a, b = np.moveaxis(modes, axis, 0)
        modes = np.stack([a - at * b, a + at * b], axis=axis)
    return modes


def _jacobians(modes: np.ndarray, d: int, at: float) -> np.ndarray:
    """Jacobians det dx/dxi at the points -at, at of all axes: shape (2,) * d + (m,)."""
    columns = [
        np.expand_dims(_spread(np.take(modes[..., :d, :], 1, axis=k), range(d - 1), at), k) for k in range(d)
    ]
    det = _determinant([[column[..., k, :] for k in range(d)] for column in columns])
    return np.broadcast_to(det, (*(2,) * d, modes.shape[-1]))


def _determinant(a: list[list[np.ndarray]]) -> np.ndarray:
    """The determinant of 1 to 3 vectors, each a list of components."""
    if len(a) == 1:
        return a[0][0]
    if len(a) == 2:
        return a[0][0] * a[1][1] - a[0][1] * a[1][0]
    u, v, w = a
    return (
        u[0] * (v[1] * w[2] - v[2] * w[1])
        + u[1] * (v[2] * w[0] - v[0] * w[2])
        + u[2] * (v[0] * w[1] - v[1] * w[0])
    )


def _along(x: np.ndarray, kind: Kind) -> list[list[np.ndarray]]:
    """Components of the edges of simplices that leave their first corner."""
    return [[x[:, a, k] - x[:, 0, k] for k in range(kind.dim)] for a in range(1, kind.corners)]


def volumes(x: np.ndarray, kind: Kind) -> np.ndarray:
    """Return the volumes [m^3] (unit thickness on missing axes), shape (m,)."""
    if kind.simplex:
        return _determinant(_along(x, kind)) / (2.0 if kind == Kind.TRI else 6.0)
    det = _jacobians(_modes(x, kind), kind.dim, _GAUSS)
    return det.reshape(-1, len(x)).sum(axis=0)


def centroids(x: np.ndarray, kind: Kind) -> np.ndarray:
    """Return the centroids (1/V) int x dV [m], shape (m, 3)."""
    return volumes_and_centroids(x, kind)[:, 1:]


def volumes_and_centroids(x: np.ndarray, kind: Kind) -> np.ndarray:
    """Return volume [m^3] and centroid (3) [m] of each domain, shape (m, 4)."""
    result = np.empty((len(x), 4))
    if kind.simplex:
        result[:, 0], result[:, 1:] = volumes(x, kind), x.mean(axis=1)
        return result
    d, modes = kind.dim, _modes(x, kind)
    det = _jacobians(modes, d, _GAUSS).reshape(-1, len(x))
    points = _spread(modes, range(d), _GAUSS).reshape(-1, 3, len(x))
    result[:, 0] = det.sum(axis=0)
    result[:, 1:] = ((det[:, None] * points).sum(axis=0) / result[:, 0]).T
    return result


def corner_jacobians(x: np.ndarray, kind: Kind) -> np.ndarray:
    """Return the Jacobian at each corner times the reference volume [m^d], shape (m, corners)."""
    if kind.simplex:
        return np.repeat(volumes(x, kind)[:, None], kind.corners, axis=1)
    det = _jacobians(_modes(x, kind), kind.dim, 1.0)
    return 2.0**kind.dim * det.reshape(-1, len(x))[list(_PLACE[kind])].T


def edge_vectors(x: np.ndarray, kind: Kind) -> np.ndarray:
    """Return half edge vectors of the parallelepiped that stands for each domain.

    Rows r_k [m], shape (m, 3, 3): means over opposite edges, scaled so that the volume
    2^d |det r| is the domain's; missing axes have half a unit vector. Simplices take a
    parallelepiped along their first corner's edges.
    """
    d = kind.dim
    edges = np.zeros((len(x), 3, 3))
    edges[:] = 0.5 * np.eye(3)
    if kind.simplex:
        edges[:, :d, :d] = 0.5 * np.array(_along(x, kind)).transpose(2, 0, 1)
    else:
        modes = _modes(x, kind)
        for k in range(d):
            edges[:, k] = modes[tuple(int(k == a) for a in range(d))].T
    det = _determinant([[edges[:, k, a] for a in range(d)] for k in range(d)])
    edges[:, :d] *= ((volumes(x, kind) / (2.0**d * det)) ** (1.0 / d))[:, None, None]
    return edges


def half_lengths(x: np.ndarray, kind: Kind) -> np.ndarray:
    """Return half-lengths [m] of the box that stands for each domain, shape (m, 3).

    The box has the domain's volume; its aspect is that of the box around the mean edge
    vectors. Missing axes have 1/2.
    """
    half = np.abs(edge_vectors(x, kind)).sum(axis=1)
    half[:, kind.dim :] = 0.5
    scale = (volumes(x, kind) / (8.0 * half.prod(axis=1))) ** (1.0 / kind.dim)
    half[:, : kind.dim] *= scale[:, None]
    return half

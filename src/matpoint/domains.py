"""Particle domains: lines, quadrilaterals, hexahedra, triangles, tetrahedra with shared corners."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import IntEnum

import numpy as np

from matpoint.errors import InputError


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


_SIGNS = np.array(
    [[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1], [-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]],
    dtype=float,
)
# Reference derivatives of the multilinear shapes need the signs of the active axes only.
_TENSOR = {Kind.LINE: 1, Kind.QUAD: 2, Kind.HEX: 3}


@dataclass(frozen=True, eq=False)
class Domains:
    """Domains of the particles of one body; a particle each.

    Parameters
    ----------
    vertices
        Corner positions [m], shape (nv, 3); coordinates on missing axes are 0.
    cells
        Corners of each domain, shape (n, corners), in VTK's order.
    kind
        The shape of all of them, or its name in lower case.
    checked
        True if the caller vouches for the mesh (filling does).
    sets
        Boundary sets: name -> faces as rows of vertices, shape (m, corners of a face), in any
        orientation. Conditions and loads find them by :class:`matpoint.Surface`.

    Raises
    ------
    InputError
        If vertices are not numbers, a cell names a vertex that is not there or one twice, a vertex
        belongs to no cell, or a domain is inverted or has no volume.
    """

    vertices: np.ndarray
    cells: np.ndarray
    kind: Kind
    checked: bool = False
    sets: Mapping[str, np.ndarray] = field(default_factory=dict)

    def __post_init__(self) -> None:
        try:
            vertices = np.ascontiguousarray(self.vertices, dtype=float)
            cells = np.ascontiguousarray(self.cells)
            kind = Kind[self.kind.upper()] if isinstance(self.kind, str) else Kind(self.kind)
            sets = {str(name): np.array(rows) for name, rows in self.sets.items()}
        except KeyError:
            names = ", ".join(k.name.lower() for k in Kind)
            raise InputError(f"mesh: kind = {self.kind!r}; {names} are allowed") from None
        except (TypeError, ValueError, AttributeError) as error:
            raise InputError(f"mesh: vertices and cells must be arrays of numbers ({error})") from None
        object.__setattr__(self, "vertices", vertices)
        object.__setattr__(self, "cells", cells)
        object.__setattr__(self, "kind", kind)
        object.__setattr__(self, "sets", sets)
        if not self.checked:
            self.check()

    @property
    def dim(self) -> int:
        """The dimension: 1, 2 or 3."""
        return self.kind.dim

    @property
    def n(self) -> int:
        """The number of domains."""
        return len(self.cells)

    def check(self) -> None:
        """Raise InputError if the mesh can't carry particles."""
        x, cells, corners = self.vertices, self.cells, self.kind.corners
        if x.ndim != 2 or x.shape[1] != 3:
            raise InputError(f"mesh: vertices have shape {x.shape}; (number, 3) is needed")
        if cells.ndim != 2 or cells.shape[1] != corners or not np.issubdtype(cells.dtype, np.integer):
            raise InputError(
                f"mesh: cells have shape {cells.shape} and type {cells.dtype}; {self.kind.name.lower()}"
                f" cells are whole numbers of shape (number, {corners})"
            )
        if len(cells) == 0:
            raise InputError("mesh: it has no cells")
        bad = np.flatnonzero(~np.isfinite(x).all(axis=1))
        if len(bad):
            raise InputError(f"mesh: vertex {bad[0]} = {x[bad[0]].tolist()} is not finite")
        if np.any(x[:, self.dim :] != 0.0):
            raise InputError(f"mesh: a {self.dim}-D mesh must have zero coordinates on the missing axes")
        bad = np.flatnonzero(((cells < 0) | (cells >= len(x))).any(axis=1))
        if len(bad):
            raise InputError(
                f"mesh: cell {bad[0]} names vertices {cells[bad[0]].tolist()}; there are 0 to {len(x) - 1}"
            )
        ordered = np.sort(cells, axis=1)
        bad = np.flatnonzero((ordered[:, 1:] == ordered[:, :-1]).any(axis=1))
        if len(bad):
            raise InputError(f"mesh: cell {bad[0]} names a vertex twice: {cells[bad[0]].tolist()}")
        _, first, count = np.unique(ordered, axis=0, return_index=True, return_counts=True)
        if (count > 1).any():
            twin = ordered[first[count > 1].min()].tolist()
            raise InputError(f"mesh: two cells have the same corners, {twin}; keep one")
        used = np.zeros(len(x), dtype=bool)
        used[cells] = True
        if not used.all():
            raise InputError(f"mesh: vertex {np.flatnonzero(~used)[0]} belongs to no cell (dangling)")
        smallest = self.corner_jacobians().min(axis=1)
        size = np.abs(self.volumes())
        bad = np.flatnonzero(~(smallest > 1e-12 * size))
        if len(bad):
            raise InputError(
                f"mesh: cell {bad[0]} is inverted, tangled or has no volume"
                f" (smallest corner Jacobian {smallest[bad[0]]:.3g}); number its corners counter-clockwise"
            )

    def _jacobians(self, local: np.ndarray) -> np.ndarray:
        """dx/dxi of the multilinear map at local points (g, d): shape (n, g, d, d)."""
        d = _TENSOR[self.kind]
        x = self.vertices[self.cells][:, :, :d]
        signs = _SIGNS[: 2**d, :d]
        factor = 0.5 * (1.0 + signs[None] * local[:, None])  # (g, corner, d)
        slope = np.stack(
            [0.5 * signs[:, k] * np.delete(factor, k, axis=2).prod(axis=2) for k in range(d)], axis=2
        )
        return np.einsum("ncx,gck->ngxk", x, slope)

    def _simplex_edges(self) -> np.ndarray:
        x = self.vertices[self.cells][:, :, : self.dim]
        return np.swapaxes(x[:, 1:] - x[:, :1], 1, 2)

    def corner_jacobians(self) -> np.ndarray:
        """Return the Jacobian at each corner times the reference volume [m^d], shape (n, corners)."""
        if self.kind in _TENSOR:
            d = self.dim
            return 2.0**d * np.linalg.det(self._jacobians(_SIGNS[: 2**d, :d]))
        volume = self.volumes()
        return np.repeat(volume[:, None], self.kind.corners, axis=1)

    def _gauss(self) -> tuple[np.ndarray, np.ndarray]:
        """Local points and det J there: two Gauss points an axis are exact for V and centroids."""
        local = _SIGNS[: 2**self.dim, : self.dim] / np.sqrt(3.0)
        return local, np.linalg.det(self._jacobians(local))

    def volumes(self) -> np.ndarray:
        """Return the volumes [m^3] (unit thickness on missing axes), shape (n,)."""
        if self.kind in _TENSOR:
            return self._gauss()[1].sum(axis=1)
        return np.linalg.det(self._simplex_edges()) / (2.0 if self.kind == Kind.TRI else 6.0)

    def centroids(self) -> np.ndarray:
        """Return the centroids (1/V) int x dV [m], shape (n, 3)."""
        x = self.vertices[self.cells]
        if self.kind not in _TENSOR:
            return x.mean(axis=1)
        local, det = self._gauss()
        signs = _SIGNS[: 2**self.dim, : self.dim]
        shape = (0.5 * (1.0 + signs[None] * local[:, None])).prod(axis=2)  # (g, corner)
        return np.einsum("ng,gc,ncx->nx", det, shape, x) / det.sum(axis=1)[:, None]

    def edge_vectors(self) -> np.ndarray:
        """Return half edge vectors of the parallelepiped that stands for each domain.

        Rows r_k [m], shape (n, 3, 3): means over opposite edges, scaled so that the volume
        2^d |det r| is the domain's; missing axes have half a unit vector. Simplices take a
        parallelepiped along their first corner's edges.
        """
        d = self.dim
        edges = np.zeros((self.n, 3, 3))
        edges[:] = 0.5 * np.eye(3)
        if self.kind in _TENSOR:
            x = self.vertices[self.cells]
            signs = _SIGNS[: 2**d, :d]
            edges[:, :d] = np.einsum("ck,ncx->nkx", signs, x) / 2**d
        else:
            edges[:, :d, :d] = 0.5 * np.swapaxes(self._simplex_edges(), 1, 2)
        volume = 8.0 * np.linalg.det(edges)
        edges[:, :d] *= ((self.volumes() / volume) ** (1.0 / d))[:, None, None]
        return edges

    def half_lengths(self) -> np.ndarray:
        """Return half-lengths [m] of the box that stands for each domain, shape (n, 3).

        The box has the domain's volume; its aspect is that of the box around the mean edge
        vectors. Missing axes have 1/2.
        """
        half = np.abs(self.edge_vectors()).sum(axis=1)
        half[:, self.dim :] = 0.5
        scale = (self.volumes() / (8.0 * half.prod(axis=1))) ** (1.0 / self.dim)
        half[:, : self.dim] *= scale[:, None]
        return half

"""Particle domains: lines, quadrilaterals, hexahedra, triangles, tetrahedra with shared corners."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from matpoint import measures
from matpoint.errors import InputError
from matpoint.measures import Kind


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
        _check_corners(cells)
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

    def corner_jacobians(self) -> np.ndarray:
        """Return the Jacobian at each corner times the reference volume [m^d], shape (n, corners)."""
        return self._measured(measures.corner_jacobians, (self.kind.corners,))

    def volumes(self) -> np.ndarray:
        """Return the volumes [m^3] (unit thickness on missing axes), shape (n,)."""
        return self._measured(measures.volumes)

    def centroids(self) -> np.ndarray:
        """Return the centroids (1/V) int x dV [m], shape (n, 3)."""
        return self._measured(measures.centroids, (3,))

    def edge_vectors(self) -> np.ndarray:
        """Return half edge vectors [m] of the parallelepipeds that stand for them, as rows, (n, 3, 3)."""
        return self._measured(measures.edge_vectors, (3, 3))

    def half_lengths(self) -> np.ndarray:
        """Return half-lengths [m] of the boxes that stand for them, shape (n, 3)."""
        return self._measured(measures.half_lengths, (3,))

    def _measured(self, measure: measures.Measure, shape: tuple[int, ...] = ()) -> np.ndarray:
        return measures.measured(measure, self.vertices, self.cells, self.kind, shape)


def _check_corners(cells: np.ndarray) -> None:
    """Refuse a cell with one corner twice, and two cells with the same corners."""
    # Cells with the same corners have the same key; those with one key are compared corner by corner.
    key = np.zeros(len(cells), dtype=np.uint64)
    weight = np.uint64(0x9E3779B97F4A7C15)
    for start in range(0, len(cells), measures.BLOCK):
        some = slice(start, start + measures.BLOCK)
        ordered = np.sort(cells[some], axis=1)
        bad = np.flatnonzero((ordered[:, 1:] == ordered[:, :-1]).any(axis=1))
        if len(bad):
            row = start + bad[0]
            raise InputError(f"mesh: cell {row} names a vertex twice: {cells[row].tolist()}")
        for column in ordered.T.astype(np.uint64):
            key[some] = (key[some] ^ column) * weight
    order = np.argsort(key, kind="stable")
    alike = np.flatnonzero(key[order[1:]] == key[order[:-1]])
    rows = np.unique(np.concatenate([order[alike], order[alike + 1]]))
    ordered = np.sort(cells[rows], axis=1)
    _, first, count = np.unique(ordered, axis=0, return_index=True, return_counts=True)
    if (count > 1).any():
        twin = ordered[first[count > 1].min()].tolist()
        raise InputError(f"mesh: two cells have the same corners, {twin}; keep one")

"""Solids by finite-strain finite elements: meshes and quadrature of scikit-fem, sparse operators.

A step of an explicit run is then a few sparse products and elementwise operations, with no loop
over elements. Runs are in :mod:`matpoint.reference.explicit`, static solutions in
:mod:`matpoint.reference.static`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from matpoint.errors import InputError
from matpoint.reference import neo_hookean
from matpoint.reference.elements import CORNERS, gradients

if TYPE_CHECKING:
    from scipy.sparse import csc_array


class Solid:
    """A neo-Hookean solid on a mesh of one kind of cell, in plane strain or in three dimensions.

    Parameters
    ----------
    vertices
        Initial positions [m], shape (nv, 3), or (nv, 2) for quads and triangles.
    cells
        Corners of each cell, shape (n, corners), in VTK's order.
    kind
        'quad', 'tri', 'hex' or 'tet'. Quads and hexahedra take two Gauss points an axis.
    lame, shear, density
        Lamé parameters [Pa] and initial density [kg/m^3] of each cell, shape (n,), or one number.

    Attributes
    ----------
    dim : int
        2 or 3.
    mass : ndarray, shape (nv,)
        Row sums of the consistent mass [kg] (unit thickness in plane strain).
    volumes : ndarray, shape (n,)
        Initial volumes of the cells [m^3].

    Raises
    ------
    InputError
        If the kind is unknown, shapes or parameters are wrong, or a cell is inverted.
    """

    def __init__(
        self,
        vertices: np.ndarray,
        cells: np.ndarray,
        kind: str,
        lame: np.ndarray | float,
        shear: np.ndarray | float,
        density: np.ndarray | float,
    ) -> None:
        from scipy.sparse import csr_array  # noqa: PLC0415 (loaded when used)

        if kind not in CORNERS:
            raise InputError(f"solid: kind = {kind!r} is unknown; choose from {', '.join(CORNERS)}")
        self.kind, self.dim = kind, 2 if kind in ("quad", "tri") else 3
        self.cells = np.asarray(cells)
        if self.cells.ndim != 2 or self.cells.shape[1] != CORNERS[kind] or len(self.cells) == 0:
            raise InputError(
                f"solid: cells have shape {self.cells.shape}; ({kind}s, {CORNERS[kind]}) is needed"
            )
        self.vertices = np.array(vertices, dtype=float)[:, : self.dim]
        n, nv = len(self.cells), len(self.vertices)
        shapes, self._slopes, self._weights = gradients(self.vertices, self.cells, kind)
        points = self._slopes.shape[1]
        self.volumes = self._weights.sum(axis=1)
        lam, mu, rho = (_per_cell(name, x, n) for name, x in zip(_NAMES, (lame, shear, density), strict=True))
        if not (mu > 0).all() or not (rho > 0).all() or not (3 * lam + 2 * mu > 0).all():
            raise InputError("solid: shear, density and 3 lame + 2 shear must be positive in every cell")
        self._lame, self._shear = np.repeat(lam, points), np.repeat(mu, points)
        share = np.einsum("eq,qa->ea", rho[:, None] * self._weights, shapes)
        self.mass = np.bincount(self.cells.ravel(), share.ravel(), nv)
        if not (self.mass > 0).all():
            raise InputError(f"solid: vertex {np.argmin(self.mass)} belongs to no cell (dangling)")
        q = n * points
        rows = np.repeat(np.arange(q), CORNERS[kind])
        columns = np.repeat(self.cells, points, axis=0).ravel()
        # Row k q + point: one product gives all derivatives of one component, each contiguous.
        rows = (np.arange(self.dim)[:, None] * q + rows).ravel()
        values = np.moveaxis(self._slopes, 3, 0).ravel()
        self._G = csr_array((values, (rows, np.tile(columns, self.dim))), shape=(self.dim * q, nv))
        weights = np.tile(self._weights.ravel(), self.dim)
        weighted = (values * weights[rows], (np.tile(columns, self.dim), rows))
        self._divergence = csr_array(weighted, shape=(nv, self.dim * q))

    def deformation(self, u: np.ndarray) -> np.ndarray:
        """Return F at the quadrature points, shape (d, d, q), of displacements [m], shape (d, nv)."""
        F = np.empty((self.dim, self.dim, len(self._lame)))
        for i in range(self.dim):
            F[i] = (self._G @ u[i]).reshape(self.dim, -1)
            F[i, i] += 1.0
        return F

    def forces(self, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return internal nodal forces [N], shape (d, nv), and J at the quadrature points.

        Displacements [m] come one component after the other, shape (d, nv), here and below.
        """
        P, J = neo_hookean.piola(self.deformation(u), self._lame, self._shear)
        return np.stack([self._divergence @ P[i].ravel() for i in range(self.dim)]), J

    def stress(self, u: np.ndarray) -> np.ndarray:
        """Return Cauchy stresses [Pa] of the cells, means over their current volumes, shape (n, 6).

        Components are xx, yy, zz, xy, yz, xz; displacements have shape (d, nv).
        """
        F, weights = self.deformation(u), self._weights
        tau = neo_hookean.kirchhoff(F, self._lame, self._shear).reshape(6, *weights.shape)
        volume = (weights * neo_hookean.cofactor(F)[0].reshape(weights.shape)).sum(axis=1)
        return ((tau * weights).sum(axis=2) / volume).T

    def strain_energy(self, u: np.ndarray) -> float:
        """Return the strain energy [J] of displacements of shape (d, nv)."""
        density = neo_hookean.energy(self.deformation(u), self._lame, self._shear)
        return float(density @ self._weights.ravel())

    def stiffness(self, u: np.ndarray) -> csc_array:
        """Return the consistent tangent [N/m]; component i of node a is unknown a d + i."""
        from scipy.sparse import coo_array  # noqa: PLC0415

        A = neo_hookean.tangent(self.deformation(u), self._lame, self._shear)
        n, points = self._weights.shape
        d, B = self.dim, self._slopes
        A = A.reshape(d, d, d, d, n, points)
        blocks = np.empty((n, CORNERS[self.kind], d, CORNERS[self.kind], d))
        for i in range(d):
            for j in range(d):
                flow = np.einsum("klnq,nq,nqbl->nqkb", A[i, :, j], self._weights, B)
                blocks[:, :, i, :, j] = np.einsum("nqak,nqkb->nab", B, flow)
        dofs = (self.cells[:, :, None] * d + np.arange(d)).reshape(n, -1)
        rows, columns = np.repeat(dofs, dofs.shape[1], axis=1).ravel(), np.tile(dofs, dofs.shape[1]).ravel()
        size = d * len(self.vertices)
        return coo_array((blocks.ravel(), (rows, columns)), shape=(size, size)).tocsc()

    def stable_step(self) -> float:
        """Return the largest stable explicit step [s] about the initial state: 2 over the top frequency."""
        from scipy.sparse import diags_array  # noqa: PLC0415
        from scipy.sparse.linalg import eigsh  # noqa: PLC0415

        root = diags_array(np.repeat(self.mass, self.dim) ** -0.5)
        scaled = root @ self.stiffness(np.zeros((self.dim, len(self.vertices)))) @ root
        start = np.random.default_rng(0).standard_normal(scaled.shape[0])  # the same in every run
        top = eigsh(scaled, k=1, which="LA", v0=start, return_eigenvectors=False)
        return float(2.0 / np.sqrt(top[0]))


_NAMES = ("lame", "shear", "density")


def _per_cell(name: str, given: np.ndarray | float, n: int) -> np.ndarray:
    """Return a parameter as one finite number a cell."""
    try:
        values = np.broadcast_to(np.asarray(given, dtype=float), (n,))
    except (TypeError, ValueError):
        raise InputError(f"solid: {name} has shape {np.shape(given)}; ({n},) or a number is needed") from None
    if not np.isfinite(values).all():
        raise InputError(f"solid: {name} of cell {np.flatnonzero(~np.isfinite(values))[0]} is not finite")
    return values

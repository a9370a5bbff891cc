"""Shape functions and their gradients at quadrature points, by scikit-fem."""

from __future__ import annotations

import numpy as np

from matpoint.errors import InputError

CORNERS = {"quad": 4, "tri": 3, "hex": 8, "tet": 4}
# Corner of VTK's hexahedron that stands at each place of scikit-fem's.
_HEX_ORDER = [6, 2, 5, 7, 1, 3, 4, 0]


def gradients(
    vertices: np.ndarray, cells: np.ndarray, kind: str
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return shapes, initial gradients and weights of linear or multilinear elements.

    Parameters
    ----------
    vertices
        Positions [m], shape (nv, d).
    cells
        Shape (n, corners), in VTK's order.
    kind
        'quad' or 'hex' (two Gauss points an axis), 'tri' or 'tet' (one point).

    Returns
    -------
    shapes : ndarray, shape (q, corners)
        N_a at the points, the same in every cell.
    slopes : ndarray, shape (n, q, corners, d)
        dN_a/dX [1/m].
    weights : ndarray, shape (n, q)
        Quadrature weights times the Jacobian [m^d].

    Raises
    ------
    InputError
        If vertices or cells are not usable numbers, or a cell is inverted or without volume.
    """
    import skfem  # noqa: PLC0415 (loaded when used)

    if not np.isfinite(vertices).all():
        raise InputError("solid: vertices must be finite")
    if not np.issubdtype(cells.dtype, np.integer) or cells.min() < 0 or cells.max() >= len(vertices):
        raise InputError(f"solid: cells must name vertices by whole numbers from 0 to {len(vertices) - 1}")
    d = vertices.shape[1]
    order = _HEX_ORDER if kind == "hex" else list(range(CORNERS[kind]))
    element, mesh = {
        "quad": (skfem.ElementQuad1(), skfem.MeshQuad1),
        "tri": (skfem.ElementTriP1(), skfem.MeshTri1),
        "hex": (skfem.ElementHex1(), skfem.MeshHex1),
        "tet": (skfem.ElementTetP1(), skfem.MeshTet1),
    }[kind]
    # A corner belongs to one cell here: scikit-fem would sort shared ones, and check their facets.
    n, corners = cells.shape
    apart = np.ascontiguousarray(vertices[cells[:, order].ravel()].T)
    own = np.ascontiguousarray(np.arange(n * corners).reshape(n, corners).T)
    if kind in ("tri", "tet"):
        quadrature = (np.full((d, 1), 1.0 / (d + 1)), np.array([1.0 / (2 if d == 2 else 6)]))
        basis = skfem.Basis(mesh(apart, own), element, quadrature=quadrature)
    else:
        basis = skfem.Basis(mesh(apart, own), element, intorder=3)
    volume = basis.mapping.detDF(basis.X)
    if not (volume > 0).all():
        bad = int(np.argmin(volume.min(axis=1)))
        raise InputError(f"solid: cell {bad} is inverted or has no volume; corners are in VTK's order")
    shapes, slopes = np.empty((len(basis.W), corners)), np.empty((n, len(basis.W), corners, d))
    for place, corner in enumerate(order):
        field = basis.basis[place][0]
        shapes[:, corner] = np.broadcast_to(field, (n, len(basis.W)))[0]
        slopes[:, :, corner] = np.moveaxis(np.asarray(field.grad), 0, -1)
    return shapes, slopes, basis.dx

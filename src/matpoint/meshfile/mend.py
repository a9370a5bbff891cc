"""Mending cells that come from elsewhere: doubled vertices, orientation, cells without volume."""

from __future__ import annotations

import numpy as np

from matpoint.domains import Domains, Kind
from matpoint.errors import InputError

# The order of corners that mirrors a cell and keeps its edges and faces.
_MIRROR = {
    Kind.LINE: (1, 0),
    Kind.TRI: (0, 2, 1),
    Kind.QUAD: (0, 3, 2, 1),
    Kind.TET: (0, 2, 1, 3),
    Kind.HEX: (0, 3, 2, 1, 4, 7, 6, 5),
}


def flatten(points: np.ndarray, dim: int, hair: float, where: str) -> np.ndarray:
    """Return points (n, 3) [m] with zeros on the missing axes, where they must be constant.

    Raises
    ------
    InputError
        If they vary there by more than ``hair`` [m].
    """
    for k in range(dim, 3):
        low, high = float(points[:, k].min()), float(points[:, k].max())
        if high - low > hair:
            plane = "parallel to the x-y plane" if dim == 2 else "along the x axis"
            raise InputError(
                f"{where}: its {dim}-D cells must lie {plane}; {'xyz'[k]} goes from {low:g} to {high:g}"
            )
    flat = points.copy()
    flat[:, dim:] = 0.0
    return flat


def orient(points: np.ndarray, cells: np.ndarray, kind: Kind) -> np.ndarray:
    """Return cells (n, corners) of positive volume: clockwise and left-handed ones are mirrored."""
    turned = Domains(points, cells, kind, checked=True).volumes() < 0.0
    mended = cells.copy()
    mended[turned] = cells[turned][:, _MIRROR[kind]]
    return mended


def refuse_bad_cells(
    points: np.ndarray, cells: np.ndarray, kind: Kind, numbers: np.ndarray, where: str
) -> None:
    """Refuse cells that are tangled, have no volume, or stand twice.

    Parameters
    ----------
    points
        [m], shape (nv, 3).
    cells
        Oriented, shape (n, corners).
    kind
        Their shape.
    numbers
        Their numbers for messages, shape (n,).
    where
        What messages begin with.

    Raises
    ------
    InputError
        With the number of the cell and its vertices.
    """
    what = kind.name.lower()
    domains = Domains(points, cells, kind, checked=True)
    size = np.ptp(points[cells], axis=1).max(axis=1) ** kind.dim
    bad = np.flatnonzero(~(domains.corner_jacobians().min(axis=1) > 1e-12 * size))
    if len(bad):
        raise InputError(
            f"{where}: {what} {numbers[bad[0]]} (from 0) is tangled, not convex or has no volume; its"
            f" vertices are {corners_text(points[cells[bad[0]]], kind.dim)}"
        )
    ordered = np.sort(cells, axis=1)
    _, first, inverse = np.unique(ordered, axis=0, return_index=True, return_inverse=True)
    twin = first[inverse.ravel()]
    double = np.flatnonzero(twin != np.arange(len(cells)))
    if len(double):
        raise InputError(
            f"{where}: {what} {numbers[double[0]]} and {what} {numbers[twin[double[0]]]} (from 0) are the"
            " same; a cell must stand once, in one physical group"
        )


def corners_text(x: np.ndarray, dim: int) -> str:
    """Return positions (n, 3) [m] as text."""
    return ", ".join(f"({', '.join(f'{c:g}' for c in row[:dim])})" for row in x.tolist())

"""Filling a region with particle domains on the grid's lattice."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from matpoint.domains import Domains, Kind
from matpoint.errors import InputError
from matpoint.regions import Region

_KINDS = {1: Kind.LINE, 2: Kind.QUAD, 3: Kind.HEX}
_STEPS = {
    1: ((0,), (1,)),
    2: ((0, 0), (1, 0), (1, 1), (0, 1)),
    3: ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)),
}


def lattice_domains(index: np.ndarray, origin: np.ndarray, spacing: np.ndarray) -> Domains:
    """Return the boxes of a lattice as domains with unique corners.

    Parameters
    ----------
    index
        Lattice numbers of the boxes, shape (n, dim).
    origin, spacing
        Where box 0 begins [m] and how long a box is [m], shape (dim,).
    """
    dim = index.shape[1]
    low = index.min(axis=0)
    counts = index.max(axis=0) - low + 2
    corners = index[:, None, :] - low + np.array(_STEPS[dim])[None]
    number = np.ravel_multi_index(tuple(np.moveaxis(corners, 2, 0)), tuple(counts))
    unique, cells = np.unique(number, return_inverse=True)
    vertices = np.zeros((len(unique), 3))
    lattice = np.stack(np.unravel_index(unique, tuple(counts)), axis=1) + low
    vertices[:, :dim] = origin + spacing * lattice
    return Domains(vertices, cells.reshape(number.shape), _KINDS[dim], checked=True)


def fill(region: Region, origin: Sequence[float], spacing: Sequence[float], dim: int) -> Domains:
    """Return the lattice boxes whose centre lies in a region.

    Parameters
    ----------
    region
        It must be bounded.
    origin, spacing
        A corner of the lattice [m] and the length of its boxes [m], one number per axis.
    dim
        1, 2 or 3.

    Raises
    ------
    InputError
        If the region is not bounded, or no centre lies in it.
    """
    start, step = np.array(origin[:dim], dtype=float), np.array(spacing[:dim], dtype=float)
    low, high = (np.asarray(b, dtype=float)[:dim] for b in region.bounds())
    if not (np.isfinite(low).all() and np.isfinite(high).all()):
        raise InputError("the region is not bounded, so it can't be filled; intersect it with a box")
    first = np.floor((low - start) / step - 1e-6).astype(np.int64)
    last = np.ceil((high - start) / step + 1e-6).astype(np.int64)
    axes = [np.arange(a, max(b, a + 1)) for a, b in zip(first, last, strict=True)]
    index = np.stack([m.ravel() for m in np.meshgrid(*axes, indexing="ij")], axis=1)
    centres = np.zeros((len(index), 3))
    centres[:, :dim] = start + step * (index + 0.5)
    inside = np.asarray(region.contains(centres), dtype=bool)
    if not inside.any():
        raise InputError(
            f"no particles: no point of the lattice of spacing {step.tolist()} m lies in its region"
        )
    return lattice_domains(index[inside], start, step)

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
_POINTS = 1 << 16  # lattice points that a region is asked about in one go, or one plane of them


def lattice_domains(
    inside: np.ndarray, first: np.ndarray, origin: np.ndarray, spacing: np.ndarray
) -> Domains:
    """Return the chosen boxes of a lattice as domains with unique corners.

    Boxes and corners are numbered in order, the last axis fastest.

    Parameters
    ----------
    inside
        Flag of each box of a block of the lattice, one axis of the array for each of the lattice.
    first
        Lattice numbers of the block's first box, shape (dim,).
    origin, spacing
        Where box 0 begins [m] and how long a box is [m], shape (dim,).
    """
    dim = inside.ndim
    padded = np.pad(inside, [(0, 1)] * dim)
    used = np.zeros(padded.shape, dtype=bool)
    for step in _STEPS[dim]:
        used[tuple(slice(a, a + n) for a, n in zip(step, inside.shape, strict=True))] |= inside
    number = np.cumsum(used.ravel(), dtype=np.int32 if used.size < 2**31 else np.int64) - 1
    strides = np.cumprod((1, *used.shape[:0:-1]))[::-1]
    boxes = np.flatnonzero(padded)
    cells = np.empty((len(boxes), 2**dim), dtype=number.dtype)
    for corner, step in enumerate(_STEPS[dim]):
        cells[:, corner] = number[boxes + np.dot(step, strides)]
    places = np.unravel_index(np.flatnonzero(used), used.shape)
    vertices = np.zeros((len(places[0]), 3))
    for k, place in enumerate(places):
        vertices[:, k] = origin[k] + spacing[k] * (place + first[k])
    return Domains(vertices, cells, _KINDS[dim], checked=True)


def _chosen(
    region: Region, first: np.ndarray, shape: tuple[int, ...], start: np.ndarray, step: np.ndarray
) -> np.ndarray:
    """Flag of each box of a block of the lattice whose centre lies in a region, a few planes in one go."""
    inside = np.zeros(shape, dtype=bool)
    axes = [
        a + h * (low + np.arange(n) + 0.5) for low, n, a, h in zip(first, shape, start, step, strict=True)
    ]
    plane = int(np.prod(shape[1:]))
    planes = max(1, _POINTS // plane)
    for row in range(0, shape[0], planes):
        block = np.meshgrid(axes[0][row : row + planes], *axes[1:], indexing="ij", copy=False)
        centres = np.zeros((block[0].size, 3))
        for k, values in enumerate(block):
            centres[:, k] = values.ravel()
        flags = np.asarray(region.contains(centres), dtype=bool)
        inside[row : row + planes] = flags.reshape(block[0].shape)
    return inside


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
    shape = tuple(int(max(b, a + 1) - a) for a, b in zip(first, last, strict=True))
    inside = _chosen(region, first, shape, start, step)
    if not inside.any():
        raise InputError(
            f"no particles: no point of the lattice of spacing {step.tolist()} m lies in its region"
        )
    return lattice_domains(inside, first, start, step)

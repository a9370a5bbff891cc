"""Particles in random places: cells cut at random into boxes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from matpoint.domains import Domains, Kind

_FEWEST, _MOST = 4, 9
#: Particles that a cell gets in the mean.
MEAN_COUNT = 0.5 * (_FEWEST + _MOST)
_NEAREST = 0.2  # of a box's length: how near to its end it may be cut


def random_mesh(lower: Sequence[float], upper: Sequence[float], cells: int, seed: int) -> Domains:
    """Return a box whose cells are cut at random into 4 to 9 boxes each, with corners of their own.

    Particles, their centroids, then lie irregularly, while their volumes still fill every cell.

    Parameters
    ----------
    lower, upper
        Corners [m].
    cells
        Along each axis.
    seed
        Of NumPy's generator.
    """
    rng = np.random.default_rng(seed)
    low, high = np.array(lower, dtype=float), np.array(upper, dtype=float)
    dim, size = len(low), (high - low) / cells
    boxes = []
    for index in np.ndindex((cells,) * dim):
        corner = low + size * index
        boxes += _cut(np.array([corner, corner + size]), int(rng.integers(_FEWEST, _MOST + 1)), rng)
    kind = (Kind.LINE, Kind.QUAD, Kind.HEX)[dim - 1]
    pick = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]] * 2)[: kind.corners]
    pick[4:, 2] = 1
    vertices = np.zeros((len(boxes), kind.corners, 3))
    for k in range(dim):
        vertices[:, :, k] = np.array(boxes)[:, pick[:, k], k]
    numbers = np.arange(len(boxes) * kind.corners).reshape(len(boxes), -1)
    return Domains(vertices.reshape(-1, 3), numbers, kind, checked=True)


def _cut(box: np.ndarray, count: int, rng: np.random.Generator) -> list[np.ndarray]:
    """Cut a box (2, dim) into ``count``, always the largest, across a random axis."""
    parts = [box]
    while len(parts) < count:
        largest = int(np.argmax([np.prod(p[1] - p[0]) for p in parts]))
        first, second = parts[largest].copy(), parts.pop(largest)
        k = int(rng.integers(box.shape[1]))
        share = rng.uniform(_NEAREST, 1.0 - _NEAREST)
        first[1, k] = second[0, k] = first[0, k] + share * (first[1, k] - first[0, k])
        parts += [first, second]
    return parts

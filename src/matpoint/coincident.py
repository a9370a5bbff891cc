"""Points in one place."""

from __future__ import annotations

import numpy as np


def first_in_place(points: np.ndarray, distance: float) -> np.ndarray:
    """Return, for each point (n, 3), the first one of those in the same place, shape (n,).

    Parameters
    ----------
    points
        [m]
    distance
        Points that are no farther apart [m] are one.
    """
    from scipy.sparse import coo_array  # noqa: PLC0415 (slow to import)
    from scipy.sparse.csgraph import connected_components  # noqa: PLC0415
    from scipy.spatial import KDTree  # noqa: PLC0415

    n = len(points)
    pairs = KDTree(points).query_pairs(distance, output_type="ndarray")
    if len(pairs) == 0:
        return np.arange(n)
    graph = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(n, n))
    label = connected_components(graph, directed=False)[1]
    first = np.full(label.max() + 1, n)
    np.minimum.at(first, label, np.arange(n))
    return first[label]

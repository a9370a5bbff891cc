"""Joining the domains of several bodies: shared corners, and refusal of bodies in one place."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations, pairwise

import numpy as np

from matpoint.domains import Domains, Kind
from matpoint.errors import InputError
from matpoint.faces import FACES, Facets, orient, shared_faces

_TOLERANCE = 1e-6  # of the smallest domain's size


def _size(domains: Domains) -> float:
    return float(np.abs(domains.volumes()).min()) ** (1.0 / domains.dim)


@dataclass(frozen=True, eq=False)
class Joined:
    """One mesh of all bodies.

    Attributes
    ----------
    vertices : ndarray, shape (nv, 3) [m]
    cells : ndarray of int32, shape (n, K), padded with -1
    kind : ndarray of int8, shape (n,)
    body : ndarray of int16, shape (n,)
    facets
        The boundary sets of all bodies.
    """

    vertices: np.ndarray
    cells: np.ndarray
    kind: np.ndarray
    body: np.ndarray
    facets: tuple[Facets, ...]


def merge(parts: Sequence[Domains], names: Sequence[str]) -> Joined:
    """Return one mesh of all bodies; vertices of different bodies in one place become one."""
    offsets = np.cumsum([0, *(len(d.vertices) for d in parts)])
    vertices = np.concatenate([d.vertices for d in parts]) if len(parts) > 1 else parts[0].vertices
    lookup = None
    if len(parts) > 1:
        first = _first_of_each(vertices, parts, offsets)
        kept, compact = np.unique(first, return_inverse=True)
        lookup = compact.astype(np.int32)
        vertices = vertices[kept]
    width, total = max(d.kind.corners for d in parts), sum(d.n for d in parts)
    cells = np.full((total, width), -1, dtype=np.int32)
    kind, body, row = np.empty(total, dtype=np.int8), np.empty(total, dtype=np.int16), 0
    for number, domains in enumerate(parts):
        rows = slice(row, row + domains.n)
        own = domains.cells if lookup is None else lookup[offsets[number] :][domains.cells]
        cells[rows, : domains.kind.corners] = own
        kind[rows], body[rows] = int(domains.kind), number
        row += domains.n
    facets: tuple[Facets, ...] = ()
    if any(d.sets for d in parts):
        joined = [
            np.arange(a, b) if lookup is None else lookup[a:b].astype(np.int64) for a, b in pairwise(offsets)
        ]
        facets = _facets(parts, names, joined, len(vertices))
    return Joined(vertices, cells, kind, body, facets)


def _facets(
    parts: Sequence[Domains], names: Sequence[str], joined: Sequence[np.ndarray], count: int
) -> tuple[Facets, ...]:
    """The boundary sets in the joined mesh; ``joined`` gives the new number of each part's vertices."""
    meshes = [(new[d.cells], d.kind) for d, new in zip(parts, joined, strict=True)]
    facets = []
    for d, body, new, (cells, kind) in zip(parts, names, joined, meshes, strict=True):
        for name, rows in d.sets.items():
            corners, sign = orient(new[rows], cells, kind, count)
            facets.append(Facets(name, body, corners, sign, ~shared_faces(corners, meshes, count)))
    return tuple(facets)


def _first_of_each(vertices: np.ndarray, parts: Sequence[Domains], offsets: np.ndarray) -> np.ndarray:
    """The first vertex of the place of each vertex; only different bodies are joined."""
    from scipy.sparse import coo_array  # noqa: PLC0415 (slow to import)
    from scipy.sparse.csgraph import connected_components  # noqa: PLC0415
    from scipy.spatial import KDTree  # noqa: PLC0415

    tolerance = _TOLERANCE * min(_size(d) for d in parts)
    trees = [KDTree(d.vertices) for d in parts]
    rows, columns = [], []
    for a, b in combinations(range(len(parts)), 2):
        pairs = trees[a].sparse_distance_matrix(trees[b], tolerance, output_type="coo_matrix")
        rows.append(pairs.row + offsets[a])
        columns.append(pairs.col + offsets[b])
    row, column = np.concatenate(rows), np.concatenate(columns)
    graph = coo_array((np.ones(len(row)), (row, column)), shape=(len(vertices),) * 2)
    label = connected_components(graph, directed=False)[1]
    first = np.full(label.max() + 1, len(vertices))
    np.minimum.at(first, label, np.arange(len(vertices)))
    return first[label]


def overlap(named: Sequence[tuple[str, Domains]]) -> None:
    """Refuse two bodies in one place.

    Raises
    ------
    InputError
        If a centroid of one lies in a domain of another.
    """
    for (name_a, a), (name_b, b) in combinations(named, 2):
        for one, two in ((a, b), (b, a)):
            low, high = two.vertices.min(axis=0), two.vertices.max(axis=0)
            points = one.centroids()
            near = ((points >= low) & (points <= high)).all(axis=1)
            hit = _first_inside(points[near], two) if near.any() else None
            if hit is not None:
                raise InputError(
                    f"bodies {name_a!r} and {name_b!r} lie in one place, near"
                    f" ({', '.join(f'{c:g}' for c in hit[: one.dim])}) m; move one, or cut it out"
                )


def overlap_within(name: str, domains: Domains) -> None:
    """Refuse a mesh two of whose domains lie in one place; meshes that were filled can't have any.

    Raises
    ------
    InputError
        If the centroid of a domain lies in another domain of the body.
    """
    if domains.checked:
        return
    hit = _first_inside(domains.centroids(), domains, own=True)
    if hit is not None:
        raise InputError(
            f"body {name!r}: two of its domains lie in one place, near"
            f" ({', '.join(f'{c:g}' for c in hit[: domains.dim])}) m"
        )


_PAIRS = 1 << 18  # point-domain pairs looked at in one go


def _first_inside(points: np.ndarray, domains: Domains, own: bool = False) -> np.ndarray | None:
    """The first point that lies in a domain, taken as the convex body of its faces' mean planes.

    With ``own``, points are the domains' own centroids, and each may lie in its own.
    """
    from scipy.spatial import KDTree  # noqa: PLC0415 (slow to import)

    x = domains.vertices[domains.cells]
    centres = domains.centroids()
    reach = float(np.sqrt(((x - centres[:, None]) ** 2).sum(axis=2).max()))
    tree = KDTree(centres)
    for start in range(0, len(points), _PAIRS // 16):
        some = points[start : start + _PAIRS // 16]
        near = tree.query_ball_point(some, reach)
        owner = np.repeat(np.arange(len(some)), [len(c) for c in near])
        cells = np.concatenate([np.asarray(c, dtype=np.int64) for c in near])
        hit = _inside(some[owner], x[cells], domains.kind)
        if own:
            hit &= cells != owner + start
        if hit.any():
            return some[owner[hit].min()]
    return None


def _inside(point: np.ndarray, x: np.ndarray, kind: Kind) -> np.ndarray:
    """Whether points (m, 3) lie in the domains with corners x (m, corners, 3), one by one."""
    if kind == Kind.LINE:
        return np.asarray((x[:, 0, 0] < point[:, 0]) & (point[:, 0] < x[:, 1, 0]))
    if kind.dim == 2:
        edge, arm = np.roll(x, -1, axis=1) - x, point[:, None] - x
        return np.asarray((edge[..., 0] * arm[..., 1] - edge[..., 1] * arm[..., 0] > 0).all(axis=1))
    inside = np.ones(len(x), dtype=bool)
    for face in FACES[kind]:
        corners = x[:, list(face)]
        middle = corners.mean(axis=1)
        spokes = corners - middle[:, None]
        normal = np.cross(spokes, np.roll(spokes, -1, axis=1)).sum(axis=1)
        inside &= ((point - middle) * normal).sum(axis=1) < 0
    return inside

"""Meshes of a disc or a sphere, bare or coated, in a square or cubic plate: a quarter or an octant.

A lattice of the unit square or cube, its coordinates made tangents of equal angles, is the core. Its
faces are drawn outward along rays: to the circles or spheres in equal parts, and to the plate's far faces in
a constant ratio, so that domains keep their shape as they grow. Every vertex is made once; the domains
of each material take theirs from one table, and neighbours meet exactly.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from matpoint.checks import positive, whole
from matpoint.domains import Domains, Kind
from matpoint.errors import InputError
from matpoint.faces import split_by
from matpoint.meshes import mesh_box

CORE = 0.5  # half-width of the core over the innermost radius
BULGE = 0.5  # how much of a circle the core's outline is: 0 a square, 1 a circle


def mesh_inclusion(dim: int, radii: Sequence[float], size: float, divisions: int) -> list[Domains]:
    """Return a quarter (2-D) or an octant (3-D) of a plate around concentric interfaces.

    Boundary sets are ``x-``, ``y-`` (and ``z-``) on the planes of symmetry, and ``outer`` on the far
    faces of the plate.

    Parameters
    ----------
    dim
        2 for quadrilaterals, 3 for hexahedra.
    radii
        Of the interfaces [m], increasing: one for a disc or sphere, two with a coating.
    size
        Half-width of the plate [m].
    divisions
        Domains along an eighth of a circle; the numbers along the radius follow from it.

    Returns
    -------
    list of Domains
        From the inside: the disc or sphere, coatings, the plate.

    Raises
    ------
    InputError
        If the dimension is neither, radii and size don't increase from a positive one, or divisions
        are not a whole number >= 1.
    """
    if isinstance(dim, bool) or dim not in (2, 3):
        raise InputError(f"mesh inclusion: dim = {dim!r}; 2 and 3 are allowed")
    if len(radii) == 0:
        raise InputError("mesh inclusion: radii are empty; the disc needs one")
    lengths = [positive("mesh inclusion: radii", r) for r in radii]
    lengths.append(positive("mesh inclusion: size", size))
    if not (np.diff(lengths) > 0).all():
        raise InputError(
            f"mesh inclusion: radii = {lengths[:-1]} must increase, and be below size = {size:g}"
        )
    whole("mesh inclusion: divisions", divisions)
    core = mesh_box((0.0,) * dim, (1.0,) * dim, (divisions,) * dim)
    p = np.tan(0.25 * math.pi * core.vertices)
    p[core.vertices == 1.0] = 1.0
    surface = split_by(core, {"skin": (core.vertices == 1.0).any(axis=1)})["skin"]
    skin, faces = np.unique(surface, return_inverse=True)
    faces = faces.reshape(surface.shape)
    rings, ends = _rings(p[skin], lengths, divisions)
    x = np.concatenate([_core(p, lengths[0]), *rings[1:]])
    drawn = len(p) + np.arange((len(rings) - 1) * len(skin)).reshape(-1, len(skin))
    levels = np.concatenate([skin[None], drawn])
    inner, outer = levels[:-1, faces], levels[1:, faces]  # (layer, face, corner)
    if dim == 2:
        inner = inner[
            :, :, ::-1
        ]  # an edge has its outside on the right, a quadrilateral its inside on the left
    shells = np.concatenate([inner, outer], axis=2)
    far = np.zeros(len(x), dtype=bool)
    far[levels[-1]] = True
    cells = [np.concatenate(list(shells[a:b])) for a, b in zip([0, *ends[:-1]], ends, strict=True)]
    cells[0] = np.concatenate([core.cells, cells[0]])
    return [_part(x, part, core.kind, far) for part in cells]


def _core(p: np.ndarray, radius: float) -> np.ndarray:
    """The core's vertices [m] of lattice points in the unit box: bulged the more, the farther out."""
    most, length = p.max(axis=1), np.linalg.norm(p, axis=1)
    roundness = most / np.where(length > 0, length, 1.0)
    return CORE * radius * p * (1.0 - BULGE * most * (1.0 - roundness))[:, None]


def _rings(p: np.ndarray, lengths: list[float], divisions: int) -> tuple[list[np.ndarray], list[int]]:
    """Layers of vertices on the rays of skin points p, from the core out, and where each material ends."""
    rings, ends = [_core(p, lengths[0])], []
    step = 0.25 * math.pi / divisions  # of angle
    ray = p / np.linalg.norm(p, axis=1)[:, None]
    inside = CORE * lengths[0]
    for radius in lengths[:-1]:
        begin, end = rings[-1], radius * ray
        count = max(1, round((radius - inside) / (0.5 * (radius + inside) * step)))
        rings += [begin + (end - begin) * (j / count) for j in range(1, count)] + [end]
        ends.append(len(rings) - 1)
        inside = radius
    count = max(1, round(math.log(lengths[-1] / inside) / step))
    growth = (lengths[-1] / inside * np.linalg.norm(p, axis=1))[:, None]
    rings += [inside * growth ** (j / count) * ray for j in range(1, count)] + [lengths[-1] * p]
    return rings, [*ends, len(rings) - 1]


def _part(x: np.ndarray, cells: np.ndarray, kind: Kind, far: np.ndarray) -> Domains:
    """The domains of one material, with the vertices that they use."""
    used, numbered = np.unique(cells, return_inverse=True)
    part = Domains(x[used], numbered.reshape(cells.shape), kind)
    sides = {f"{axis}-": part.vertices[:, k] == 0.0 for k, axis in enumerate("xyz"[: part.dim])}
    if far[used].any():
        sides["outer"] = far[used]
    return Domains(part.vertices, part.cells, kind, checked=True, sets=split_by(part, sides))

"""The laminate by finite elements: static, on the mesh of the particle domains."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from matpoint.problems.laminate import CELL, COMPONENTS, COUNT, DENSITY, STRAIN, WIDTH, Strained
from matpoint.reference.prescribed import Prescribed
from matpoint.reference.solid import Solid
from matpoint.reference.static import solve_static

if TYPE_CHECKING:
    from matpoint.problems.laminate import Laminate


def strained_fem(problem: Laminate) -> Strained:
    """Return the equilibrium of a laminate under its load."""
    from matpoint.meshes import mesh_box  # noqa: PLC0415 (compiles)

    mesh = mesh_box((0.0, 0.0), (WIDTH, CELL), (round(WIDTH * COUNT / CELL), COUNT * problem.per_layer))
    x = mesh.vertices
    middle = x[mesh.cells, 1].mean(axis=1)
    layers = problem.layers
    layer = np.minimum((middle / CELL * COUNT).astype(int), COUNT - 1)
    solid = Solid(x, mesh.cells, "quad", layers.lame[layer], layers.rigidity[layer], DENSITY)
    hair = 1e-9
    low, high = np.flatnonzero(x[:, 1] < hair), np.flatnonzero(x[:, 1] > CELL - hair)
    left, right = np.flatnonzero(x[:, 0] < hair), np.flatnonzero(x[:, 0] > WIDTH - hair)
    sides = np.union1d(left, right)
    conditions = {
        "normal": [
            Prescribed(sides, 0),
            *_both(low),
            Prescribed(high, 0),
            Prescribed(high, 1, STRAIN * CELL),
        ],
        "shear": [Prescribed(sides, 1), *_both(low), Prescribed(high, 0, STRAIN * CELL), Prescribed(high, 1)],
        "in_plane": [Prescribed(left, 0), Prescribed(low, 1), Prescribed(right, 0, STRAIN * WIDTH)],
    }[problem.load]
    found = solve_static(solid, prescribed=conditions)
    component, (i, j) = COMPONENTS[problem.load]
    F = solid.deformation(found.displacement.T)[i, j].reshape(len(mesh.cells), -1).mean(axis=1)
    stress = found.stress[:, component]
    mean = float(np.average(stress, weights=solid.volumes))
    return Strained(mean / STRAIN, middle / CELL, stress, F - float(i == j))


def _both(nodes: np.ndarray) -> list[Prescribed]:
    return [Prescribed(nodes, axis) for axis in (0, 1)]

"""Small mesh files written by hand, and structured meshes written by meshio."""

from __future__ import annotations

from pathlib import Path

import meshio
import numpy as np

from matpoint.domains import Domains, Kind

SHAPES = {
    Kind.LINE: "line",
    Kind.QUAD: "quad",
    Kind.HEX: "hexahedron",
    Kind.TRI: "triangle",
    Kind.TET: "tetra",
}

# Two unit squares, one of them two triangles, with a corner that stands twice and one of no cell.
MSH22 = """$MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
3
1 3 "left"
2 1 "stiff part"
2 2 "soft"
$EndPhysicalNames
$Nodes
8
1 0 0 5
2 1 0 5
3 1 1 5
4 0 1 5
5 2 0 5
6 2 1 5
7 1 1 5
9 7 7 5
$EndNodes
$Elements
4
1 1 2 3 1 1 4
2 3 2 1 1 1 4 3 2
3 2 2 2 2 2 5 6
4 2 2 2 2 2 6 7
$EndElements
"""

MSH41 = """$MeshFormat
4.1 0 8
$EndMeshFormat
$PhysicalNames
3
1 3 "left"
2 1 "stiff part"
2 2 "soft"
$EndPhysicalNames
$Entities
0 1 2 0
1 0 0 5 0 1 5 1 -3 0
1 0 0 5 1 1 5 1 1 0
2 1 0 5 2 1 5 1 2 0
$EndEntities
$Nodes
1 8 1 9
2 1 0 8
1
2
3
4
5
6
7
9
0 0 5
1 0 5
1 1 5
0 1 5
2 0 5
2 1 5
1 1 5
7 7 5
$EndNodes
$Elements
3 4 1 4
1 1 1 1
1 1 4
2 1 3 1
2 1 4 3 2
2 2 2 2
3 2 5 6
4 2 6 7
$EndElements
"""


def write(path: Path, text: str, *changes: tuple[str, str]) -> Path:
    """Write a text with parts of it replaced; each must be there."""
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    path.write_text(text)
    return path


def save(path: Path, domains: Domains, groups: np.ndarray, sides: np.ndarray | None = None, **how) -> Path:
    """Write domains in groups 1, 2, ... (named a, b, ...), and sides as group 9, named side."""
    cells = [(SHAPES[domains.kind], domains.cells)]
    tags = [np.asarray(groups)]
    names = {chr(96 + tag): np.array([tag, domains.dim]) for tag in np.unique(groups)}
    if sides is not None:
        shape = {1: "vertex", 2: "line", 3: "triangle", 4: "quad"}[sides.shape[1]]
        cells.append((shape, sides))
        tags.append(np.full(len(sides), 9))
        names["side"] = np.array([9, domains.dim - 1])
    msh = path.suffix == ".msh"
    data = {"gmsh:physical": tags, "gmsh:geometrical": tags} if msh else {"material": tags}
    mesh = meshio.Mesh(domains.vertices, cells, cell_data=data, field_data=names if msh else None)
    meshio.write(path, mesh, **how)
    return path

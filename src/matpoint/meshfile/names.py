"""The groups of the cells of a mesh file, as Gmsh and VTU files write them down."""

from __future__ import annotations

from typing import Any

import numpy as np

from matpoint.errors import InputError

#: Dimensions of the cells that are looked at, by the name that meshio gives them.
CELLS = {"vertex": 0, "line": 1, "triangle": 2, "quad": 2, "tetra": 3, "hexahedron": 3}
_ENTITIES = ("Point", "Curve", "Surface", "Volume")
_ARRAYS = ("material", "group", "gmsh:physical", "medit:ref")  # cell data of VTU files, first found wins

#: Of each block of cells: names, and the rows of the block that carry them.
Named = list[list[tuple[tuple[str, ...], np.ndarray]]]


def gmsh_names(raw: Any, where: str) -> Named:
    """Return the names of the physical groups of each block.

    Raises
    ------
    InputError
        If a group of the highest dimension, or of boundaries, has no name or no cells.
    """
    top = max(CELLS[b.type] for b in raw.cells if len(b.data))
    names = {(int(dim), int(tag)): name for name, (tag, dim) in raw.field_data.items()}
    tags = raw.cell_data.get("gmsh:physical")
    used: set[tuple[int, int]] = set()
    result: Named = []
    for k, block in enumerate(raw.cells):
        dim = CELLS.get(block.type, -1)
        # Format 4.1 gives a block all its groups in cell_sets, and its first one in the tags as well.
        more = {
            key: name
            for key, name in names.items()
            if key[0] == dim and name in raw.cell_sets and len(raw.cell_sets[name][k])
        }
        # The sign of a tag says which way a curve or surface runs.
        own = np.abs(tags[k]) if tags is not None else np.zeros(len(block.data), dtype=int)
        parts = []
        for tag in np.unique(own):
            keys = dict.fromkeys([(dim, int(tag)), *more])
            if tag and (dim, int(tag)) not in names and dim >= top - 1:
                raise InputError(
                    f"{where}: the physical group {tag} of {block.type} cells has no name of its own; in Gmsh"
                    f' write Physical {_ENTITIES[dim]}("name", {tag})'
                )
            used.update(keys)
            parts.append((tuple(names[key] for key in keys if key in names), np.flatnonzero(own == tag)))
        result.append(parts)
    for (dim, tag), name in names.items():
        if (dim, tag) not in used and dim >= top - 1:
            raise InputError(
                f"{where}: the physical group {name!r} has no cells; take it out, mesh it, or save with"
                " Mesh.SaveAll = 0"
            )
    return result


def vtu_names(raw: Any, where: str) -> Named:
    """Return the numbers, as text, that cell data give to the cells of each block.

    Raises
    ------
    InputError
        If there are no such data, or they are not whole numbers or texts.
    """
    array = next((name for name in _ARRAYS if name in raw.cell_data), None)
    if array is None:
        raise InputError(
            f"{where}: no cell data name the groups; one of {', '.join(_ARRAYS)} must hold whole numbers"
        )
    result: Named = []
    for block, given in zip(raw.cells, raw.cell_data[array], strict=True):
        values = np.asarray(given)
        if values.size != len(block.data):
            raise InputError(f"{where}: cell data {array!r} must have one number for each cell")
        values = values.ravel()
        if values.dtype.kind == "f":
            if not (np.isfinite(values).all() and (values == np.rint(values)).all()):
                raise InputError(f"{where}: cell data {array!r} must be whole numbers")
            values = values.astype(np.int64)
        # Gmsh and Medit number groups from 1; 0 stands for none.
        none = "0" if array in _ARRAYS[2:] else None
        result.append(
            [
                ((str(v),) if str(v) != none else (), np.flatnonzero(values == v))
                for v in np.unique(values).tolist()
            ]
        )
    return result

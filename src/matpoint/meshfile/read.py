"""What a mesh file says: vertices, and cells with the names of their groups; nothing is mended here.

The formats are read by meshio. It prints, skips what it does not know, and fails in many ways on a damaged
file, so that every way out of it is turned into one message here.
"""

from __future__ import annotations

import contextlib
import io
import re
import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from matpoint.domains import Kind
from matpoint.errors import InputError
from matpoint.meshfile.names import CELLS, gmsh_names, vtu_names

#: Cells of a file that can become domains, by the name that meshio gives them.
KINDS = {
    "line": Kind.LINE,
    "triangle": Kind.TRI,
    "quad": Kind.QUAD,
    "tetra": Kind.TET,
    "hexahedron": Kind.HEX,
}
_LARGEST = 2_000_000_000  # bytes of a mesh file
_FARTHEST = 1e50  # metres from the origin
_GMSH_VERSIONS = ("2", "2.2", "4", "4.1")
_HIGHER = re.compile(r"(line|triangle|quad|tetra|hexahedron|wedge|pyramid)\d+$|VTK_(LAGRANGE|BEZIER)_")


@dataclass(frozen=True, eq=False)
class Patch:
    """Cells of one shape that are in the same groups.

    Attributes
    ----------
    shape
        meshio's name: ``"vertex"`` or one of :data:`KINDS`.
    cells
        Corners of each, shape (n, corners).
    numbers
        Which cells of this shape they are in the file, counted from 0, shape (n,).
    names
        The groups; none if the file names none.
    """

    shape: str
    cells: np.ndarray
    numbers: np.ndarray
    names: tuple[str, ...]

    @property
    def dim(self) -> int:
        """The dimension of the cells, 0 to 3."""
        return CELLS[self.shape]


def read_patches(path: Path, where: str) -> tuple[np.ndarray, list[Patch], bool]:
    """Return the vertices and cells of a file.

    Parameters
    ----------
    path
        A ``.msh`` or ``.vtu`` file.
    where
        What messages begin with.

    Returns
    -------
    points : ndarray, shape (nv, 3) [m]
    patches : list of Patch
        Of every dimension from 0.
    gmsh : bool
        Whether groups have Gmsh's names; those of VTU files are numbers.

    Raises
    ------
    InputError
        If the file can't be read, or holds cells that can't become domains.
    """
    gmsh = _check_file(path, where)
    raw = _read(path, where, gmsh)
    points = np.asarray(raw.points, dtype=float)
    if points.ndim != 2 or len(points) == 0 or not any(len(block.data) for block in raw.cells):
        raise InputError(f"{where}: it is empty: there must be vertices and cells")
    if points.shape[1] > 3:
        raise InputError(f"{where}: its vertices have {points.shape[1]} coordinates; at most 3 are allowed")
    points = np.pad(points, ((0, 0), (0, 3 - points.shape[1])))
    _refuse_shapes([block.type for block in raw.cells if len(block.data)], where)
    # Products of larger coordinates would overflow; a NaN is not smaller either.
    bad = np.flatnonzero(~(np.abs(points) < _FARTHEST).all(axis=1))
    if len(bad):
        raise InputError(
            f"{where}: vertex {bad[0]} (from 0) is at {points[bad[0]].tolist()}; it must be finite, and"
            f" nearer than {_FARTHEST:g} m"
        )
    found = (gmsh_names if gmsh else vtu_names)(raw, where)
    patches, seen = [], {}
    for block, named in zip(raw.cells, found, strict=True):
        cells = np.asarray(block.data, dtype=np.int64)
        if not len(cells):
            continue
        if cells.min() < 0 or cells.max() >= len(points):
            raise InputError(f"{where}: a cell ({block.type}) names a vertex that the file does not have")
        first = seen.get(block.type, 0)
        seen[block.type] = first + len(cells)
        for names, rows in named:
            patches.append(Patch(block.type, cells[rows], first + rows, names))
    return points, patches, gmsh


def _check_file(path: Path, where: str) -> bool:
    """Refuse what can't be a mesh file before it is read as a whole; return whether it is Gmsh's."""
    ending = path.suffix.lower()
    if ending not in (".msh", ".vtu"):
        raise InputError(f"{where}: its name must end in .msh (Gmsh 2.2 or 4.1) or .vtu")
    try:
        if not path.is_file():
            raise InputError(f"{where}: there is no such file")
        size = path.stat().st_size
        with path.open("rb") as file:
            head = file.read(4096)
            file.seek(max(0, size - 64))
            tail = file.read(64)
    except OSError as error:
        raise InputError(f"{where}: it can't be read ({error.strerror or error})") from None
    if size > _LARGEST:
        raise InputError(f"{where}: it has {size / 1e9:.3g} GB; at most {_LARGEST / 1e9:g} GB are read")
    if not head.strip():
        raise InputError(f"{where}: the file is empty")
    if ending == ".vtu":
        if b"<VTKFile" not in head:
            raise InputError(f"{where}: it is not a VTU file (there is no <VTKFile> at its beginning)")
        return False
    version = re.search(rb"^\$MeshFormat\s+(\S+)", head, re.MULTILINE)
    if head.startswith(b"$NOD"):
        raise InputError(f"{where}: it has Gmsh's format 1; save it as 2.2 or 4.1 (Mesh.MshFileVersion)")
    if version is None:
        raise InputError(f"{where}: it is not a Gmsh file (there is no $MeshFormat at its beginning)")
    text = version[1].decode(errors="replace")
    if text not in _GMSH_VERSIONS:
        raise InputError(f"{where}: it has Gmsh's format {text}; save it as 2.2 or 4.1 (Mesh.MshFileVersion)")
    if not re.search(rb"\$End\w+\s*$", tail):
        raise InputError(f"{where}: it is cut off: its last section is not closed")
    return True


def _read(path: Path, where: str, gmsh: bool) -> Any:
    """Meshio's mesh."""
    try:
        import meshio  # noqa: PLC0415 (an extra)
    except ImportError:
        raise InputError(f"{where}: reading it needs meshio: pip install 'matpoint[mesh]'") from None
    if not gmsh and (pieces := path.read_bytes().count(b"<Piece")) != 1:
        # Of several pieces meshio keeps the cells of one.
        raise InputError(f"{where}: it has {pieces} pieces; save it as one")
    noise = io.StringIO()
    try:
        with warnings.catch_warnings(), contextlib.redirect_stderr(noise), contextlib.redirect_stdout(noise):
            warnings.simplefilter("ignore")
            # NumPy only warns of text that is cut off or is no number.
            warnings.filterwarnings("error", message="string or file could not be read")
            raw = (meshio.gmsh if gmsh else meshio.vtu).read(str(path))
    except Exception as error:  # meshio lets any kind out
        raise InputError(f"{where}: {_cause(error)}") from None
    said = " ".join(noise.getvalue().split())
    if unknown := re.search(r"cannot handle \(type (\d+)\)", said):
        raise InputError(f"{where}: VTK's cell type {unknown[1]} is not known; {_allowed()}")
    if "not closed" in said:
        raise InputError(f"{where}: it is damaged: a section is not closed")
    return raw


def _cause(error: Exception) -> str:
    text = " ".join(str(error).split())
    if "gmsh:physical" in text:
        return (
            "some cells are in a physical group and others in none; give every cell one, and let Gmsh"
            " save no others (Mesh.SaveAll = 0)"
        )
    if isinstance(error, KeyError):
        return f"the entry or cell type {text} is not known, or the file is damaged; {_allowed()}"
    if "zero-size array" in text:
        return "it is empty: there must be vertices and cells"
    return f"it can't be read; it is damaged or not such a file ({text or type(error).__name__})"


def _allowed() -> str:
    return f"allowed are {', '.join(KINDS)}"


def _refuse_shapes(shapes: list[str], where: str) -> None:
    for shape in shapes:
        if _HIGHER.match(shape):
            raise InputError(
                f"{where}: {shape} is a cell of higher order; domains have straight edges and corners only,"
                " so mesh with order 1 (in Gmsh: Mesh.ElementOrder = 1)"
            )
        if shape not in CELLS:
            raise InputError(f"{where}: {shape} cells can't become domains; {_allowed()}")

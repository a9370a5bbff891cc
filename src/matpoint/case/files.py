"""The mesh files of a case: each is read once, and none of its groups is left out by accident."""

from __future__ import annotations

from pathlib import Path

from matpoint.case.shapes import FileMesh
from matpoint.domains import Domains
from matpoint.errors import InputError
from matpoint.meshfile import Mesh, read_mesh


class MeshFiles:
    """Reads the mesh files that the bodies of a case name.

    Parameters
    ----------
    folder
        Where relative paths begin; None takes the current folder.
    """

    def __init__(self, folder: Path | None) -> None:
        self.folder = folder or Path()
        self._meshes: dict[Path, Mesh] = {}
        self._used: dict[Path, list[str]] = {}
        self._ignored: dict[Path, list[str]] = {}

    def domains(self, table: FileMesh) -> tuple[Domains, ...]:
        """Return the domains of a group of a file, one entry for each shape of cell.

        Raises
        ------
        InputError
            If the file can't be read, has no such group, or another body has taken it.
        """
        path = self.folder / table.path
        try:
            key = path.resolve()
        except (OSError, RuntimeError, ValueError) as error:
            raise InputError(f"mesh.path = {table.path!r}: no usable path ({error})") from None
        if key not in self._meshes:
            self._meshes[key] = read_mesh(path)
        found = self._meshes[key].group(table.group)
        used = self._used.setdefault(key, [])
        if table.group in used:
            raise InputError(f"mesh file {path}: the group {table.group!r} is taken by a body before")
        used.append(table.group)
        self._ignored.setdefault(key, []).extend(table.ignore)
        return found

    def check_use(self) -> None:
        """Refuse groups that no body names, unless one of the file's bodies ignores them.

        Raises
        ------
        InputError
            With the file and the groups.
        """
        for key, mesh in self._meshes.items():
            mesh.check_use(self._used[key], self._ignored[key], "a body")

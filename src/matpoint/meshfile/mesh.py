"""Meshes from files: Gmsh's ``.msh`` and VTU, with groups for materials and boundary sets."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from matpoint.body import Body
from matpoint.domains import Domains
from matpoint.errors import InputError, did_you_mean
from matpoint.materials import Material
from matpoint.meshfile.groups import grouped_domains
from matpoint.meshfile.read import read_patches


@dataclass(frozen=True, eq=False)
class Mesh:
    """The groups of a mesh file as particle domains; made by :func:`read_mesh`.

    Attributes
    ----------
    path
        The file.
    dim
        The dimension of its domains: 1, 2 or 3.
    groups
        Name of the group -> its domains, one :class:`Domains` for each shape of cell in it. Their
        boundary sets are the groups one dimension lower that touch them.
    """

    path: Path
    dim: int
    groups: Mapping[str, tuple[Domains, ...]]

    def group(self, name: str) -> tuple[Domains, ...]:
        """Return the domains of a group, one entry for each shape of cell.

        Raises
        ------
        InputError
            If there is no such group.
        """
        if name not in self.groups:
            raise InputError(
                f"mesh file {self.path}: there is no group {name!r}{did_you_mean(name, self.groups)};"
                f" it has {', '.join(self.groups)}"
            )
        return self.groups[name]

    def check_use(self, used: Sequence[str], ignore: Sequence[str], what: str) -> None:
        """Refuse names that are not groups, and groups that are neither used nor to be ignored.

        Parameters
        ----------
        used, ignore
            Names of groups.
        what
            What each group must be given, for the message.

        Raises
        ------
        InputError
            With the names.
        """
        for name in (*used, *ignore):
            self.group(name)
        left = [name for name in self.groups if name not in used and name not in ignore]
        if left:
            raise InputError(
                f"mesh file {self.path}: {', '.join(map(repr, left))} left out: give each group {what},"
                " or name it in ignore"
            )

    def bodies(
        self,
        materials: Mapping[str, Material],
        ignore: Sequence[str] = (),
        velocity: tuple[float, ...] | Callable[[np.ndarray], np.ndarray] = (0.0,),
    ) -> list[Body]:
        """Return a body for each group and shape of cell, named as the group.

        Parameters
        ----------
        materials
            Name of the group -> its material.
        ignore
            Groups that are to be left out.
        velocity
            The initial velocity of all, as for :class:`matpoint.Body`.

        Raises
        ------
        InputError
            If a name is not a group, or a group has no material and is not in ``ignore``.
        """
        self.check_use(tuple(materials), ignore, "a material")
        return [
            Body(domains, material, velocity=velocity, name=name)
            for name, material in materials.items()
            for domains in self.groups[name]
        ]


def read_mesh(path: str | os.PathLike[str], *, tolerance: float = 1e-9, dim: int | None = None) -> Mesh:
    """Read a mesh: Gmsh's ``.msh`` (2.2 or 4.1, text or binary), or ``.vtu``.

    Lines along x, triangles and quadrilaterals parallel to the x-y plane (moved to z = 0), tetrahedra
    and hexahedra are read. The physical groups of the highest dimension become groups of domains, those
    one dimension lower boundary sets; lower ones are passed over. VTU files name both by a number in
    the cell data ``material``, ``group``, ``gmsh:physical`` or ``medit:ref``. Clockwise and left-handed
    cells are mirrored, doubled vertices become one, and vertices without cells are dropped.

    Parameters
    ----------
    path
        The file.
    tolerance
        Vertices closer than this share of the mesh's diagonal are one.
    dim
        The dimension that the mesh must have; None takes what is there.

    Raises
    ------
    InputError
        If the file can't be read, holds cells that can't become domains, or a cell is in no group or
        in two; if a boundary set holds what is not a face of a cell; if meshio is not installed.
    """
    try:
        file = Path(path)
    except TypeError:
        raise InputError(f"mesh file: path = {path!r} must be the path of a file") from None
    where = f"mesh file {file}"
    if not (isinstance(tolerance, int | float) and math.isfinite(tolerance) and 0 <= tolerance <= 1e-3):
        raise InputError(f"{where}: tolerance = {tolerance!r} must lie between 0 and 1e-3")
    if dim not in (None, 1, 2, 3):
        raise InputError(f"{where}: dim = {dim!r} must be 1, 2, 3 or None")
    points, patches, gmsh = read_patches(file, where)
    top = max(patch.dim for patch in patches)
    if top == 0 or dim not in (None, top):
        raise InputError(f"{where}: its cells are {top}-D; {dim or '1 to 3'}-D cells are needed")
    return Mesh(file, top, grouped_domains(points, patches, tolerance, gmsh, where))

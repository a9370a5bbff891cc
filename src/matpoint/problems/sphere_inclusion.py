"""A stiff sphere in a soft matrix, in hexahedra or tetrahedra: the exact stress inside is uniform."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

from matpoint.checks import whole
from matpoint.errors import InputError
from matpoint.problems.embedded import POISSON, RADIUS, SIZE, Embedded

if TYPE_CHECKING:
    from matpoint.domains import Domains
    from matpoint.reference.sphere import Sphere

STRAIN = 1e-4  # far away, along x


@dataclass(frozen=True)
class SphereInclusion(Embedded):
    """An octant of a sphere of radius 1 m in a cube of half-width 2 m, pulled along x.

    The cube's far faces follow the exact displacement of the infinite matrix. The sphere is ten times
    as stiff as the matrix.

    Parameters
    ----------
    divisions
        Hexahedra along an eighth of a circle; for tetrahedra, the grid's cells only follow from it.
    mesh
        ``"hex"``, or ``"tet"`` for a mesh of Gmsh's that comes with the package (needs the extra ``mesh``).
    layers
        Enriched layers of domains on both sides when it is verified, as in the problem ``inclusion``.

    Raises
    ------
    InputError
        If one of them is something else.
    """

    divisions: int = 6
    mesh: str = "hex"
    layers: int = 2

    name: ClassVar[str] = "sphere-inclusion"
    title: ClassVar[str] = "Stiff sphere in a soft matrix"
    dim: ClassVar[int] = 3
    methods: ClassVar[tuple[str, ...]] = ("cpdi2", "enriched-cpdi2", "fem")
    norms: ClassVar[dict[str, str]] = {
        "inside": "stress in the sphere, uniform in truth: rms error over all its domains, relative",
        "largest": "largest error of stress of a domain at the interface, over the stress in the sphere",
        "outside": "stress outside the sphere: rms error, relative",
    }

    def __post_init__(self) -> None:
        if self.mesh not in ("hex", "tet"):
            raise InputError(f'{self.name}: mesh = {self.mesh!r}; "hex" and "tet" are allowed')
        whole(f"{self.name}: layers", self.layers, 0)
        if whole(f"{self.name}: divisions", self.divisions) > 24:
            raise InputError(f"{self.name}: divisions = {self.divisions} must be from 1 to 24")

    @property
    def moduli(self) -> dict[str, float]:
        """Young's modulus [Pa] of sphere and matrix."""
        return {"sphere": 1e7, "matrix": 1e6}

    @property
    def ladder(self) -> tuple[int, ...]:
        """The divisions: one level."""
        return (self.divisions,)

    @property
    def exact(self) -> Sphere:
        """The reference solution."""
        from matpoint.reference.sphere import Sphere  # noqa: PLC0415 (loaded when used)

        youngs = tuple(self.moduli.values())
        return Sphere(RADIUS, youngs, (POISSON, POISSON), (STRAIN, 0.0, 0.0, 0.0, 0.0, 0.0))

    def parts(self, divisions: int) -> list[Domains]:
        """Return the domains of sphere and matrix; tetrahedra are the file's, whatever the divisions."""
        if self.mesh == "hex":
            from matpoint.inclusion_mesh import mesh_inclusion  # noqa: PLC0415 (loaded when used)

            return mesh_inclusion(3, (RADIUS,), SIZE, divisions)
        from importlib import resources  # noqa: PLC0415

        from matpoint.meshfile import read_mesh  # noqa: PLC0415 (loads meshio)

        with resources.as_file(resources.files("matpoint.problems").joinpath("data/sphere.msh")) as path:
            read = read_mesh(path)
        return [read.group(name)[0] for name in self.moduli]

"""A stiff disc in a soft plate, bare or coated: the exact stress inside is uniform (Eshelby 1957)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

from matpoint.checks import whole
from matpoint.errors import InputError
from matpoint.problems.embedded import POISSON, RADIUS, SIZE, Embedded

if TYPE_CHECKING:
    from matpoint.domains import Domains
    from matpoint.reference.inclusion import Inclusion

COARSEST = 8  # divisions of an eighth of a circle
COATING = 1.25  # outer radius of the coating [m]
STRAIN = 1e-4  # far away, along x: the square of it, which small strain leaves out, is far below all errors


@dataclass(frozen=True)
class InclusionProblem(Embedded):
    """A quarter of a disc of radius 1 m in a plate of half-width 2 m, in plane strain, pulled along x.

    The plate's far faces follow the exact displacement of the infinite plate, so nothing is cut off.
    The disc is ten times as stiff as the plate; a coating is 3 times as stiff. The grid's cells are
    squares that take no notice of the circle.

    Parameters
    ----------
    coated
        With a coating between disc and plate: three materials.
    layers
        Layers of domains on both sides of an interface that are enriched besides its vertices, when it is
        verified; a run has those of its interpolation. A grid
        node that ordinary vertices on both sides touch ties their strains together, so the enriched zone
        must be as wide as a cell on both sides: 2 layers for cells of two domains. With 0
        the error inside is 18, 13 and 9 % on the three meshes and the largest stays at 30 %; with 1 they
        are 2.7, 0.3 and 0.6 % inside, as the grid happens to lie. Hourglass control is on there.
    levels
        Meshes of 8, 16, 32, ... divisions.

    Raises
    ------
    InputError
        If one of them is something else.
    """

    coated: bool = False
    layers: int = 2
    levels: int = 3

    name: ClassVar[str] = "inclusion"
    title: ClassVar[str] = "Stiff disc in a soft plate"
    dim: ClassVar[int] = 2
    methods: ClassVar[tuple[str, ...]] = ("cpdi2", "enriched-cpdi2", "fem")
    norms: ClassVar[dict[str, str]] = {
        "inside": "stress in the disc, uniform in truth: rms error over all its domains, relative",
        "largest": "largest error of stress of a domain at an interface, over the stress in the disc",
        "outside": "stress outside the disc: rms error, relative",
        "inside_order": "order with which `inside` falls with the domains' size",
        "largest_order": "order with which `largest` falls",
    }

    def __post_init__(self) -> None:
        if not isinstance(self.coated, bool):
            raise InputError(f"{self.name}: coated = {self.coated!r}; true and false are allowed")
        whole(f"{self.name}: layers", self.layers, 0)
        if whole(f"{self.name}: levels", self.levels) > 5:
            raise InputError(f"{self.name}: levels = {self.levels} must be from 1 to 5")

    @property
    def radii(self) -> tuple[float, ...]:
        """Radii of the interfaces [m]."""
        return (RADIUS, COATING) if self.coated else (RADIUS,)

    @property
    def moduli(self) -> dict[str, float]:
        """Young's modulus [Pa] of disc, coating and plate."""
        coating = {"coating": 3e6} if self.coated else {}
        return {"disc": 1e7, **coating, "plate": 1e6}

    @property
    def ladder(self) -> tuple[int, ...]:
        """Divisions of an eighth of a circle, level by level."""
        return tuple(COARSEST * 2**level for level in range(self.levels))

    @property
    def exact(self) -> Inclusion:
        """The reference solution."""
        from matpoint.reference.inclusion import Inclusion  # noqa: PLC0415 (loaded when used)

        youngs = tuple(self.moduli.values())
        return Inclusion(self.radii, youngs, (POISSON,) * len(youngs), (STRAIN, 0.0, 0.0))

    def parts(self, divisions: int) -> list[Domains]:
        """Return the domains of disc, coating and plate."""
        from matpoint.inclusion_mesh import mesh_inclusion  # noqa: PLC0415 (loaded when used)

        return mesh_inclusion(2, self.radii, SIZE, divisions)

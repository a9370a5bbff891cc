"""Tables for regions and meshes in case files."""

from __future__ import annotations

from typing import Annotated, Literal, Union

from pydantic import BaseModel, ConfigDict, Field


class Table(BaseModel):
    """Base of all tables: unknown keys, wrong types, NaN and infinities are refused."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True, allow_inf_nan=False)


Vector = Annotated[list[float], Field(min_length=1, max_length=3)]
Pair = Annotated[list[float], Field(min_length=2, max_length=2)]


class BoxRegion(Table):
    """A box along the axes."""

    shape: Literal["box"]
    lower: Vector
    upper: Vector


class BallRegion(Table):
    """A ball; a disc in 2-D."""

    shape: Literal["ball"]
    centre: Vector
    radius: float


class AnnulusRegion(Table):
    """A ring around the z axis, or a sector of one; angles in radians."""

    shape: Literal["annulus"]
    inner: float
    outer: float
    angles: Pair | None = None
    centre: Vector = [0.0, 0.0]


class PolygonRegion(Table):
    """A polygon in the x-y plane."""

    shape: Literal["polygon"]
    points: list[Pair]


class HalfSpaceRegion(Table):
    """The side of a plane that its normal points away from."""

    shape: Literal["half-space"]
    point: Vector
    normal: Vector


class CombinedRegion(Table):
    """A union, intersection, or the first without the others."""

    shape: Literal["union", "difference", "intersection"]
    of: Annotated[list[RegionTable], Field(min_length=2, max_length=50)]


RegionTable = Annotated[
    Union[BoxRegion, BallRegion, AnnulusRegion, PolygonRegion, HalfSpaceRegion, CombinedRegion],  # noqa: UP007
    Field(discriminator="shape"),
]
CombinedRegion.model_rebuild()


class BoxMesh(Table):
    """Equal lines, quadrilaterals or hexahedra."""

    shape: Literal["box"]
    lower: Vector
    upper: Vector
    divisions: Annotated[list[int], Field(min_length=1, max_length=3)]


class AnnulusMesh(Table):
    """A ring, or a sector of one, in quadrilaterals; angles in radians."""

    shape: Literal["annulus"]
    inner: float
    outer: float
    divisions: Annotated[list[int], Field(min_length=2, max_length=2)]
    angles: Pair = [0.0, 1.5707963267948966]
    centre: Pair = [0.0, 0.0]


class ArrayMesh(Table):
    """Vertices and cells written out."""

    shape: Literal["arrays"]
    kind: Literal["line", "quad", "hex", "tri", "tet"]
    vertices: list[Vector]
    cells: list[list[int]]


class ExtrusionMesh(Table):
    """A mesh of quadrilaterals drawn along z to hexahedra, through levels of z [m]."""

    shape: Literal["extrusion"]
    base: Annotated[BoxMesh | AnnulusMesh | ArrayMesh, Field(discriminator="shape")]
    heights: Annotated[list[float], Field(min_length=2)]


class FileMesh(Table):
    """A group of a mesh file (Gmsh's .msh, or .vtu); a relative path begins at the case file's folder.

    All groups of a file must be named by bodies, but for those that one of them lists in ``ignore``.
    """

    shape: Literal["file"]
    path: Annotated[str, Field(min_length=1, max_length=1000)]
    group: str
    ignore: list[str] = []


MeshTable = Annotated[
    BoxMesh | AnnulusMesh | ArrayMesh | ExtrusionMesh | FileMesh, Field(discriminator="shape")
]

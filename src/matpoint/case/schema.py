"""The tables of a case file."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, GetJsonSchemaHandler
from pydantic_core import CoreSchema

from matpoint.case.describe import OneOf
from matpoint.case.shapes import MeshTable, RegionTable, Table, Vector

Formula = Annotated[str, Field(max_length=500)]
Component = float | Formula


class GridTable(Table):
    """The background grid."""

    lower: Vector
    upper: Vector
    cell: float | Vector


class MaterialTable(BaseModel):
    """A material: ``law`` and its parameters."""

    model_config = ConfigDict(extra="allow", strict=True, frozen=True, allow_inf_nan=False)

    law: str

    @classmethod
    def __get_pydantic_json_schema__(cls, core: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        """Describe the built-in laws, so that editors complete their parameters; plugins may add others."""
        from matpoint.case.describe import material_schemas  # noqa: PLC0415 (only for `schema`)

        return {"anyOf": material_schemas()}


class BodyTable(Table):
    """A region or a mesh of one material."""

    material: str
    name: str = ""
    region: RegionTable | None = None
    mesh: MeshTable | None = None
    per_cell: int | Annotated[list[int], Field(min_length=1, max_length=3)] = 2
    velocity: Annotated[list[Component], Field(min_length=1, max_length=3)] = [0.0]


class InterpolationTable(Table):
    """The method, and its own options."""

    method: Annotated[str, OneOf("matpoint.interpolation", "METHODS")]
    layers: int | None = None
    where: Literal["interfaces", "all"] | RegionTable | None = None
    hourglass: float | None = None
    stretch: str | None = None
    on_inversion: str | None = None
    basis: Literal["linear", "bspline2", "bspline3"] | None = None
    degree: int | None = None
    velocity_degree: int | None = None
    points: int | None = None
    support: float | None = None
    reproject: bool | None = None
    keep_stress: bool | None = None
    boxes: bool | None = None
    tolerance: float | None = None
    limit: float | None = None
    raw: bool | None = None
    basis_degree: int | None = None


class SchemeTable(Table):
    """The order of stages and the velocity transfer."""

    order: Literal["usl", "usf", "musl"] | None = None
    transfer: Literal["flip", "pic", "apic", "xpic", "fmpm"] = "flip"
    blend: float | None = None
    terms: int | None = None


class PlaneTable(Table):
    """A grid plane."""

    axis: Literal["x", "y", "z"]
    at: float
    side: Literal["lower", "upper"] | None = None


class SurfaceTable(Table):
    """A boundary set of one body."""

    name: Annotated[str, Field(min_length=1, max_length=200)]
    body: str | None = None


SurfaceName = Annotated[str, Field(min_length=1, max_length=200)] | SurfaceTable


class BoundaryTable(Table):
    """A condition on the velocity: of nodes on a plane or in a region, or of corners of domains."""

    kind: Literal["fixed", "roller", "symmetry", "velocity"]
    plane: PlaneTable | None = None
    region: RegionTable | None = None
    surface: SurfaceName | None = None
    corners: RegionTable | None = None
    normal: Vector | None = None
    velocity: Annotated[list[Component], Field(min_length=1, max_length=3)] | None = None


class LoadTable(Table):
    """Gravity, a body force (expressions of X, Y, Z, x, y, z, t), or a load on faces of domains."""

    kind: Literal["gravity", "body-force", "pressure", "traction"]
    value: Annotated[list[Component], Field(min_length=1, max_length=3)] | float
    surface: SurfaceName | None = None
    per: Literal["initial", "current"] | None = None
    ramp: float = 0.0
    history: Formula | None = None


class DampingTable(Table):
    """Mass-proportional (``rate``) or local damping (``factor``)."""

    kind: Literal["none", "mass", "local"]
    rate: float | None = None
    factor: float | None = None


class TimeTable(Table):
    """End time, and a fixed ``step`` or a share ``cfl`` of the stable one.

    ``sample_every`` and ``sort_every`` are steps between two entries of the ledger, and between two sorts
    of the particles by cell.
    """

    end: float
    step: float | None = None
    cfl: float | None = None
    largest: float | None = None
    allow_unstable: bool = False
    sample_every: Annotated[int, Field(ge=1)] | None = None
    sort_every: Annotated[int, Field(ge=1)] | None = None


class TriggerTable(Table):
    """When something is written: exactly one of the three."""

    every_steps: int | None = None
    every_time: float | None = None
    at: list[float] | None = None


class ProbeTable(Table):
    """A particle to follow."""

    name: Annotated[str, Field(min_length=1, max_length=80)]
    at: Vector
    field: Annotated[str, OneOf("matpoint.output.history", "FIELDS")] = "displacement"
    component: str = "x"


class HistoryTable(TriggerTable):
    """Quantities and particles over time, in history.csv."""

    quantities: list[Annotated[str, OneOf("matpoint.quantities", "QUANTITIES")]] = []
    probes: list[ProbeTable] = []
    figure: bool = False


class FigureTable(TriggerTable):
    """Pictures of the particles; without a trigger at the end only."""

    colour: Annotated[str, OneOf("matpoint.output.figures", "COLOURS")] = "von_mises"
    name: Annotated[str, Field(min_length=1, max_length=80)] = "particles"


class OutputTable(Table):
    """What a run writes besides its summary."""

    vtk: TriggerTable | None = None
    history: HistoryTable | None = None
    checkpoint: TriggerTable | None = None
    figures: list[FigureTable] = []


class ProblemTable(BaseModel):
    """A verification problem by name, with its parameters."""

    model_config = ConfigDict(extra="allow", strict=True, frozen=True, allow_inf_nan=False)

    name: Annotated[str, OneOf("matpoint.problems", "PROBLEMS")]


class CaseTable(Table):
    """A case: all that a run needs.

    A case with a ``problem`` takes grid, materials, bodies, boundaries, loads and damping from it.
    """

    title: str = ""
    interpolation: InterpolationTable
    time: TimeTable
    grid: GridTable | None = None
    materials: dict[str, MaterialTable] = {}
    bodies: list[BodyTable] = []
    scheme: SchemeTable = SchemeTable()
    boundaries: list[BoundaryTable] = []
    loads: list[LoadTable] = []
    damping: DampingTable | None = None
    output: OutputTable = OutputTable()
    problem: ProblemTable | None = None

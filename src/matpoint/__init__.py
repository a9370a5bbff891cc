"""matpoint: the Material Point Method, from linear hats to enriched CPDI2.

Every public name is importable from here; what it needs is loaded when it is first used.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

from matpoint._version import __version__

_PUBLIC: dict[str, tuple[str, ...]] = {
    "errors": ("InputError", "MatpointError", "RunError"),
    "grid": ("Grid",),
    "regions": (
        "Annulus",
        "Ball",
        "Box",
        "Difference",
        "HalfSpace",
        "Intersection",
        "Polygon",
        "Region",
        "Union",
        "Where",
    ),
    "domains": ("Domains", "Kind"),
    "meshes": ("domains_from_arrays", "extrude", "mapped", "mesh_annulus", "mesh_box"),
    "inclusion_mesh": ("mesh_inclusion",),
    "meshfile": ("Mesh", "read_mesh"),
    "fill": ("fill",),
    "body": ("Body",),
    "deformed": ("Start",),
    "particles": ("Particles",),
    "vertices": ("Vertices",),
    "interpolation": (
        "CPDI1",
        "CPDI2",
        "CPGIMP",
        "IMLS",
        "METHODS",
        "MLS",
        "TLS",
        "UGIMP",
        "BSpline",
        "EnrichedCPDI2",
        "Interpolation",
        "Linear",
        "SplineIMLS",
    ),
    "places": ("Corners", "Plane", "Surface"),
    "boundary": ("Fixed", "PrescribedVelocity", "Roller", "Symmetry"),
    "face_loads": ("Pressure", "Traction"),
    "loads": ("BodyForce", "Gravity", "LocalDamping", "MassDamping", "NoDamping"),
    "scheme": ("MUSL", "SCHEMES", "USF", "USL", "Scheme", "Stage"),
    "transfers": ("APIC", "FLIP", "FMPM", "PIC", "TRANSFERS", "XPIC"),
    "timestep": ("CFL", "FixedStep"),
    "simulation": ("Simulation",),
    "ledger": ("Ledger", "LedgerEntry"),
    "output": (
        "VTKHDF",
        "AtTimes",
        "Checkpoint",
        "EverySteps",
        "EveryTime",
        "History",
        "HistoryFigure",
        "ParticleFigure",
        "Probe",
        "Progress",
        "Recorder",
        "Summary",
        "prepare_folder",
        "resume",
    ),
    "quantities": ("QUANTITIES", "Quantity"),
    "materials": (
        "MATERIALS",
        "Hencky",
        "LinearElastic",
        "Material",
        "NeoHookean",
        "NewtonianFluid",
        "SaintVenantKirchhoff",
        "UserMaterial",
        "VonMises",
        "material_from",
        "register_material",
    ),
    "materials.driver": ("Response", "drive", "shear", "uniaxial"),
    "citations": ("CITATIONS", "bibtex"),
    "study": ("Study", "converge"),
}
_HOME = {name: module for module, names in _PUBLIC.items() for name in names}

__all__ = ["__version__", *_HOME]  # noqa: PLE0604 (names of the table above)


def __getattr__(name: str) -> Any:
    """Load a public name where it lives."""
    if name not in _HOME:
        raise AttributeError(f"module 'matpoint' has no attribute {name!r}")
    value = getattr(import_module(f"matpoint.{_HOME[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *_HOME})

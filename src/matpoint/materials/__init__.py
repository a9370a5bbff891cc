"""Materials: one file each, one line each in the registry below."""

from __future__ import annotations

from matpoint.kernels.stress import stress_kernel
from matpoint.materials.contract import Material, stress_law
from matpoint.materials.fluid import NewtonianFluid
from matpoint.materials.hencky import Hencky
from matpoint.materials.linear import LinearElastic
from matpoint.materials.neohookean import NeoHookean
from matpoint.materials.registry import MATERIALS, material_from, register_material
from matpoint.materials.svk import SaintVenantKirchhoff
from matpoint.materials.user import UserMaterial
from matpoint.materials.vonmises import VonMises

register_material("neo-hookean", NeoHookean)
register_material("hencky", Hencky)
register_material("saint-venant-kirchhoff", SaintVenantKirchhoff)
register_material("linear-elastic", LinearElastic)
register_material("newtonian-fluid", NewtonianFluid)
register_material("von-mises", VonMises)

__all__ = [
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
    "stress_kernel",
    "stress_law",
]

"""The verification problems. To add one: a file here, a line below."""

from __future__ import annotations

from matpoint.problem import Problem
from matpoint.problems.bimaterial_bar import BimaterialBar
from matpoint.problems.bimaterial_ring import BimaterialRing
from matpoint.problems.inclusion import InclusionProblem
from matpoint.problems.laminate import Laminate
from matpoint.problems.manufactured import ManufacturedProblem
from matpoint.problems.mms_rings import ExpandingRing, Vortex
from matpoint.problems.mms_waves import FullWave, HalfWave, Waves2D, Waves3D
from matpoint.problems.sheared_block import ShearedBlock
from matpoint.problems.sphere_inclusion import SphereInclusion

#: Name, as on the command line -> the class.
PROBLEMS: dict[str, type[Problem]] = {
    problem.name: problem
    for problem in (
        BimaterialBar, BimaterialRing, InclusionProblem, Laminate, ShearedBlock, SphereInclusion,
        FullWave, HalfWave, Waves2D, Waves3D, Vortex, ExpandingRing,
    )
}  # fmt: skip

__all__ = [
    "PROBLEMS",
    "BimaterialBar",
    "BimaterialRing",
    "ExpandingRing",
    "FullWave",
    "HalfWave",
    "InclusionProblem",
    "Laminate",
    "ManufacturedProblem",
    "ShearedBlock",
    "SphereInclusion",
    "Vortex",
    "Waves2D",
    "Waves3D",
]

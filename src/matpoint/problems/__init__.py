"""The verification problems. To add one: a file here, a line below."""

from __future__ import annotations

from matpoint.problem import Problem
from matpoint.problems.bimaterial_bar import BimaterialBar
from matpoint.problems.bimaterial_ring import BimaterialRing
from matpoint.problems.manufactured import ManufacturedProblem
from matpoint.problems.mms_rings import ExpandingRing, Vortex
from matpoint.problems.mms_waves import FullWave, HalfWave, Waves2D, Waves3D

#: Name, as on the command line -> the class.
PROBLEMS: dict[str, type[Problem]] = {
    problem.name: problem
    for problem in (
        BimaterialBar, BimaterialRing, FullWave, HalfWave, Waves2D, Waves3D, Vortex, ExpandingRing,
    )
}  # fmt: skip

__all__ = [
    "PROBLEMS",
    "BimaterialBar",
    "BimaterialRing",
    "ExpandingRing",
    "FullWave",
    "HalfWave",
    "ManufacturedProblem",
    "Vortex",
    "Waves2D",
    "Waves3D",
]

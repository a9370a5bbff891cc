"""The verification problems. To add one: a file here, a line below."""

from __future__ import annotations

from matpoint.problem import Problem
from matpoint.problems.bimaterial_bar import BimaterialBar
from matpoint.problems.inclusion import InclusionProblem
from matpoint.problems.sphere_inclusion import SphereInclusion

#: Name, as on the command line -> the class.
PROBLEMS: dict[str, type[Problem]] = {
    problem.name: problem for problem in (BimaterialBar, InclusionProblem, SphereInclusion)
}

__all__ = ["PROBLEMS", "BimaterialBar", "InclusionProblem", "SphereInclusion"]

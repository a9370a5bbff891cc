"""The interpolations. To add one: a file here, a line below, a line in the property test."""

from __future__ import annotations

from matpoint.interpolation.bspline import BSpline
from matpoint.interpolation.contract import Interpolation
from matpoint.interpolation.cpdi import CPDI2
from matpoint.interpolation.cpdi1 import CPDI1
from matpoint.interpolation.enriched import EnrichedCPDI2
from matpoint.interpolation.gimp import CPGIMP, UGIMP
from matpoint.interpolation.linear import Linear
from matpoint.interpolation.reconstruction import IMLS, MLS, SplineIMLS
from matpoint.interpolation.taylor import TLS

#: Method name -> the interpolation with its default parameters.
METHODS: dict[str, Interpolation] = {
    choice.name: choice
    for choice in (
        Linear(),
        UGIMP(),
        CPGIMP(),
        BSpline(2),
        BSpline(3),
        CPDI1(),
        CPDI2(),
        EnrichedCPDI2(),
        MLS(),
        IMLS(),
        SplineIMLS(),
        TLS(),
    )
}

__all__ = [
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
]

"""Manufactured solutions: from a displacement u(X, t) in sympy and a material to all fields of a run."""

from __future__ import annotations

from matpoint.mms.coordinates import COORDINATES, TIME, X, Y, Z, t
from matpoint.mms.fields import Manufactured
from matpoint.mms.laws import LAWS, first_piola
from matpoint.mms.solutions import expanding_ring, full_wave, half_wave, standing_waves, vortex

__all__ = [
    "COORDINATES",
    "LAWS",
    "TIME",
    "Manufactured",
    "X",
    "Y",
    "Z",
    "expanding_ring",
    "first_piola",
    "full_wave",
    "half_wave",
    "standing_waves",
    "t",
    "vortex",
]

"""The symbols that displacements are written in."""

from __future__ import annotations

import sympy as sp

#: Reference coordinates [m] and time [s].
X, Y, Z, t = sp.symbols("X Y Z t", real=True)
COORDINATES: tuple[sp.Symbol, ...] = (X, Y, Z)
TIME: sp.Symbol = t

"""Expressions as NumPy functions of arrays."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import sympy as sp


def compiled(
    arguments: Sequence[sp.Symbol], expressions: Sequence[sp.Expr]
) -> Callable[[Any, int], np.ndarray]:
    """Return a function of the arguments' values and of their number n, which gives an array (m, n).

    Common parts are computed once; rows that are constant are not computed at all.

    Parameters
    ----------
    arguments
        The symbols that the expressions hold.
    expressions
        The m rows.
    """
    constant = np.array([float(e) if e.is_number else 0.0 for e in expressions])
    rows = [k for k, e in enumerate(expressions) if not e.is_number]
    function = sp.lambdify(
        list(arguments), [expressions[k] for k in rows], modules=["numpy", "scipy"], cse=True
    )

    def evaluate(values: Any, n: int) -> np.ndarray:
        found = np.empty((len(constant), n))
        found[:] = constant[:, None]
        for row, value in zip(rows, function(*values), strict=True):
            found[row] = (
                np.where(np.imag(value) == 0, np.real(value), np.nan) if np.iscomplexobj(value) else value
            )
        return found

    return evaluate

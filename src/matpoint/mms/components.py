"""What a user gives as a displacement: expressions that have derivatives, checked before any is taken."""

from __future__ import annotations

import math
from collections.abc import Sequence
from numbers import Real
from typing import Any

import sympy as sp
from sympy.matrices.expressions.matexpr import MatrixExpr

from matpoint.errors import InputError
from matpoint.mms.coordinates import COORDINATES, TIME

_WHERE = "manufactured solution"
_LONGEST = 80  # characters of an expression in a message
_ENDLESS = (sp.nan, sp.zoo, sp.oo, -sp.oo)
# What derivatives hold where sympy can't take them as functions.
_KINKS = (sp.DiracDelta, sp.Derivative, sp.Subs)


def told(given: Any) -> str:
    """Return what was given, as one line that is not too long."""
    text = " ".join((str(given) if isinstance(given, sp.Basic | sp.MatrixBase) else repr(given)).split())
    return text if len(text) <= _LONGEST else text[: _LONGEST - 4] + " ..."


def refuse_components(law: Any) -> None:
    """Refuse what is no displacement: anything but 1 to 3 real expressions of the coordinates and time.

    Raises
    ------
    InputError
        With the component, and what is allowed.
    """
    if not isinstance(law, list | tuple | sp.Tuple) or not 1 <= len(law) <= 3:
        raise InputError(
            f"{_WHERE}: the displacement must be a list of 1 to 3 components, for instance (u,); given is"
            f" {told(law)}"
        )
    allowed = {*COORDINATES[: len(law)], TIME}
    for k, component in enumerate(law):
        _refuse_component(f"{_WHERE}: component {k}", component, allowed)


def _refuse_component(what: str, given: Any, allowed: set[sp.Symbol]) -> None:
    names = ", ".join(sorted(str(s) for s in allowed))
    if not isinstance(given, sp.Expr):
        if isinstance(given, bool) or not isinstance(given, Real):
            raise InputError(
                f"{what} = {told(given)} must be a sympy expression of {names} from matpoint.mms, or a number"
            )
        if not math.isfinite(given):
            raise InputError(f"{what} = {given!r} must be finite")
        return
    if isinstance(given, MatrixExpr):
        raise InputError(f"{what} = {told(given)} must be a single expression, not a matrix")
    if given.free_symbols - allowed:
        unknown = ", ".join(sorted(str(s) for s in given.free_symbols - allowed))
        raise InputError(
            f"{what} holds {unknown}; only {names} as imported from matpoint.mms are allowed (symbols of"
            " sympy with the same names are others)"
        )
    refuse_unreal(what, given)
    if given.is_number:
        refuse_unreal_number(what, given)


def refuse_unreal(what: str, given: sp.Basic) -> None:
    """Refuse an expression, or a matrix of them, that is not real and finite by what it holds.

    Raises
    ------
    InputError
        If it holds the imaginary unit, nan or an infinity.
    """
    if given.has(sp.I):
        raise InputError(
            f"{what} = {told(given)} holds the imaginary unit I; only real expressions are allowed"
        )
    if given.has(*_ENDLESS):
        raise InputError(
            f"{what} = {told(given)} holds nan or an infinity; only finite expressions are allowed"
        )


def refuse_unreal_number(what: str, given: sp.Expr) -> None:
    """Refuse a constant that no real number stands for.

    Raises
    ------
    InputError
        If it is complex, or too large.
    """
    try:
        fine = math.isfinite(float(given))
    except (TypeError, OverflowError):
        fine = False
    if not fine:
        raise InputError(f"{what} = {told(given)} must be a finite, real number")


def refuse_kinks(what: str, given: Any, derivatives: Sequence[sp.Expr]) -> None:
    """Refuse an expression whose derivatives are no functions, as that of the sign which Abs has.

    Raises
    ------
    InputError
        With what is left in the derivatives.
    """
    for derivative in derivatives:
        found = derivative.atoms(*_KINKS)
        if found:
            left = min(found, key=str)
            raise InputError(
                f"{what} = {told(given)} can't be differentiated twice: {told(left)} is left; Abs, sign,"
                " Heaviside, Min, Max, floor and functions without a formula are not allowed (where the"
                " argument of Abs keeps its sign, leave Abs out)"
            )
        refuse_unreal(f"{what} = {told(given)}: its derivative", derivative)

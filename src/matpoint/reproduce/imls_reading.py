"""What the convergence study says to the text of the IMLS paper, in sentences with numbers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from matpoint.study import fitted, neighbours

Entries = Mapping[str, Sequence[Mapping[str, Any]]]
_NORM = "velocity"
#: The fewest cells that resolve the wave: 8 don't, and a slope through them says that, not a method's order.
FIRST = 16


def _errors(entries: Sequence[Mapping[str, Any]]) -> str:
    return ", ".join("failed" if e["failed"] else f"{e[_NORM]:.3g}" for e in entries)


def _orders(entries: Sequence[Mapping[str, Any]]) -> str:
    return ", ".join("-" if o is None else f"{o:.2f}" for o in neighbours(entries, _NORM)[1:])


def _gap(a: Sequence[Mapping[str, Any]], b: Sequence[Mapping[str, Any]]) -> str:
    """Return the largest relative difference of velocity errors."""
    both = [(x[_NORM], y[_NORM]) for x, y in zip(a, b, strict=True) if not x["failed"] and not y["failed"]]
    return f"{max(abs(x - y) / y for x, y in both):.1e}" if both else "nothing to compare"


def resolved(entries: Sequence[Mapping[str, Any]]) -> list[Mapping[str, Any]]:
    """Return the entries that orders are fitted to, all but those whose cells do not resolve the wave."""
    return [e for e in entries if e["cells"] >= FIRST]


def _slope(entries: Sequence[Mapping[str, Any]]) -> str:
    slope = fitted(resolved(entries), _NORM)
    return "none" if slope is None else f"{slope:.2f}"


def reading(found: Entries) -> list[str]:
    """Return the section: where our runs agree with the paper's text and where they do not.

    Parameters
    ----------
    found
        Method -> entries of the study.
    """
    sizes = ", ".join(str(e["cells"]) for e in found["imls"])
    cpdi, imls, printed = found["cpdi2"], found["imls"], found["imls-as-printed"]
    coded = found["imls-as-coded"]
    last = imls[-1]["cells"]
    return [
        "## An honest reading", "",
        f"RMS errors of velocity [m/s] at T on {sizes} cells; fitted orders, here and in the tables, are from"
        f" {FIRST} cells on.", "",
        f"* MPM does not converge, as the paper says: {_errors(found['mpm'])}.",
        f"* CPDI keeps its order to {last} cells: {_errors(cpdi)}, orders {_orders(cpdi)}, fitted"
        f" {_slope(cpdi)}. The paper says that it loses it beyond 16 cells; ours does not.",
        f"* IMLS is of second order: {_errors(imls)}, fitted {_slope(imls)}. On {last} cells it stands at"
        f" {imls[-1][_NORM] / cpdi[-1][_NORM]:.2f} of CPDI2's error; on coarse ones above it.",
        f"* As the authors coded it (degree 1, one point, no re-projection): {_errors(coded)}, fitted"
        f" {_slope(coded)}: the same order with a larger error.",
        f"* As printed, with the velocities mapped once more (T 36): {_errors(printed)}, orders"
        f" {_orders(printed)}" + (": on 128 cells the second order is lost." if last == 128 else "."),
        f"* MLS and IMLS differ by {_gap(found['mls'], imls)} of the error: with shifted and scaled monomials"
        " no moment matrix is ill-conditioned here, and orthogonal polynomials change nothing but rounding."
        f" With raw monomials MLS differs by {_gap(found['mls-raw'], imls)}.",
        f"* The third-order scheme, `spline-imls`: {_errors(found['spline-imls'])}, fitted"
        f" {_slope(found['spline-imls'])}.",
        "* T 47 prints pi where pi^2 belongs; a literal copy cannot converge. u and stress are zero at T, a"
        " whole period, so that the tables at T/4 say more of both.", "",
    ]  # fmt: skip

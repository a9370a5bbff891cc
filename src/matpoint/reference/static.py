"""Static equilibrium of a finite-element solid by Newton's method."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from matpoint.errors import InputError, RunError
from matpoint.reference.prescribed import Prescribed, Table, nodal_values
from matpoint.reference.solid import Solid

if TYPE_CHECKING:
    from scipy.sparse import csc_array


@dataclass(frozen=True, eq=False)
class StaticSolution:
    """Equilibrium of a solid.

    Attributes
    ----------
    displacement : ndarray, shape (nv, d)
        [m]
    stress : ndarray, shape (n, 6)
        Cauchy stress of the cells [Pa], mean over the current volume: xx, yy, zz, xy, yz, xz.
    reactions : ndarray, shape (nv, d)
        Forces that hold the prescribed components [N], 0 elsewhere.
    iterations : tuple of int
        Newton's, of each increment.
    """

    displacement: np.ndarray
    stress: np.ndarray
    reactions: np.ndarray
    iterations: tuple[int, ...]


def solve_static(
    solid: Solid,
    *,
    prescribed: Sequence[Prescribed],
    body: Callable[[np.ndarray], np.ndarray] | np.ndarray | None = None,
    nodal: np.ndarray | None = None,
    increments: int = 1,
    tolerance: float = 1e-10,
) -> StaticSolution:
    """Solve for the equilibrium under dead loads, in equal increments of load and displacement.

    Parameters
    ----------
    solid
        The solid.
    prescribed
        Prescribed displacements; without rotation and translation held there is no solution.
    body
        Acceleration [m/s^2]: (d,), (nv, d), or a function of the initial positions (nv, d) [m]; the
        lumped mass multiplies it.
    nodal
        Dead forces [N], shape (nv, d) or (d,).
    increments
        How many.
    tolerance
        Residual relative to the largest nodal force at which an increment has converged.

    Raises
    ------
    InputError
        If an argument has a wrong shape or value, or nothing is prescribed.
    RunError
        If Newton's method fails; more increments may help.
    """
    if increments < 1 or not 0 < tolerance < 1:
        raise InputError(
            f"static: increments = {increments} must be at least 1, tolerance = {tolerance!r} in (0, 1)"
        )
    table = Table(solid, prescribed)
    if not table.fixed.any():
        raise InputError("static: no displacement is prescribed, so nothing holds the solid")
    load = np.zeros_like(table.fixed, dtype=float)
    if body is not None:
        given = body(solid.vertices) if callable(body) else body
        load += solid.mass * nodal_values("body", given, solid)
    if nodal is not None:
        load += nodal_values("nodal", nodal, solid)
    u, counts = np.zeros_like(load), []
    for k in range(1, increments + 1):
        share = k / increments
        target = u.copy()
        table.put(target, share, share)
        counts.append(_newton(solid, u, target - u, share * load, table.fixed, tolerance, k))
    reactions = np.where(table.fixed, solid.forces(u)[0] - load, 0.0)
    return StaticSolution(u.T.copy(), solid.stress(u), reactions.T, tuple(counts))


def _newton(
    solid: Solid,
    u: np.ndarray,
    jump: np.ndarray,
    load: np.ndarray,
    fixed: np.ndarray,
    tolerance: float,
    increment: int,
) -> int:
    """Bring u (d, nv) to equilibrium in place; the first iteration adds the prescribed jump."""
    given = np.flatnonzero(fixed.T)
    free = np.flatnonzero(~fixed.T)
    internal, _ = solid.forces(u)
    for iteration in range(1, 31):
        K = solid.stiffness(u)
        change = jump.T.ravel()
        right = (load - internal).T.ravel()[free] - K[free][:, given] @ change[given]
        change[free] = _solve(K[free][:, free], right, increment)
        move = change.reshape(u.shape[::-1]).T
        jump = np.zeros_like(jump)
        scale = 1.0
        internal, J = solid.forces(u + move)
        while not J.min() > 0 and iteration > 1 and scale > 1e-3:  # shorten a step that turns a cell over
            scale *= 0.5
            internal, J = solid.forces(u + scale * move)
        if not J.min() > 0:
            raise RunError(
                f"increment {increment} turns a finite-element cell over; take more increments",
                step=increment,
                time=0.0,
            )
        u += scale * move
        size = max(np.abs(internal).max(), np.abs(load).max(), np.finfo(float).tiny)
        if np.abs((load - internal).T.ravel()[free]).max(initial=0.0) <= tolerance * size:
            return iteration
    raise RunError(f"increment {increment} did not converge; take more increments", step=increment, time=0.0)


def _solve(K: csc_array, right: np.ndarray, increment: int) -> np.ndarray:
    from scipy.sparse.linalg import splu  # noqa: PLC0415 (loaded when used)

    if len(right) == 0:
        return right
    try:
        factors = splu(K, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    except RuntimeError:
        raise RunError(
            f"increment {increment}: the tangent is singular; hold the solid, or take more increments",
            step=increment,
            time=0.0,
        ) from None
    return factors.solve(right)

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
        Newton's, of each increment that converged.
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
        How many; one that fails is halved, down to a thousandth.
    tolerance
        Residual relative to the largest nodal force at which an increment has converged.

    Raises
    ------
    InputError
        If an argument has a wrong shape or value, or nothing is prescribed.
    RunError
        If Newton's method fails all the same; the error's time is the share of the load.
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
    done, size = 0.0, 1.0 / increments
    while done < 1.0:
        share = 1.0 if done + size > 1.0 - 1e-9 else done + size
        trial, target = u.copy(), u.copy()
        table.put(target, share, share)
        try:
            counts.append(_newton(solid, trial, target - u, share * load, table.fixed, tolerance))
        except RunError as error:
            size *= 0.5
            if size * increments < 1e-3:
                raise RunError(error.cause, step=len(counts) + 1, time=share) from None
        else:
            u, done = trial, share
    reactions = np.where(table.fixed, solid.forces(u)[0] - load, 0.0)
    return StaticSolution(u.T.copy(), solid.stress(u), reactions.T, tuple(counts))


def _newton(
    solid: Solid,
    u: np.ndarray,
    jump: np.ndarray,
    load: np.ndarray,
    fixed: np.ndarray,
    tolerance: float,
) -> int:
    """Bring u (d, nv) to equilibrium in place; the first iteration adds the prescribed jump."""
    given = np.flatnonzero(fixed.T)
    free = np.flatnonzero(~fixed.T)
    internal, _ = solid.forces(u)
    for iteration in range(1, 21):
        K = solid.stiffness(u)
        change = jump.T.ravel()
        right = (load - internal).T.ravel()[free] - K[free][:, given] @ change[given]
        change[free] = _solve(K[free][:, free], right)
        move = change.reshape(u.shape[::-1]).T
        jump = np.zeros_like(jump)
        scale = 1.0
        internal, J = solid.forces(u + move)
        while not J.min() > 0 and iteration > 1 and scale > 1e-3:  # shorten a step that turns a cell over
            scale *= 0.5
            internal, J = solid.forces(u + scale * move)
        if not J.min() > 0:
            raise RunError("an increment of the load turns a finite-element cell over", step=0, time=0.0)
        u += scale * move
        size = max(np.abs(internal).max(), np.abs(load).max(), np.finfo(float).tiny)
        if np.abs((load - internal).T.ravel()[free]).max(initial=0.0) <= tolerance * size:
            return iteration
    raise RunError("Newton's method did not converge", step=0, time=0.0)


def _solve(K: csc_array, right: np.ndarray) -> np.ndarray:
    from scipy.sparse.linalg import splu  # noqa: PLC0415 (loaded when used)

    if len(right) == 0:
        return right
    try:
        factors = splu(K, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    except RuntimeError:
        raise RunError("the tangent is singular; is the solid held?", step=0, time=0.0) from None
    return factors.solve(right)

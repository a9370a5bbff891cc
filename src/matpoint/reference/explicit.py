"""Explicit runs of a finite-element solid with lumped mass."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from matpoint.errors import InputError, RunError
from matpoint.reference.prescribed import Prescribed, Table, nodal_values
from matpoint.reference.solid import Solid

Field = Callable[[np.ndarray, float], np.ndarray]


@dataclass(frozen=True, eq=False)
class SolidHistory:
    """What an explicit run of a solid leaves.

    Attributes
    ----------
    times : ndarray, shape (t,)
        [s]
    displacement : ndarray, shape (t, m, d)
        Of the vertices asked for [m].
    stress : ndarray, shape (t, c, 6)
        Cauchy stress of the cells asked for [Pa], mean over the current volume: xx, yy, zz, xy, yz, xz.
    kinetic, strain : ndarray, shape (t,)
        Energies of the whole solid [J]; velocities run half a step ahead of displacements.
    work : ndarray, shape (t,)
        Of what holds and drives the prescribed components, since the start [J].
    """

    times: np.ndarray
    displacement: np.ndarray
    stress: np.ndarray
    kinetic: np.ndarray
    strain: np.ndarray
    work: np.ndarray


def run_explicit(
    solid: Solid,
    *,
    step: float,
    steps: int,
    every: int = 1,
    prescribed: Sequence[Prescribed] = (),
    body: Field | np.ndarray | None = None,
    nodal: Field | np.ndarray | None = None,
    velocity: np.ndarray | None = None,
    damping: float = 0.0,
    nodes: np.ndarray | None = None,
    cells: np.ndarray | None = None,
) -> SolidHistory:
    """Run a solid from its initial, stress-free state.

    The step is that of the particle methods (symplectic Euler, stress last): f = M b - G^T P,
    v += f/M dt, prescribed velocities at the end of the step, u += v dt, F = 1 + G u.

    Parameters
    ----------
    solid
        The solid.
    step, steps
        Time step [s] and how many.
    every
        Steps between two samples; the initial state is sampled too.
    prescribed
        Prescribed velocities.
    body
        Acceleration [m/s^2], constant (d,), (nv, d), or a function of current positions (nv, d) [m]
        and time [s] that returns (nv, d); the lumped mass multiplies it.
    nodal
        Forces [N], given as ``body`` is.
    velocity
        Initial velocities [m/s], shape (nv, d) or (d,).
    damping
        Force per mass and velocity [1/s].
    nodes, cells
        Which vertices and cells to sample; all without.

    Raises
    ------
    InputError
        If the step is over the stability limit, or an argument has a wrong shape or value.
    RunError
        If a cell turns over.
    """
    _check(solid, step, steps, every, damping)
    table, force = Table(solid, prescribed), _Load(solid, body, nodal)
    nodes = np.arange(len(solid.vertices)) if nodes is None else np.asarray(nodes)
    cells = np.arange(len(solid.cells)) if cells is None else np.asarray(cells)
    u = np.zeros((solid.dim, len(solid.vertices)))
    v = u.copy() if velocity is None else nodal_values("velocity", velocity, solid).copy()
    table.put(v, 0.0)
    internal, _ = solid.forces(u)
    rows, work = [], 0.0

    def sample(time: float) -> None:
        kinetic = 0.5 * float((solid.mass * v * v).sum())
        rows.append((time, u.T[nodes], solid.stress(u)[cells], kinetic, solid.strain_energy(u), work))

    sample(0.0)
    for n in range(1, steps + 1):
        before = v.copy()
        v += (step / solid.mass) * (force((n - 1) * step, u) - internal) - (step * damping) * v
        free = v.copy()
        table.put(v, n * step)
        work += 0.5 * float((solid.mass * (v - free) * (v + before)).sum())
        u += step * v
        internal, J = solid.forces(u)
        if not J.min() > 0:
            cell = int(np.argmin(J)) // (len(J) // len(solid.cells))
            raise RunError(f"finite-element cell {cell} turned over", step=n, time=n * step)
        if n % every == 0:
            sample(n * step)
    return SolidHistory(*(np.array(column) for column in zip(*rows, strict=True)))


class _Load:
    """External nodal forces [N], shape (d, nv), of a time [s] and displacements (d, nv) [m]."""

    def __init__(
        self, solid: Solid, body: Field | np.ndarray | None, nodal: Field | np.ndarray | None
    ) -> None:
        self._solid, self._fields = solid, []
        self._constant = np.zeros(solid.vertices.shape[::-1])
        for name, given, factor in (("body", body, solid.mass), ("nodal", nodal, np.ones_like(solid.mass))):
            if callable(given):
                nodal_values(name, given(solid.vertices, 0.0), solid)
                self._fields.append((given, factor))
            elif given is not None:
                self._constant += factor * nodal_values(name, given, solid)

    def __call__(self, time: float, u: np.ndarray) -> np.ndarray:
        if not self._fields:
            return self._constant
        x = self._solid.vertices + u.T
        return self._constant + sum(factor * np.asarray(field(x, time)).T for field, factor in self._fields)


def _check(solid: Solid, step: float, steps: int, every: int, damping: float) -> None:
    if steps < 1 or every < 1:
        raise InputError(f"solid: steps = {steps} and every = {every} must be at least 1")
    if not 0 <= damping < np.inf:
        raise InputError(f"solid: damping = {damping!r} must not be negative")
    limit = solid.stable_step()
    if not 0 < step <= limit:
        raise InputError(f"solid: step = {step:.4g} s must be positive and at most {limit:.4g} s")

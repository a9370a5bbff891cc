"""Prescribed components of the motion of a finite-element solid."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from matpoint.errors import InputError
from matpoint.reference.solid import Solid


@dataclass(frozen=True, eq=False)
class Prescribed:
    """One component given at some vertices: a velocity in explicit runs, a displacement in static ones.

    Parameters
    ----------
    nodes
        Vertices, shape (m,).
    axis
        0, 1 or 2.
    value
        A number, or a function of initial positions (m, d) [m] and a time [s] that returns (m,)
        values. Velocities are in m/s. In a static solution displacements are in m; a number grows
        with the share of the load, and a function takes that share, from 0 to 1, as its time.
    """

    nodes: np.ndarray
    axis: int
    value: float | Callable[[np.ndarray, float], np.ndarray] = 0.0


class Table:
    """Prescribed components of a solid, checked, as lists of unknowns.

    Parameters
    ----------
    solid
        The solid.
    prescribed
        The conditions; a later one on the same component replaces an earlier one.

    Attributes
    ----------
    fixed : ndarray, shape (d, nv)
        True where a component is given.

    Raises
    ------
    InputError
        If a vertex or an axis is not there.
    """

    def __init__(self, solid: Solid, prescribed: Sequence[Prescribed]) -> None:
        self.fixed = np.zeros((solid.dim, len(solid.vertices)), dtype=bool)
        self._rows = []
        for condition in prescribed:
            nodes = np.atleast_1d(np.asarray(condition.nodes))
            if (
                not np.issubdtype(nodes.dtype, np.integer)
                or ((nodes < 0) | (nodes >= len(solid.vertices))).any()
            ):
                raise InputError(
                    f"prescribed: nodes must be whole numbers from 0 to {len(solid.vertices) - 1}"
                )
            if condition.axis not in range(solid.dim):
                raise InputError(f"prescribed: axis = {condition.axis!r} must be from 0 to {solid.dim - 1}")
            self.fixed[condition.axis, nodes] = True
            self._rows.append((nodes, condition.axis, condition.value, solid.vertices[nodes]))

    def put(self, target: np.ndarray, time: float, factor: float = 1.0) -> None:
        """Write the values at a time, numbers times a factor, into components of shape (d, nv)."""
        for nodes, axis, value, X in self._rows:
            target[axis, nodes] = value(X, time) if callable(value) else factor * value


def nodal_values(name: str, values: np.ndarray, solid: Solid) -> np.ndarray:
    """Return vectors at the vertices, given as (nv, d) or (d,), one component after the other: (d, nv)."""
    shape = solid.vertices.shape
    try:
        full = np.broadcast_to(np.asarray(values, dtype=float), shape)
    except (TypeError, ValueError):
        raise InputError(f"{name}: shape {np.shape(values)}; {shape} or ({solid.dim},) is needed") from None
    if not np.isfinite(full).all():
        raise InputError(f"{name}: the values must be finite")
    return full.T

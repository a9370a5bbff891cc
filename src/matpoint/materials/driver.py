"""A material at a single point: its response to a path of deformation, in plain Python.

The stress law is called uncompiled, so that a user may step through it with a debugger.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from matpoint.errors import InputError
from matpoint.kernels.laws import cauchy_stress
from matpoint.materials.contract import Array, Material

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, eq=False)
class Response:
    """What a material did along a path.

    Parameters
    ----------
    deformation_gradient
        The path, (m, 3, 3).
    stress
        Cauchy stress [Pa], (m, 6): xx, yy, zz, xy, yz, xz.
    state
        Internal variables, (m, S).
    """

    deformation_gradient: Array
    stress: Array
    state: Array


class _Point:
    """One material point on its way."""

    def __init__(self, material: Material) -> None:
        self._params = material.params
        self.F = np.eye(3)
        self.state = material.initial_state(1)[0]

    def stress_at(self, F: Array, dt: float) -> tuple[Array, Array]:
        """Return the stress (6,) and the state after one step to F, without taking it."""
        state = self.state.copy()
        L = (F @ np.linalg.inv(self.F) - np.eye(3)) / dt
        sigma = np.array(cauchy_stress(_tuples(self.F), _tuples(F), _tuples(L), dt, state, self._params))
        return sigma[[0, 1, 2, 0, 1, 0], [0, 1, 2, 1, 2, 2]], state

    def step(self, F: Array, dt: float) -> Array:
        """Take one step to F and return the stress, (6,)."""
        stress, state = self.stress_at(F, dt)
        self.F, self.state = F, state
        return stress


def _tuples(A: Array) -> Any:
    """Return an array (3, 3) as nested tuples of Python's floats."""
    return tuple(tuple(row) for row in A.tolist())


def drive(material: Material, F_history: npt.ArrayLike, dt: float = 1.0) -> Response:
    """Return the response to a path of deformation gradients, from the undeformed state.

    Parameters
    ----------
    material
        Any material.
    F_history
        Deformation gradients, (m, 3, 3), each reached in one step from the one before.
    dt
        Length of a step [s], > 0; only rate-dependent laws see it.

    Raises
    ------
    InputError
        The path is no (m, 3, 3) array, has a determinant ≤ 0 or a NaN, or dt is not > 0.
    """
    path = np.asarray(F_history, dtype=np.float64)
    if path.ndim != 3 or path.shape[1:] != (3, 3):
        raise InputError(f"drive: F_history must have the shape (m, 3, 3), not {path.shape}")
    if not np.isfinite(path).all() or (path.size and np.linalg.det(path).min() <= 0.0):
        raise InputError("drive: F_history must be finite with determinants > 0")
    if not (np.isfinite(dt) and dt > 0.0):
        raise InputError(f"drive: dt = {dt!r} is not allowed: it must be a finite number > 0 [s]")
    return _follow(material, len(path), lambda _point, k: path[k], dt)


def uniaxial(
    material: Material, stretches: npt.ArrayLike, lateral: str = "strain", dt: float = 1.0
) -> Response:
    """Return the response to stretching along x.

    Parameters
    ----------
    material
        Any material; an isotropic one for ``lateral="stress"``.
    stretches
        Stretches along x, > 0, (m,).
    lateral
        "strain": no lateral strain. "stress": the lateral stretch that leaves no lateral stress.
    dt
        Length of a step [s].

    Raises
    ------
    InputError
        A stretch is not > 0, ``lateral`` is neither word, or no lateral stretch frees the sides.
    """
    path = np.asarray(stretches, dtype=np.float64).reshape(-1)
    if not (np.isfinite(path).all() and (path > 0.0).all()):
        raise InputError("uniaxial: stretches must be finite and > 0")
    if lateral == "strain":
        return drive(material, [np.diag([a, 1.0, 1.0]) for a in path], dt)
    if lateral != "stress":
        raise InputError(f"uniaxial: lateral = {lateral!r} is not allowed: it must be 'strain' or 'stress'")
    return _follow(material, len(path), lambda point, k: _free_sides(point, float(path[k]), dt), dt)


def shear(material: Material, gammas: npt.ArrayLike, dt: float = 1.0) -> Response:
    """Return the response to simple shear F = I + γ e_x ⊗ e_y.

    Parameters
    ----------
    material
        Any material.
    gammas
        Amounts of shear γ, (m,).
    dt
        Length of a step [s].
    """
    gamma = np.asarray(gammas, dtype=np.float64).reshape(-1)
    path = np.tile(np.eye(3), (len(gamma), 1, 1))
    path[:, 0, 1] = gamma
    return drive(material, path, dt)


def _follow(material: Material, steps: int, target: Callable[[_Point, int], Array], dt: float) -> Response:
    """Take steps to the deformation gradients that ``target(point, k)`` gives."""
    point = _Point(material)
    F, stress, state = np.empty((steps, 3, 3)), np.empty((steps, 6)), np.empty((steps, len(point.state)))
    for k in range(steps):
        F[k] = target(point, k)
        stress[k] = point.step(F[k], dt)
        state[k] = point.state
    return Response(F, stress, state)


def _free_sides(point: _Point, stretch: float, dt: float) -> Array:
    """Return diag(stretch, s, s) with the s that makes the next lateral stress vanish."""
    from scipy.optimize import brentq  # noqa: PLC0415 - slow to import

    def lateral(log_s: float) -> float:
        s = np.exp(log_s)
        return float(point.stress_at(np.diag([stretch, s, s]), dt)[0][1])

    start = float(np.log(point.F[1, 1]))
    width = 0.1 * abs(float(np.log(stretch / point.F[0, 0]))) + 1e-6
    while width < 3.0:
        low, high = start - width, start + width
        if lateral(low) * lateral(high) <= 0.0:
            root: Any = brentq(lateral, low, high, xtol=1e-15)
            s = np.exp(root)
            return np.diag([stretch, s, s])
        width *= 2.0
    raise InputError(f"uniaxial: no lateral stretch frees the sides at a stretch of {stretch:g}")


def plot(material: Material, path: str | Path | None = None, strain: float | None = None) -> Figure:
    """Draw uniaxial strain, uniaxial stress and simple shear up to a strain, each within 1 s.

    Parameters
    ----------
    material
        Any material.
    path
        File to write, its suffix giving the format, or None.
    strain
        Largest amount of stretching, compression and shear, in (0, 1); None takes the material's own.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    InputError
        The file can't be written.
    """
    from matplotlib.figure import Figure  # noqa: PLC0415 - only when drawn; no pyplot, hence no screen

    figure = Figure(figsize=(9.0, 3.8), layout="constrained")
    left, right = figure.subplots(1, 2)
    ramp = np.linspace(0.0, material.plotted_strain if strain is None else strain, 121)
    dt = 1.0 / 120.0
    # A rate-dependent law answers to the first step, not to rest: its curve begins there.
    begin = 1 if material.diffusivity > 0 else 0
    for lateral, colour in (("strain", "C0"), ("stress", "C1")):
        try:
            ways = [uniaxial(material, 1.0 + sign * ramp, lateral, dt).stress[:, 0] for sign in (-1.0, 1.0)]
        except InputError:  # some laws soften so far that no free side exists: leave the curve out
            continue
        stretches = np.concatenate([1.0 - ramp[::-1], 1.0 + ramp])
        left.plot(stretches, np.concatenate([ways[0][::-1], ways[1]]), colour, label=f"uniaxial {lateral}")
    left.set(xlabel="stretch", ylabel="σ_xx [Pa]")
    stress = shear(material, ramp, dt).stress
    right.plot(ramp[begin:], stress[begin:, 3], "C0", label="σ_xy")
    right.plot(ramp[begin:], (stress[:, 0] - stress[:, 1])[begin:], "C1--", label="σ_xx - σ_yy")
    right.set(xlabel="amount of shear", ylabel="stress in simple shear [Pa]")
    for axes in (left, right):
        axes.axhline(0.0, color="0.8", linewidth=0.8, zorder=0)
        axes.legend(frameon=False)
    figure.suptitle(type(material).__name__)
    if path is not None:
        try:
            figure.savefig(path, dpi=150)
        except (OSError, ValueError) as error:
            raise InputError(f"plot: {path} can't be written: {error}") from error
    return figure

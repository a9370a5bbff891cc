"""The stress pass: F and the Cauchy stress of the particles of one material."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from math import inf
from typing import Any, Protocol

import numba
import numpy as np
from numba.core.errors import NumbaError

from matpoint.errors import InputError
from matpoint.jit import FAST_MATH, device, kernel
from matpoint.kernels.laws import cauchy_stress, is_cacheable, law_of
from matpoint.tensor import Tensor, det, dot


class _HasLaw(Protocol):
    """What a material shows to this module."""

    @property
    def params(self) -> Any: ...

    @property
    def state_variables(self) -> Any: ...


@device
def load(A: Any, p: int) -> Tensor:
    """Return tensor p of an array (n, 3, 3) as nested tuples."""
    return (
        (A[p, 0, 0], A[p, 0, 1], A[p, 0, 2]),
        (A[p, 1, 0], A[p, 1, 1], A[p, 1, 2]),
        (A[p, 2, 0], A[p, 2, 1], A[p, 2, 2]),
    )


@device
def store(A: Any, p: int, T: Tensor) -> None:
    """Write nested tuples to tensor p of an array (n, 3, 3)."""
    A[p, 0, 0], A[p, 0, 1], A[p, 0, 2] = T[0][0], T[0][1], T[0][2]
    A[p, 1, 0], A[p, 1, 1], A[p, 1, 2] = T[1][0], T[1][1], T[1][2]
    A[p, 2, 0], A[p, 2, 1], A[p, 2, 2] = T[2][0], T[2][1], T[2][2]


@device
def increment(L: Tensor, dt: float) -> Tensor:
    """Return I + dt L."""
    return (
        (1.0 + dt * L[0][0], dt * L[0][1], dt * L[0][2]),
        (dt * L[1][0], 1.0 + dt * L[1][1], dt * L[1][2]),
        (dt * L[2][0], dt * L[2][1], 1.0 + dt * L[2][2]),
    )


@kernel
def update_stress(params, index, start, stop, F, first, L, volume0, volume, state, stress, dt):
    """Advance F, volume, state and stress of particles ``index[start:stop]`` (T 38, S 1-15).

    F_new = (I + dt L) F, V = det(F_new) V0, then the law of ``params``.

    Parameters
    ----------
    params
        Named tuple of the material's parameters; its class chooses the law.
    index, start, stop
        Particles of one material, int32 (m,), or ``EVERY_POINT``, and the range of them to do.
    F
        Deformation gradients (updated), (n, 3, 3).
    first, L
        Velocity gradients [1/s] of the particles from ``first`` on, (m, 3, 3).
    volume0, volume
        Reference volumes and current ones (written) [m³], (n,).
    state
        Internal variables (updated), (n, S), S at least the law's number.
    stress
        Cauchy stress (written) [Pa], (n, 6): xx, yy, zz, xy, yz, xz.
    dt
        Step [s].

    Returns
    -------
    int
        -1, or the first particle whose F_new is not finite, turns over (det ≤ 0), or gives
        a stress that is not finite. Its F, volume and stress are left as they were (its state
        may have been touched by the law), and the particles after it are not done.
    """
    for k in range(start, stop):
        p = index[k] if index.shape[0] > 0 else k
        F_old = load(F, p)
        L_p = load(L, p - first)
        F_new = dot(increment(L_p, dt), F_old)
        J = det(F_new)
        if not 0.0 < J < inf:
            return np.int64(p)
        sigma = cauchy_stress(F_old, F_new, L_p, dt, state[p], params)
        xx, yy, zz = sigma[0][0], sigma[1][1], sigma[2][2]
        xy, yz, xz = sigma[0][1], sigma[1][2], sigma[0][2]
        # Not math.isfinite: Numba makes it x - x, which re-association may fold to zero.
        if not abs(xx + yy + zz + xy + yz + xz) < inf:
            return np.int64(p)
        store(F, p, F_new)
        volume[p] = J * volume0[p]
        stress[p, 0], stress[p, 1], stress[p, 2] = xx, yy, zz
        stress[p, 3], stress[p, 4], stress[p, 5] = xy, yz, xz
    return np.int64(-1)


#: The same loop for laws from outside the package: compiled in each process, never cached.
update_stress_uncached: Any = numba.njit(nogil=True, fastmath=FAST_MATH, error_model="numpy")(
    update_stress.py_func
)


def stress_kernel(material: _HasLaw) -> Callable[..., int]:
    """Return :func:`update_stress` for one material, compiled, without its first argument.

    Parameters
    ----------
    material
        Any material, built-in or a user's.

    Raises
    ------
    InputError
        Numba can't compile the user's function.
    """
    params = material.params
    compiled = update_stress if is_cacheable(params) else update_stress_uncached
    none, tensors = np.empty(0), np.empty((0, 3, 3))
    state = np.empty((0, len(material.state_variables)))
    try:  # no particles: this only compiles, or loads from the cache
        compiled(
            params, np.empty(0, np.int32), 0, 0, tensors, 0, tensors, none, none, state, np.empty((0, 6)), 0.0
        )
    except NumbaError as error:
        law: Any = law_of(params)
        reason = _reason(_alone(law, params) or error)
        raise InputError(f"the stress law {law.__name__!r} can't be compiled by Numba: {reason}") from error
    return partial(compiled, params)


def _alone(law: Any, params: Any) -> Exception | None:
    """Return the error of compiling a law by itself: shorter than the one out of the kernel."""
    row = numba.types.UniTuple(numba.float64, 3)
    tensor = numba.types.UniTuple(row, 3)
    types = (tensor, tensor, tensor, numba.float64, numba.float64[::1], numba.typeof(params))
    try:
        compiled: Any = numba.njit(getattr(law, "py_func", law))
        compiled.compile(types)
    except NumbaError as error:
        return error
    return None


def _reason(error: Exception, lines: int = 2) -> str:
    """Return the lines of one of Numba's messages that tell a user something."""
    noise = ("Failed in", "During", "This error", "^", "- Resolution failure", "<source", "[1]", "[2]", "[3]")
    text = [line.strip().removeprefix("[1] During: ") for line in str(error).splitlines()]
    kept = [line for line in text if line and not line.startswith(noise)]
    return "; ".join(kept[:lines]) or type(error).__name__

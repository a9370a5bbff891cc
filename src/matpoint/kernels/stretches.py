"""Principal stretches and determinants of many tensors at once, several times faster than LAPACK's."""

from __future__ import annotations

from math import acos, cos, sqrt
from typing import Any

import numpy as np

from matpoint.jit import device, kernel
from matpoint.kernels.stress import load
from matpoint.tensor import Tensor, Vector, det, deviator, double_dot, eigen, left_cauchy_green, scale, trace


@device
def _ascending(S: Tensor) -> Vector:
    """Return the eigenvalues of a symmetric tensor in ascending order."""
    (a, b, c), _ = eigen(S)
    low, high = min(a, b), max(a, b)
    return (min(low, c), max(low, min(high, c)), max(high, c))


@kernel
def _eigenvalues(A, values):
    """Write the eigenvalues of symmetric A (n, 3, 3) to values (n, 3), ascending."""
    for p in range(A.shape[0]):
        values[p, 0], values[p, 1], values[p, 2] = _ascending(load(A, p))


@kernel
def _principal_squares(F, values):
    """Write the eigenvalues of F Fᵀ, F (n, 3, 3), to values (n, 3), ascending."""
    for p in range(F.shape[0]):
        values[p, 0], values[p, 1], values[p, 2] = _ascending(left_cauchy_green(load(F, p)))


@kernel
def _largest_squares(F, values):
    """Write the largest eigenvalue of F Fᵀ, F (n, 3, 3), to values (n,).

    By the closed formula, which is quick; its error of 1e-8 at nearly equal stretches does
    not matter to wave speeds.
    """
    for p in range(F.shape[0]):
        b = left_cauchy_green(load(F, p))
        s = deviator(b)
        size = sqrt(double_dot(s, s) / 6.0)
        cosine = 0.0
        if size > 0.0:
            cosine = max(-1.0, min(1.0, 0.5 * det(scale(1.0 / size, s))))
        values[p] = trace(b) / 3.0 + 2.0 * size * cos(acos(cosine) / 3.0)


@kernel
def _determinants(F, values):
    """Write det F, F (n, 3, 3), to values (n,)."""
    for p in range(F.shape[0]):
        values[p] = det(load(F, p))


def eigenvalues(A: Any) -> Any:
    """Return the eigenvalues of symmetric tensors (n, 3, 3), ascending, (n, 3)."""
    A = np.ascontiguousarray(A, dtype=np.float64)
    values = np.empty(A.shape[:2])
    _eigenvalues(A, values)
    return values


def principal_squares(F: Any) -> Any:
    """Return the squared principal stretches of F (n, 3, 3), ascending, (n, 3)."""
    F = np.ascontiguousarray(F, dtype=np.float64)
    values = np.empty(F.shape[:2])
    _principal_squares(F, values)
    return values


def largest_squares(F: Any) -> Any:
    """Return the squares of the largest stretches of F (n, 3, 3), (n,), to about 1e-8."""
    F = np.ascontiguousarray(F, dtype=np.float64)
    values = np.empty(F.shape[0])
    _largest_squares(F, values)
    return values


def determinants(F: Any) -> Any:
    """Return det F of F (n, 3, 3), (n,)."""
    F = np.ascontiguousarray(F, dtype=np.float64)
    values = np.empty(F.shape[0])
    _determinants(F, values)
    return values

"""Algebra of 3×3 tensors as nested tuples, for stress laws.

A tensor is ``((xx, xy, xz), (yx, yy, yz), (zx, zy, zz))``, row by row. Every function runs
inside compiled kernels, where tuples cost nothing, and in plain Python alike; a user's
stress law may use them all.
"""

from __future__ import annotations

from math import exp, log, sqrt
from typing import TypeAlias

from matpoint.jit import device

Vector: TypeAlias = tuple[float, float, float]
Tensor: TypeAlias = tuple[Vector, Vector, Vector]

# A Jacobi sweep squares the off-diagonal part once it is small, so that six sweeps reach round-off from any
# start; the bound only ends the loop for tensors that hold a NaN.
_SWEEPS = 12


@device
def identity() -> Tensor:
    """Return I."""
    return ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


@device
def add(A: Tensor, B: Tensor) -> Tensor:
    """Return A + B."""
    return (
        (A[0][0] + B[0][0], A[0][1] + B[0][1], A[0][2] + B[0][2]),
        (A[1][0] + B[1][0], A[1][1] + B[1][1], A[1][2] + B[1][2]),
        (A[2][0] + B[2][0], A[2][1] + B[2][1], A[2][2] + B[2][2]),
    )


@device
def scale(a: float, A: Tensor) -> Tensor:
    """Return a A."""
    return (
        (a * A[0][0], a * A[0][1], a * A[0][2]),
        (a * A[1][0], a * A[1][1], a * A[1][2]),
        (a * A[2][0], a * A[2][1], a * A[2][2]),
    )


@device
def transpose(A: Tensor) -> Tensor:
    """Return Aᵀ."""
    return (
        (A[0][0], A[1][0], A[2][0]),
        (A[0][1], A[1][1], A[2][1]),
        (A[0][2], A[1][2], A[2][2]),
    )


@device
def _times_row(a: Vector, B: Tensor) -> Vector:
    """Return the row a B."""
    return (
        a[0] * B[0][0] + a[1] * B[1][0] + a[2] * B[2][0],
        a[0] * B[0][1] + a[1] * B[1][1] + a[2] * B[2][1],
        a[0] * B[0][2] + a[1] * B[1][2] + a[2] * B[2][2],
    )


@device
def dot(A: Tensor, B: Tensor) -> Tensor:
    """Return A B."""
    return (_times_row(A[0], B), _times_row(A[1], B), _times_row(A[2], B))


@device
def double_dot(A: Tensor, B: Tensor) -> float:
    """Return A : B = Σ A_ij B_ij."""
    return (
        (A[0][0] * B[0][0] + A[0][1] * B[0][1] + A[0][2] * B[0][2])
        + (A[1][0] * B[1][0] + A[1][1] * B[1][1] + A[1][2] * B[1][2])
        + (A[2][0] * B[2][0] + A[2][1] * B[2][1] + A[2][2] * B[2][2])
    )


@device
def trace(A: Tensor) -> float:
    """Return tr A."""
    return A[0][0] + A[1][1] + A[2][2]


@device
def sym(A: Tensor) -> Tensor:
    """Return the symmetric part (A + Aᵀ)/2."""
    xy = 0.5 * (A[0][1] + A[1][0])
    xz = 0.5 * (A[0][2] + A[2][0])
    yz = 0.5 * (A[1][2] + A[2][1])
    return ((A[0][0], xy, xz), (xy, A[1][1], yz), (xz, yz, A[2][2]))


@device
def deviator(A: Tensor) -> Tensor:
    """Return A - (tr A / 3) I."""
    mean = trace(A) / 3.0
    return (
        (A[0][0] - mean, A[0][1], A[0][2]),
        (A[1][0], A[1][1] - mean, A[1][2]),
        (A[2][0], A[2][1], A[2][2] - mean),
    )


@device
def det(A: Tensor) -> float:
    """Return det A."""
    return (
        A[0][0] * (A[1][1] * A[2][2] - A[1][2] * A[2][1])
        - A[0][1] * (A[1][0] * A[2][2] - A[1][2] * A[2][0])
        + A[0][2] * (A[1][0] * A[2][1] - A[1][1] * A[2][0])
    )


@device
def inverse(A: Tensor) -> Tensor:
    """Return A⁻¹; A must be regular."""
    a = 1.0 / det(A)
    return (
        (
            a * (A[1][1] * A[2][2] - A[1][2] * A[2][1]),
            a * (A[0][2] * A[2][1] - A[0][1] * A[2][2]),
            a * (A[0][1] * A[1][2] - A[0][2] * A[1][1]),
        ),
        (
            a * (A[1][2] * A[2][0] - A[1][0] * A[2][2]),
            a * (A[0][0] * A[2][2] - A[0][2] * A[2][0]),
            a * (A[0][2] * A[1][0] - A[0][0] * A[1][2]),
        ),
        (
            a * (A[1][0] * A[2][1] - A[1][1] * A[2][0]),
            a * (A[0][1] * A[2][0] - A[0][0] * A[2][1]),
            a * (A[0][0] * A[1][1] - A[0][1] * A[1][0]),
        ),
    )


@device
def congruence(A: Tensor, S: Tensor) -> Tensor:
    """Return A S Aᵀ for a symmetric S, symmetric to the last bit."""
    return sym(dot(dot(A, S), transpose(A)))


@device
def left_cauchy_green(F: Tensor) -> Tensor:
    """Return b = F Fᵀ."""
    xy = F[0][0] * F[1][0] + F[0][1] * F[1][1] + F[0][2] * F[1][2]
    xz = F[0][0] * F[2][0] + F[0][1] * F[2][1] + F[0][2] * F[2][2]
    yz = F[1][0] * F[2][0] + F[1][1] * F[2][1] + F[1][2] * F[2][2]
    return (
        (F[0][0] * F[0][0] + F[0][1] * F[0][1] + F[0][2] * F[0][2], xy, xz),
        (xy, F[1][0] * F[1][0] + F[1][1] * F[1][1] + F[1][2] * F[1][2], yz),
        (xz, yz, F[2][0] * F[2][0] + F[2][1] * F[2][1] + F[2][2] * F[2][2]),
    )


@device
def right_cauchy_green(F: Tensor) -> Tensor:
    """Return C = Fᵀ F."""
    return left_cauchy_green(transpose(F))


@device
def _angle(pp: float, qq: float, pq: float) -> tuple[float, float, float]:
    """Return cosine, sine and tangent of the plane rotation that clears pq (the smaller of the two)."""
    if abs(pq) <= 1e-100 * (abs(pp) + abs(qq)):  # nothing to clear; tau² would overflow
        return (1.0, 0.0, 0.0)
    tau = (qq - pp) / (2.0 * pq)
    t = 1.0 / (abs(tau) + sqrt(1.0 + tau * tau))
    if tau < 0.0:
        t = -t
    c = 1.0 / sqrt(1.0 + t * t)
    return (c, t * c, t)


@device
def _turn(u: Vector, v: Vector, c: float, s: float) -> tuple[Vector, Vector]:
    """Return c u - s v and s u + c v."""
    return (
        (c * u[0] - s * v[0], c * u[1] - s * v[1], c * u[2] - s * v[2]),
        (s * u[0] + c * v[0], s * u[1] + c * v[1], s * u[2] + c * v[2]),
    )


@device
def eigen(S: Tensor) -> tuple[Vector, Tensor]:
    """Return the eigenvalues of a symmetric tensor and its unit eigenvectors.

    Cyclic Jacobi rotations: the vectors are orthonormal to round-off whether eigenvalues
    repeat or not, which closed formulas can't promise.

    Parameters
    ----------
    S
        A symmetric tensor; its upper triangle is read.

    Returns
    -------
    values, vectors
        Three eigenvalues in no particular order, and ``vectors[k]``, the unit vector of ``values[k]``.
    """
    xx, yy, zz = S[0][0], S[1][1], S[2][2]
    xy, xz, yz = S[0][1], S[0][2], S[1][2]
    u, v, w = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
    for _ in range(_SWEEPS):
        off = xy * xy + xz * xz + yz * yz
        if off <= 1e-32 * (xx * xx + yy * yy + zz * zz):
            break
        c, s, t = _angle(xx, yy, xy)
        xx, yy, xy = xx - t * xy, yy + t * xy, 0.0
        xz, yz = c * xz - s * yz, s * xz + c * yz
        u, v = _turn(u, v, c, s)
        c, s, t = _angle(xx, zz, xz)
        xx, zz, xz = xx - t * xz, zz + t * xz, 0.0
        xy, yz = c * xy - s * yz, s * xy + c * yz
        u, w = _turn(u, w, c, s)
        c, s, t = _angle(yy, zz, yz)
        yy, zz, yz = yy - t * yz, zz + t * yz, 0.0
        xy, xz = c * xy - s * xz, s * xy + c * xz
        v, w = _turn(v, w, c, s)
    return (xx, yy, zz), (u, v, w)


@device
def spectral(values: Vector, vectors: Tensor) -> Tensor:
    """Return Σ_k values[k] vectors[k] ⊗ vectors[k], the inverse of :func:`eigen`."""
    (a, b, c), (u, v, w) = values, vectors
    xy = a * u[0] * u[1] + b * v[0] * v[1] + c * w[0] * w[1]
    xz = a * u[0] * u[2] + b * v[0] * v[2] + c * w[0] * w[2]
    yz = a * u[1] * u[2] + b * v[1] * v[2] + c * w[1] * w[2]
    return (
        (a * u[0] * u[0] + b * v[0] * v[0] + c * w[0] * w[0], xy, xz),
        (xy, a * u[1] * u[1] + b * v[1] * v[1] + c * w[1] * w[1], yz),
        (xz, yz, a * u[2] * u[2] + b * v[2] * v[2] + c * w[2] * w[2]),
    )


@device
def log_sym(S: Tensor) -> Tensor:
    """Return the logarithm of a symmetric positive definite tensor."""
    values, vectors = eigen(S)
    return spectral((log(values[0]), log(values[1]), log(values[2])), vectors)


@device
def exp_sym(S: Tensor) -> Tensor:
    """Return the exponential of a symmetric tensor."""
    values, vectors = eigen(S)
    return spectral((exp(values[0]), exp(values[1]), exp(values[2])), vectors)


@device
def sqrt_sym(S: Tensor) -> Tensor:
    """Return the square root of a symmetric positive tensor: sqrt_sym(F Fᵀ) is the left stretch."""
    values, vectors = eigen(S)
    return spectral((sqrt(values[0]), sqrt(values[1]), sqrt(values[2])), vectors)

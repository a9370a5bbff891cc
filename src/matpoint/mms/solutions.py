"""Displacements u(X, t) that the literature runs, as sympy expressions (methods, section 6)."""

from __future__ import annotations

import sympy as sp

from matpoint.mms.coordinates import COORDINATES, X, Y, t

Displacement = tuple[sp.Expr, ...]


def full_wave(amplitude: float, speed: float, length: float = 1.0) -> Displacement:
    """Return u = A sin(2πX/L) sin(cπt/L), the one-dimensional problem of the IMLS paper (T 44).

    Parameters
    ----------
    amplitude, speed, length
        A [m], c [m/s], L [m].
    """
    return (amplitude * sp.sin(2 * sp.pi * X / length) * sp.sin(speed * sp.pi * t / length),)


def half_wave(amplitude: float, speed: float) -> Displacement:
    """Return u = G sin(πX) sin(cπt) on 0 <= X <= 1 m.

    Parameters
    ----------
    amplitude, speed
        G [m], c [m/s].
    """
    return (amplitude * sp.sin(sp.pi * X) * sp.sin(speed * sp.pi * t),)


def standing_waves(amplitude: float, speed: float, dim: int) -> Displacement:
    """Return u_k = A sin(πX_k) sin(cπt + α_k), α = (0, π) or (0, 2π/3, 4π/3), on a unit box.

    Parameters
    ----------
    amplitude, speed
        A [m], c [m/s].
    dim
        2 or 3.
    """
    turn = 2 * sp.pi / dim
    return tuple(
        amplitude * sp.sin(sp.pi * COORDINATES[k]) * sp.sin(speed * sp.pi * t + k * turn) for k in range(dim)
    )


def vortex(amplitude: float, period: float) -> Displacement:
    """Return the generalised vortex: circles at R turn by A sin(πt/T) (4R - 3)² (4R - 5)².

    It lives on 0.75 m <= R <= 1.25 m; both circles are free surfaces and do not turn.

    Parameters
    ----------
    amplitude
        A [rad], reached at R = 1 m.
    period
        T [s]; the ring is back at rest in its place after one.
    """
    R = sp.sqrt(X**2 + Y**2)
    angle = amplitude * sp.sin(sp.pi * t / period) * (4 * R - 3) ** 2 * (4 * R - 5) ** 2
    cosine, sine = sp.cos(angle), sp.sin(angle)
    return (X * cosine - Y * sine - X, X * sine + Y * cosine - Y)


def expanding_ring(amplitude: float, inner: float, outer: float, rate: float) -> Displacement:
    """Return u = A sin(rate π t) (c3 R² + c2 R + c1) X: the ring breathes, both circles are free.

    Parameters
    ----------
    amplitude
        Displacement of the outer circle [m].
    inner, outer
        Radii r_i, r_o [m], r_o ≠ 3 r_i.
    rate
        Half the angular frequency over π/2 [1/s].
    """
    scale = outer**2 * (outer - 3 * inner)
    c1, c2, c3 = -6 * inner * outer / scale, 3 * (inner + outer) / scale, -2 / scale
    R = sp.sqrt(X**2 + Y**2)
    radial = amplitude * sp.sin(rate * sp.pi * t) * (c3 * R**2 + c2 * R + c1)
    return (radial * X, radial * Y)

"""Weights by definition: quadrature of hats, SciPy's B-splines, high-order Gauss on domains."""

from __future__ import annotations

import numpy as np
from numpy.polynomial.legendre import leggauss
from scipy.integrate import quad
from scipy.interpolate import BSpline


def hat(x: float, node: float, h: float) -> float:
    return max(0.0, 1.0 - abs(x - node) / h)


def gimp_weight(x: float, half: float, node: float, h: float) -> tuple[float, float]:
    """The mean of the hat and of its slope over [x - half, x + half], by quadrature."""
    kinks = [c for c in (node - h, node, node + h) if x - half < c < x + half]
    value = quad(hat, x - half, x + half, args=(node, h), points=kinks or None, epsabs=1e-13)[0]
    slope = hat(x + half, node, h) - hat(x - half, node, h)
    return value / (2 * half), slope / (2 * half)


def spline_weights(
    x: float, origin: float, h: float, cells: int, degree: int
) -> tuple[np.ndarray, np.ndarray]:
    """All B-splines on clamped knots, and their derivatives, at x."""
    knots = origin + h * np.concatenate([[0.0] * degree, np.arange(cells + 1), [cells] * degree])
    values, slopes = [], []
    for i in range(cells + degree):
        basis = BSpline(knots, np.eye(cells + degree)[i], degree)
        values.append(float(basis(x)))
        slopes.append(float(basis.derivative()(x)))
    return np.array(values), np.array(slopes)


def _shape(kind: str, r: float, s: float, t: float) -> tuple[np.ndarray, np.ndarray]:
    """Shape functions and their derivatives by (r, s, t) on [-1, 1]^d, VTK's order."""
    signs = {
        "LINE": [(-1,), (1,)],
        "QUAD": [(-1, -1), (1, -1), (1, 1), (-1, 1)],
        "HEX": [
            (-1, -1, -1),
            (1, -1, -1),
            (1, 1, -1),
            (-1, 1, -1),
            (-1, -1, 1),
            (1, -1, 1),
            (1, 1, 1),
            (-1, 1, 1),
        ],
    }[kind]
    point = np.array([r, s, t])[: len(signs[0])]
    N, dN = [], []
    for sign in signs:
        factor = 0.5 * (1 + np.array(sign) * point)
        N.append(factor.prod())
        dN.append([0.5 * sign[k] * np.delete(factor, k).prod() for k in range(len(sign))])
    return np.array(N), np.array(dN)


def corner_weights(kind: str, x: np.ndarray, order: int = 5) -> tuple[float, np.ndarray, np.ndarray]:
    """V, R_a = (1/V) int N_a and G_a = (1/V) int grad N_a by Gauss points of a high order."""
    dim = {"LINE": 1, "QUAD": 2, "HEX": 3}[kind]
    x = x[:, :dim]
    points, w = leggauss(order)
    V, R, G = 0.0, np.zeros(len(x)), np.zeros((len(x), 3))
    for index in np.ndindex(*(order,) * dim):
        local = [*points[list(index)], 0.0, 0.0][:3]
        N, dN = _shape(kind, *local)
        J = x.T @ dN  # dx/dxi
        weight = w[list(index)].prod() * np.linalg.det(J)
        V += weight
        R += weight * N
        G[:, :dim] += weight * dN @ np.linalg.inv(J)
    return V, R / V, G / V

"""Helpers of the tests of inclusions: Eshelby's equivalent inclusion, Hooke's law, differences."""

from __future__ import annotations

import numpy as np

PAIRS = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))


def hooke(young, nu):
    """Stiffness (6, 6) of tensor components xx, yy, zz, xy, yz, xz."""
    lam, mu = young * nu / ((1 + nu) * (1 - 2 * nu)), young / (2 * (1 + nu))
    C = 2 * mu * np.eye(6)
    C[:3, :3] += lam
    return C


def cylinder(nu):
    """Eshelby's tensor (6, 6) of a circular cylinder along z (Mura 1987, eq. 11.22)."""
    S, k = np.zeros((6, 6)), 8 * (1 - nu)
    S[:2, :3] = [
        [(5 - 4 * nu) / k, (4 * nu - 1) / k, 4 * nu / k],
        [(4 * nu - 1) / k, (5 - 4 * nu) / k, 4 * nu / k],
    ]
    S[3, 3], S[4, 4], S[5, 5] = 2 * (3 - 4 * nu) / k, 0.5, 0.5
    return S


def ball(nu):
    """Eshelby's tensor (6, 6) of a sphere (Mura 1987, eq. 11.21)."""
    S, k = np.zeros((6, 6)), 15 * (1 - nu)
    S[:3, :3] = (5 * nu - 1) / k
    S[[0, 1, 2], [0, 1, 2]] = (7 - 5 * nu) / k
    S[[3, 4, 5], [3, 4, 5]] = 2 * (4 - 5 * nu) / k
    return S


def inside(S, inner, matrix, strain):
    """Strain and stress of an inclusion: (C' - C)(strain + S e) + C e = 0."""
    eigen = -np.linalg.solve((inner - matrix) @ S + matrix, (inner - matrix) @ strain)
    there = strain + S @ eigen
    return there, inner @ there


def tensor(s):
    """(..., 6) to (..., 3, 3)."""
    full = np.empty((*s.shape[:-1], 3, 3))
    for k, (i, j) in enumerate(PAIRS):
        full[..., i, j] = full[..., j, i] = s[..., k]
    return full


def gradient(field, x, d, e=1e-5):
    """Derivatives of a field along the last axis, by central differences at points (n, d)."""
    steps = e * np.eye(x.shape[1])[:d]
    return np.stack([(field(x + h) - field(x - h)) / (2 * e) for h in steps], axis=-1)

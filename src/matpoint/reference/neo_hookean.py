"""The neo-Hookean law of the bi-material problems (Sadeghirad et al. 2013, eq. 27), for references.

W = (lambda/2) ln(J)^2 + (mu/2) (tr(F^T F) - 3 - 2 ln J), hence the first Piola-Kirchhoff stress
P = lambda ln(J) F^-T + mu (F - F^-T) and the Cauchy stress
sigma = (lambda ln(J)/J) I + (mu/J) (F F^T - I). Deformation gradients are arrays (d, d, points) with
d = 2 (plane strain, F_zz = 1) or 3, so that each component is contiguous.
"""

from __future__ import annotations

import numpy as np


def cofactor(F: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return J and the cofactors J F^-T of deformation gradients, shapes (q,) and (d, d, q)."""
    cof = np.empty_like(F)
    if len(F) == 2:
        cof[0, 0], cof[0, 1], cof[1, 0], cof[1, 1] = F[1, 1], -F[1, 0], -F[0, 1], F[0, 0]
        return F[0, 0] * F[1, 1] - F[0, 1] * F[1, 0], cof
    for i in range(3):
        a, b = F[(i + 1) % 3], F[(i + 2) % 3]
        for k in range(3):
            m, n = (k + 1) % 3, (k + 2) % 3
            cof[i, k] = a[m] * b[n] - a[n] * b[m]
    return F[0, 0] * cof[0, 0] + F[0, 1] * cof[0, 1] + F[0, 2] * cof[0, 2], cof


def piola(F: np.ndarray, lame: np.ndarray, shear: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return P [Pa], shape (d, d, q), and J, shape (q,), for Lamé parameters [Pa] of shape (q,).

    A J that is not positive gives NaN or infinity; the caller looks at J.
    """
    J, cof = cofactor(F)
    with np.errstate(divide="ignore", invalid="ignore"):
        cof *= (lame * np.log(J) - shear) / J
    cof += shear * F
    return cof, J


def energy(F: np.ndarray, lame: np.ndarray, shear: np.ndarray) -> np.ndarray:
    """Return the strain energy per initial volume [J/m^3], shape (q,)."""
    log = np.log(cofactor(F)[0])
    squares = (F * F).sum(axis=(0, 1)) - len(F)  # tr(F^T F) - 3: F_zz = 1 in plane strain
    return 0.5 * lame * log**2 + 0.5 * shear * (squares - 2 * log)


def kirchhoff(F: np.ndarray, lame: np.ndarray, shear: np.ndarray) -> np.ndarray:
    """Return J sigma [Pa] as xx, yy, zz, xy, yz, xz, shape (6, q)."""
    log, d = lame * np.log(cofactor(F)[0]), len(F)
    tau = np.zeros((6, F.shape[2]))
    for i in range(d):
        tau[i] = shear * ((F[i] * F[i]).sum(axis=0) - 1)
    tau[:3] += log
    for row, (i, j) in zip((3, 4, 5), ((0, 1), (1, 2), (0, 2)), strict=True):
        if max(i, j) < d:
            tau[row] = shear * (F[i] * F[j]).sum(axis=0)
    return tau


def tangent(F: np.ndarray, lame: np.ndarray, shear: np.ndarray) -> np.ndarray:
    """Return dP_iK/dF_jL [Pa], shape (d, d, d, d, q) in the order i, K, j, L.

    dP = lambda (F^-T : dF) F^-T + mu dF + (mu - lambda ln J) F^-T dF^T F^-T.
    """
    J, cof = cofactor(F)
    inverse = cof / J  # F^-T
    A = np.einsum("iKq,jLq->iKjLq", inverse, lame * inverse)
    A += np.einsum("iLq,jKq->iKjLq", inverse, (shear - lame * np.log(J)) * inverse)
    for i in range(len(F)):
        for k in range(len(F)):
            A[i, k, i, k] += shear
    return A

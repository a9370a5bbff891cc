"""Figures 1 to 3 of the IMLS paper: orthogonal polynomials of a few particles on [-1, 1]."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from matpoint.output.figures import new_figure, save

#: File of a figure -> particles and title. The paper draws its sets without giving coordinates: assumed.
SETS: dict[str, tuple[tuple[float, ...], str]] = {
    "figure-1-equal.png": ((-2 / 3, 0.0, 2 / 3), "three particles, equally distributed"),
    "figure-2-corner.png": ((0.55, 0.75, 0.95), "three particles near a corner"),
    "figure-3-two.png": ((-0.5, 0.5), "two particles: p3 vanishes at both"),
}
_TOLERANCE = 1e-12
_COLOURS = ("#0F4C81", "#D55E00", "#009E73")


def weights(points: np.ndarray) -> np.ndarray:
    """Return the quadratic spline around 0 that reaches to both ends of [-1, 1]."""
    r = np.abs(1.5 * points)
    return np.where(r < 0.5, 0.75 - r**2, 0.5 * np.maximum(1.5 - r, 0.0) ** 2)


def polynomials(points: np.ndarray, columns: int = 3) -> tuple[np.ndarray, np.ndarray]:
    """Orthogonalise 1, x, x^2 by Gram-Schmidt, twice, over weighted particles (T 7, 16).

    Parameters
    ----------
    points : ndarray, shape (n,)
        Particles in [-1, 1].
    columns
        How many monomials.

    Returns
    -------
    coefficients : ndarray, shape (columns, columns)
        Row k are those of p_k, constant first.
    norms : ndarray, shape (columns,)
        <p_k, p_k>; 0 where a column vanishes at all particles.
    """
    powers, w = points[None] ** np.arange(columns)[:, None], weights(points)
    coefficients, norms = np.eye(columns), np.zeros(columns)
    for k in range(columns):
        for _ in range(2):
            for q in np.flatnonzero(norms[:k]):
                own, other = coefficients[k] @ powers, coefficients[q] @ powers
                coefficients[k] -= (w * own * other).sum() / norms[q] * coefficients[q]
        left = (w * (coefficients[k] @ powers) ** 2).sum()
        norms[k] = left if left > _TOLERANCE * (w * powers[k] ** 2).sum() else 0.0
    return coefficients, norms


def draw_polynomials(out: Path) -> dict[str, Any]:
    """Draw figures 1 to 3 into a folder that exists; return particles, coefficients and norms by file."""
    found = {}
    x = np.linspace(-1.0, 1.0, 201)
    for name, (at, title) in SETS.items():
        points = np.array(at)
        coefficients, norms = polynomials(points)
        figure, axis = new_figure(5.2, 4.0)
        axis.plot(x, weights(x), color="#999999", linestyle=":", label="weight")
        for k, (row, colour) in enumerate(zip(coefficients, _COLOURS, strict=True)):
            label = f"p{k + 1}, <p{k + 1}, p{k + 1}> = {norms[k]:.3g}"
            axis.plot(x, row @ x ** np.arange(3)[:, None], color=colour, label=label)
            axis.plot(points, row @ points ** np.arange(3)[:, None], "o", color=colour)
        axis.plot(points, np.zeros_like(points), "k|", markersize=12)
        axis.set(xlabel="x", title=title, ylim=(-2.2, 2.2))
        axis.legend(frameon=False, fontsize="small")
        save(figure, out / name)
        found[name] = {"particles": at, "coefficients": coefficients.tolist(), "norms": norms.tolist()}
    return found

"""The bar of two materials by a plain NumPy material point method in one dimension (USL, FLIP).

Written from the formulas alone, with dense matrices of weights: nothing of the package is used.
"""

from __future__ import annotations

import numpy as np
from scipy.interpolate import BSpline

METHODS = ("mpm", "ugimp", "cpgimp", "bspline2", "bspline3", "cpdi", "enriched-cpdi2")
CELL, LENGTH, INTERFACE, COUNT = 1.0, 9.0, 4.5, 18
NODES = np.arange(-3.0, 13.0)  # more than the bar needs, for the long arms of GIMP
DENSITY, POISSON, GRAVITY = 1050.0, 0.3, -10.0


def hat(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Linear hats of all nodes and their derivatives at points x, shape (points, nodes)."""
    r = (x[:, None] - NODES) / CELL
    inside = np.abs(r) < 1.0
    return np.where(inside, 1.0 - np.abs(r), 0.0), np.where(inside, -np.sign(r), 0.0) / CELL


def hat_integral(y: np.ndarray) -> np.ndarray:
    """The antiderivative of all hats at points y, shape (points, nodes), case by case."""
    r = (y[:, None] - NODES) / CELL
    rising, falling = CELL * (1 + r) ** 2 / 2, CELL * (0.5 + r - r**2 / 2)
    return np.select([r < -1, r <= 0, r <= 1], [0.0 * r, rising, falling], CELL + 0.0 * r)


def averaged(x: np.ndarray, half: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """GIMP: hats averaged over x - half to x + half."""
    low, high = x - half, x + half
    width = 2 * half[:, None]
    return (hat_integral(high) - hat_integral(low)) / width, (hat(high)[0] - hat(low)[0]) / width


def splines(x: np.ndarray, degree: int) -> tuple[np.ndarray, np.ndarray]:
    """SciPy's B-splines over the grid from -1 m to the top, with open knots; the last one is 1 at the top."""
    lines = np.arange(-1.0, LENGTH + 0.5)
    knots = np.r_[[lines[0]] * degree, lines, [lines[-1]] * degree]
    basis = BSpline(knots, np.eye(len(knots) - degree - 1), degree)
    return basis(x), basis.derivative()(x)


def run_bar(method: str, steps: int, dt: float, stiff: str = "above") -> dict[str, np.ndarray]:
    """Return the histories of position, velocity, stress and F, each of shape (steps, 18)."""
    edges = np.linspace(0.0, LENGTH, COUNT + 1)
    x = 0.5 * (edges[1:] + edges[:-1])
    half0 = 0.5 * np.diff(edges)
    volume0 = np.diff(edges)
    mass = DENSITY * volume0
    young = np.where((x > INTERFACE) == (stiff == "above"), 1e7, 5e6)
    lam = young * POISSON / ((1 + POISSON) * (1 - 2 * POISSON))
    mu = young / (2 * (1 + POISSON))
    v, F, stress = np.zeros(COUNT), np.ones(COUNT), np.zeros(COUNT)
    middle = COUNT // 2  # the vertex at the interface
    record: dict[str, list[np.ndarray]] = {"position": [], "velocity": [], "stress": [], "F": []}
    for _ in range(steps):
        zeta = np.zeros((COUNT + 1, len(NODES) + 1))
        if method == "mpm":
            phi, slope = hat(x)
        elif method in ("ugimp", "cpgimp"):
            phi, slope = averaged(x, half0 if method == "ugimp" else half0 * F)
        elif method.startswith("bspline"):
            phi, slope = splines(x, int(method[-1]))
        else:
            # Corner weights: R = 1/2 and G = -1/V, 1/V; a last column for the enriched vertex.
            zeta[:, :-1] = hat(edges)[0]
            if method == "enriched-cpdi2":
                zeta[middle] = 0.0
                zeta[middle, -1] = 1.0
            phi = 0.5 * (zeta[:-1] + zeta[1:])
            slope = (zeta[1:] - zeta[:-1]) / np.diff(edges)[:, None]
        volume = volume0 * F
        node_mass = phi.T @ mass
        momentum = phi.T @ (mass * v)
        force = phi.T @ (mass * GRAVITY) - slope.T @ (volume * stress)
        used = node_mass > 0.0
        safe = np.where(used, node_mass, 1.0)
        # The top is fixed: it stands at the start and at the end of the step.
        if method.startswith("bspline"):
            used[-1] = False
        else:
            used[: len(NODES)] &= NODES < LENGTH
        acceleration = np.where(used, force / safe, 0.0)
        next_velocity = np.where(used, momentum / safe, 0.0) + acceleration * dt
        v = v + phi @ acceleration * dt
        x = x + dt * (phi @ next_velocity)
        F = F * (1.0 + dt * (slope @ next_velocity))
        edges = edges + dt * (zeta @ next_velocity) if zeta.any() else edges
        stress = lam * np.log(F) / F + mu / F * (F**2 - 1.0)
        for name, value in (("position", x), ("velocity", v), ("stress", stress), ("F", F)):
            record[name].append(value)
    return {name: np.array(values) for name, values in record.items()}

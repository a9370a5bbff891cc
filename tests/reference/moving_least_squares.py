"""Moving least squares in plain NumPy: a weighted polynomial fit, evaluated at the origin."""

from __future__ import annotations

from itertools import product

import numpy as np


def powers(dim, degree):
    """Exponents of all monomials up to a degree, in any order but the constant first."""
    every = [e for e in product(range(degree + 1), repeat=dim) if sum(e) <= degree]
    return sorted(every, key=lambda e: (sum(e), e))


def shape_functions(offset, weight, degree):
    """phi_p = e_1^T (P^T W P)^-1 P^T W by the QR factors of W^1/2 P; offset (n, dim)."""
    P = np.array([np.prod(offset**e, axis=1) for e in map(np.array, powers(offset.shape[1], degree))]).T
    root = np.sqrt(weight)
    return np.linalg.pinv(root[:, None] * P)[0] * root


def polynomial(dim, degree, rng):
    """A random polynomial of positions (n, 3)."""
    terms = [(np.array(e), c) for e in powers(dim, degree) for c in (rng.normal(),)]
    return lambda x: sum(c * np.prod(x[:, :dim] ** e, axis=1) for e, c in terms)

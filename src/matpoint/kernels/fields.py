"""User functions of place and time, called once per particle."""

from __future__ import annotations

import numba


@numba.njit(nogil=True)
def per_particle(function, X, x, time, values):
    """values[p] = function(X_p, x_p, t) for a compiled function of two tuples and a float.

    It is not cached: the function is the user's, and Numba could not tell when it changes.
    """
    for p in range(x.shape[0]):
        a, b, c = function((X[p, 0], X[p, 1], X[p, 2]), (x[p, 0], x[p, 1], x[p, 2]), time)
        values[p, 0], values[p, 1], values[p, 2] = a, b, c

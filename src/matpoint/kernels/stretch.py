"""Lengths of rectangular domains that follow the deformation (cpGIMP)."""

from __future__ import annotations

from matpoint.jit import device, kernel
from matpoint.tensor import sqrt_sym


@device
def _gram(F, p, i, j):
    return F[p, 0, i] * F[p, 0, j] + F[p, 1, i] * F[p, 1, j] + F[p, 2, i] * F[p, 2, j]


@kernel
def longest_box(half, start, stop, inverse):
    """The longest of the boxes start:stop in cells, max 2 l_k / h_k; ``inverse`` is 1/h, 0 on missing axes."""
    longest = 0.0
    for p in range(start, stop):
        a, b, c = half[p, 0] * inverse[0], half[p, 1] * inverse[1], half[p, 2] * inverse[2]
        a = b if b > a else a
        a = c if c > a else a
        longest = a if a > longest else longest
    return 2.0 * longest


@kernel
def stretch_boxes(start, stop, F, half0, half, use_stretch_tensor):
    """l_k = l_k0 F_kk, or U_kk with U = sqrt(F^T F) (methods, section 2).

    Returns the first particle whose F_kk is not positive, or -1.
    """
    for p in range(start, stop):
        if use_stretch_tensor:
            c = (
                (_gram(F, p, 0, 0), _gram(F, p, 0, 1), _gram(F, p, 0, 2)),
                (_gram(F, p, 0, 1), _gram(F, p, 1, 1), _gram(F, p, 1, 2)),
                (_gram(F, p, 0, 2), _gram(F, p, 1, 2), _gram(F, p, 2, 2)),
            )
            u = sqrt_sym(c)
            half[p, 0], half[p, 1], half[p, 2] = (
                half0[p, 0] * u[0][0],
                half0[p, 1] * u[1][1],
                half0[p, 2] * u[2][2],
            )
        else:
            for k in range(3):
                if not F[p, k, k] > 0.0:
                    return p
                half[p, k] = half0[p, k] * F[p, k, k]
    return -1

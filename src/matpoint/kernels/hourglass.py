"""Stiffness against hourglassing of domains all of whose corners are degrees of freedom."""

from __future__ import annotations

from matpoint.jit import kernel


@kernel
def hourglass_forces(corners, stiffness, matrix, x, records, push):
    """f_a = -k sum_b M_ab x_b to the vertices' records if ``push``; return the energy 1/2 k x . M x [J].

    M = P^T P, where d = P x is what of the corners' positions no affine map of the initial domain gives
    (methods, section 4; the gap is that of Flanagan and Belytschko 1981, by positions instead of rates).
    M has no translation, so positions are taken from the first corner.
    """
    energy = 0.0
    for q in range(corners.shape[0]):
        o = corners[q, 0]
        for a in range(corners.shape[1]):
            for k in range(3):
                pull = 0.0
                for b in range(1, corners.shape[1]):
                    pull += matrix[q, a, b] * (x[corners[q, b], k] - x[o, k])
                pull *= stiffness[q]
                energy += 0.5 * pull * (x[corners[q, a], k] - x[o, k])
                if push:
                    records[8 * corners[q, a] + 4 + k] -= pull
    return energy

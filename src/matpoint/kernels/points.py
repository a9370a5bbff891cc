"""What particles hand to quadrature points, and what these carry to the nodes.

A particle hands over two lines of eight numbers: density and stress (6), a spare; velocity (3), a spare, and
body force per volume (3), a spare. ``fields`` and ``values`` are flat.
"""

from __future__ import annotations

from matpoint.jit import kernel
from matpoint.kernels.vector import pack, store

FIELDS = 16  # numbers that a particle hands to the points: two lines


@kernel
def particle_fields(start, stop, mass, volume, stress, body, v, fields):
    """Density [kg/m^3], stress [Pa], velocity [m/s] and body force [N/m^3] of particles start:stop."""
    for p in range(start, stop):
        b, density, at = p if body.shape[0] > 1 else 0, mass[p] / volume[p], FIELDS * p
        xx, yy, zz, xy, yz, xz = (
            stress[p, 0], stress[p, 1], stress[p, 2], stress[p, 3], stress[p, 4], stress[p, 5]
        )  # fmt: skip
        store(fields, at, pack(density, xx, yy, zz, xy, yz, xz, 0.0))
        fx, fy, fz = density * body[b, 0], density * body[b, 1], density * body[b, 2]
        store(fields, at + 8, pack(v[p, 0], v[p, 1], v[p, 2], 0.0, fx, fy, fz, 0.0))


@kernel
def particle_velocities(start, stop, v, fields):
    """Other velocities [m/s] for particles start:stop."""
    for p in range(start, stop):
        for a in range(3):
            fields[FIELDS * p + 8 + a] = v[p, a]


@kernel
def carry_values(start, stop, values, shares, mass, volume, stress, body, velocity):
    """What Gauss points start:stop stand for, from the fields there; ``shares`` [m^3] are those of a cell."""
    for g in range(start, stop):
        at, share = FIELDS * g, shares[g % shares.shape[0]]
        density = values[at]
        inverse = 1.0 / density if density > 0.0 else 0.0
        mass[g], volume[g] = density * share, share
        for a in range(6):
            stress[g, a] = values[at + 1 + a]
        for a in range(3):
            velocity[g, a] = values[at + 8 + a]
            body[g, a] = inverse * values[at + 12 + a]


@kernel
def carry_particles(
    start, stop, cut, first, own_mass, own_volume, own_stress, own_body, v, mass, volume, stress, body, velocity
):  # fmt: skip
    """Particles cut[start:stop] stand for themselves, as points from ``first`` on."""
    for r in range(start, stop):
        p, q = cut[r], first + r
        b = p if own_body.shape[0] > 1 else 0
        mass[q], volume[q] = own_mass[p], own_volume[p]
        for a in range(6):
            stress[q, a] = own_stress[p, a]
        for a in range(3):
            velocity[q, a], body[q, a] = v[p, a], own_body[b, a]

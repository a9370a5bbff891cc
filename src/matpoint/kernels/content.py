"""What a particle brings to a node record, and what it takes from them."""

from __future__ import annotations

from matpoint.jit import device
from matpoint.kernels.vector import lane, pack


@device
def contribution(p, v, mass, volume, stress, body, kinematic, dynamic):
    """Return (m v, m, m b) and the columns of -V sigma, as lanes of a record (S 1, 2, 7, 9).

    A node of weight w and gradient g takes w content + g_x pull_x + g_y pull_y + g_z pull_z.
    ``kinematic`` and ``dynamic`` (0 or 1) switch momentum and mass, and forces; ``body`` is (n, 3) or (1, 3).
    """
    g = p if body.shape[0] > 1 else 0
    m, f, s = kinematic * mass[p], dynamic * mass[p], -dynamic * volume[p]
    xx, yy, zz = s * stress[p, 0], s * stress[p, 1], s * stress[p, 2]
    xy, yz, xz = s * stress[p, 3], s * stress[p, 4], s * stress[p, 5]
    content = pack(
        m * v[p, 0], m * v[p, 1], m * v[p, 2], m, f * body[g, 0], f * body[g, 1], f * body[g, 2], 0.0
    )
    pull_x = pack(0.0, 0.0, 0.0, 0.0, xx, xy, xz, 0.0)
    pull_y = pack(0.0, 0.0, 0.0, 0.0, xy, yy, yz, 0.0)
    pull_z = pack(0.0, 0.0, 0.0, 0.0, xz, yz, zz, 0.0)
    return content, pull_x, pull_y, pull_z


@device
def take(
    p, start, value, along_x, along_y, along_z, v, x, x_next, gradient, dt, flip, move, differentiate
):  # fmt: skip
    """Velocity and next position (S 13, 14) if ``move``, velocity gradient (S 15) if ``differentiate``.

    ``value`` and ``along_*`` are a record and its derivatives at the particle. An empty ``x_next`` takes no
    position: the particle is where its corners are. ``gradient`` begins with particle ``start``.
    """
    for a in range(3):
        if move:
            v[p, a] = flip * (v[p, a] + lane(value, a + 4)) + (1.0 - flip) * lane(value, a)
            if x_next.shape[0] > 0:
                x_next[p, a] = x[p, a] + dt * lane(value, a)
        if differentiate:
            gradient[p - start, a, 0] = lane(along_x, a)
            gradient[p - start, a, 1] = lane(along_y, a)
            gradient[p - start, a, 2] = lane(along_z, a)

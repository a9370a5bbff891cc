"""One point and the nodes of its cell, by weights alone: no gradient is asked for."""

from __future__ import annotations

from matpoint.jit import device
from matpoint.kernels.rows import row
from matpoint.kernels.vector import fma, load, scale, store, zero


@device
def spread(ax, ay, az, ny, nz, nodes, x, a, record):
    """Add S_i(x_a) record to the nodes i around point a (S 23, 25)."""
    bx, wx, _ = row(ax, x[a, 0], 0.0)
    by, wy, _ = row(ay, x[a, 1], 0.0)
    bz, wz, _ = row(az, x[a, 2], 0.0)
    for i in range(len(wx)):
        for j in range(len(wy)):
            line = scale(wx[i] * wy[j], record)
            n = (((bx + i) * ny + by + j) * nz + bz) * 8
            for k in range(len(wz)):
                store(nodes, n, fma(wz[k], line, load(nodes, n)))
                n += 8


@device
def value_at(ax, ay, az, ny, nz, nodes, x, a):
    """Return sum_i S_i(x_a) of the nodes' records (S 17)."""
    bx, wx, _ = row(ax, x[a, 0], 0.0)
    by, wy, _ = row(ay, x[a, 1], 0.0)
    bz, wz, _ = row(az, x[a, 2], 0.0)
    value = zero()
    for i in range(len(wx)):
        for j in range(len(wy)):
            n = (((bx + i) * ny + by + j) * nz + bz) * 8
            line = zero()
            for k in range(len(wz)):
                line = fma(wz[k], load(nodes, n), line)
                n += 8
            value = fma(wx[i] * wy[j], line, value)
    return value

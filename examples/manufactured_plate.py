"""A manufactured solution of one's own: a plate that is sheared and squeezed to and fro between walls.

The displacement is written in sympy; matpoint.mms derives the body force under which it is exact, so that
the error of a run is known at every particle. On half the cell size it falls to about a quarter.
"""

import numpy as np
import sympy as sp

import matpoint as mp
from matpoint import mms
from matpoint.mms import X, Y, t

# Both components vanish on the walls that hold them, and are largest at t = 0.01 s.
swing = sp.sin(50 * sp.pi * t)
u = (
    0.02 * sp.sin(sp.pi * X) * sp.cos(sp.pi * Y) * swing,
    0.03 * sp.sin(sp.pi * X) * sp.sin(sp.pi * Y) * swing,
)
solution = mms.Manufactured(u, mp.NeoHookean(E=1e7, nu=0.3, density=1000.0))

# Nowhere in the unit square does it fold, nor is any field infinite.
x, y = np.meshgrid(np.linspace(0, 1, 17), np.linspace(0, 1, 17))
places = np.stack([x.ravel(), y.ravel(), np.zeros(x.size)], axis=1)
times = np.linspace(0, 0.01, 11)
solution.refuse_folds(places, times)
solution.refuse_infinite(places, times)


def error(cells: int) -> float:
    """Return the RMS error of the displacement [m] at 0.01 s."""
    dt = 5e-5
    square = mp.mesh_box((0.0, 0.0), (1.0, 1.0), (3 * cells, 3 * cells))
    body = mp.Body(
        square,
        solution.material,
        start=solution.start(),
        velocity=lambda X: solution.velocity(X, -0.5 * dt),  # symplectic Euler: half a step before positions
    )
    simulation = mp.Simulation(
        grid=mp.Grid((0, 0), (1, 1), 1 / cells),
        bodies=[body],
        interpolation=mp.IMLS(),
        timestep=mp.FixedStep(dt),
        boundaries=[
            mp.Fixed(mp.Plane("x", 0.0)),
            mp.Fixed(mp.Plane("x", 1.0)),
            mp.Roller(mp.Plane("y", 0.0)),
            mp.Roller(mp.Plane("y", 1.0)),
        ],
        loads=[solution.load()],
    )
    simulation.run(until=0.01)
    p = simulation.particles
    gaps = p.position - solution.position(p.position0, simulation.time)
    return float(np.sqrt((gaps**2).sum(axis=1).mean()))


coarse, fine = error(8), error(16)
order = np.log2(coarse / fine)
print(f"RMS error of the displacement: {coarse:.2e} m on 8 cells, {fine:.2e} m on 16: order {order:.2f}")
assert fine < 2.5e-4
assert 1.7 < order < 2.3

"""A disc with a soft coating, read from a Gmsh file, drops on the floor and bounces.

The core is made of triangles, the coating of quadrilaterals. The floor is the lower side of the grid.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np

import matpoint as mp

mesh = mp.read_mesh(Path(__file__).parent / "meshes" / "coated_disc.msh")
(coating,) = mesh.group("coating")
print(f"{mesh.dim}-D: {coating.n} domains in the coating, {len(coating.sets['skin'])} edges on its skin")

materials = {
    "core": mp.NeoHookean(E=1e5, nu=0.3, density=2000.0),
    "coating": mp.NeoHookean(E=1e4, nu=0.4, density=1000.0),
}
# The file has the disc around the origin; it flies down at 1 m/s.
bodies = [
    mp.Body(
        replace(domains, vertices=domains.vertices + np.array([0.25, 0.25, 0.0])),
        material,
        velocity=(0.0, -1.0),
        name=name,
    )
    for name, material in materials.items()
    for domains in mesh.group(name)
]
simulation = mp.Simulation(
    grid=mp.Grid((0, 0), (0.5, 0.5), 0.025),
    bodies=bodies,
    interpolation=mp.EnrichedCPDI2(),
    timestep=mp.CFL(0.3),
    boundaries=[mp.Roller(mp.Plane("y", 0.0))],
)
simulation.run(until=0.3)

particles = simulation.particles
rise = (particles.mass @ particles.velocity[:, 1]) / particles.mass.sum()
print(f"it came with 1 m/s and leaves with {rise:.3f} m/s")
assert 0.4 < rise < 1.0
assert abs((particles.mass @ particles.velocity[:, 0]) / particles.mass.sum()) < 0.05

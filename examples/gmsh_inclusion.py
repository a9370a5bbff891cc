"""A stiff disc in a soft plate, meshed by Gmsh and pulled: the disc's stress is nearly uniform.

A quarter of both is meshed; the physical groups "disc" and "plate" take materials. The grid's cells are
wider than the particle domains and know nothing of the circle. CPDI2 lets both materials share the strain
of a cell, so that the stress of the disc scatters; enriching the circle's vertices and those of one layer
of domains around it takes the scatter away.

Needs the extra mesh:  pip install 'matpoint[mesh]'
"""

import sys
import tempfile
from pathlib import Path

import numpy as np

import matpoint as mp

try:
    import gmsh
except OSError as error:
    print(f"Gmsh needs a library that this system lacks: {error}")
    sys.exit()


def write_mesh(path: Path, radius: float, size: float) -> None:
    """Mesh a quarter of the unit plate with a quarter disc in quadrilaterals."""
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    cad, model = gmsh.model.occ, gmsh.model
    square, full = cad.addRectangle(0, 0, 0, 1, 1), cad.addDisk(0, 0, 0, radius, radius)
    quarter, _ = cad.intersect([(2, square)], [(2, full)], removeObject=False)
    _, (parts, disc) = cad.fragment([(2, square)], quarter)
    cad.synchronize()
    hair = 1e-6
    groups = {
        "disc": disc,
        "plate": [part for part in parts if part not in disc],
        "left": model.getEntitiesInBoundingBox(-hair, -hair, -hair, hair, 1 + hair, hair, 1),
        "bottom": model.getEntitiesInBoundingBox(-hair, -hair, -hair, 1 + hair, hair, hair, 1),
        "outer": model.getEntitiesInBoundingBox(1 - hair, -hair, -hair, 1 + hair, 1 + hair, hair, 1)
        + model.getEntitiesInBoundingBox(-hair, 1 - hair, -hair, 1 + hair, 1 + hair, hair, 1),
    }
    for name, entities in groups.items():
        model.addPhysicalGroup(entities[0][0], [tag for _, tag in entities], name=name)
    gmsh.option.setNumber("Mesh.MeshSizeMax", size)
    gmsh.option.setNumber("Mesh.Algorithm", 8)
    gmsh.option.setNumber("Mesh.RecombineAll", 1)
    model.mesh.generate(2)
    gmsh.write(str(path))
    gmsh.finalize()


with tempfile.TemporaryDirectory() as folder:
    write_mesh(Path(folder) / "inclusion.msh", radius=0.4, size=0.05)
    mesh = mp.read_mesh(Path(folder) / "inclusion.msh")
for name, parts in mesh.groups.items():
    sets = {edge: len(rows) for domains in parts for edge, rows in domains.sets.items()}
    print(f"{name}: {sum(domains.n for domains in parts)} domains, edges on the boundary: {sets}")

materials = {
    "disc": mp.NeoHookean(E=1e4, nu=0.3, density=1.0),
    "plate": mp.NeoHookean(E=1e3, nu=0.3, density=1.0),
}
scatter = {}
for interpolation in (mp.CPDI2(), mp.EnrichedCPDI2(layers=1)):
    simulation = mp.Simulation(
        grid=mp.Grid((0, 0), (1.2, 1.2), 0.1),
        bodies=mesh.bodies(materials),
        interpolation=interpolation,
        timestep=mp.CFL(0.3),
        boundaries=[
            mp.Symmetry(mp.Plane("x", 0.0)),
            mp.Symmetry(mp.Plane("y", 0.0)),
            mp.PrescribedVelocity(mp.Plane("x", 1.0, "upper"), (0.01, None)),
        ],
        damping=mp.MassDamping(30.0),
    )
    simulation.run(until=0.4)
    disc = [k for k, body in enumerate(simulation.bodies) if body.name == "disc"]
    stress = simulation.particles.stress[np.isin(simulation.particles.body, disc), 0]
    scatter[interpolation.name] = stress.std() / stress.mean()
    print(f"{interpolation.name}: stress of the disc {stress.mean():.2f} ± {stress.std():.2f} Pa")
assert scatter["cpdi2"] > 0.2
assert scatter["enriched-cpdi2"] < 0.05

"""The tetrahedral mesh of the problem ``sphere-inclusion``: an octant of a sphere in a cube, by Gmsh.

Physical groups name the two materials, the planes of symmetry and the far faces. Edges are short at the
sphere and grow outward. Vertices on planes of symmetry are put on them exactly.

Needs the extra mesh:  pip install 'matpoint[mesh]'
Run as  python examples/gmsh_sphere.py folder  to keep the file, sphere.msh.
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

RADIUS, SIZE = 1.0, 2.0
HAIR = 1e-6


def write_mesh(path: Path, near: float, far: float) -> None:
    """Mesh the octant with edges of length ``near`` in the sphere and ``far`` at the cube's far faces."""
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    cad, model = gmsh.model.occ, gmsh.model
    cube, ball = cad.addBox(0, 0, 0, SIZE, SIZE, SIZE), cad.addSphere(0, 0, 0, RADIUS)
    octant, _ = cad.intersect([(3, cube)], [(3, ball)], removeObject=False)
    _, (parts, sphere) = cad.fragment([(3, cube)], octant)
    cad.synchronize()
    everywhere = [-HAIR] * 3 + [SIZE + HAIR] * 3
    groups = {"sphere": sphere, "matrix": [part for part in parts if part not in sphere], "outer": []}
    for k, axis in enumerate("xyz"):
        for name, at in ((f"{axis}-", 0.0), ("outer", SIZE)):
            box = list(everywhere)
            box[k], box[k + 3] = at - HAIR, at + HAIR
            groups.setdefault(name, []).extend(model.getEntitiesInBoundingBox(*box, 2))
    for name, entities in groups.items():
        model.addPhysicalGroup(entities[0][0], [tag for _, tag in entities], name=name)
    growth = (far - near) / (SIZE - RADIUS)
    model.mesh.field.add("MathEval", 1)
    model.mesh.field.setString(1, "F", f"{near} + {growth} * Max(0, sqrt(x*x + y*y + z*z) - {RADIUS})")
    model.mesh.field.setAsBackgroundMesh(1)
    for option in ("MeshSizeFromPoints", "MeshSizeFromCurvature", "MeshSizeExtendFromBoundary"):
        gmsh.option.setNumber(f"Mesh.{option}", 0)
    model.mesh.generate(3)
    model.mesh.optimize("Netgen")
    tags, points, _ = model.mesh.getNodes()
    for tag, point in zip(tags, np.reshape(points, (-1, 3)), strict=True):
        model.mesh.setNode(tag, np.round(point, 9) + 0.0, [])
    gmsh.option.setNumber("Mesh.MshFileVersion", 2.2)
    gmsh.write(str(path))
    gmsh.finalize()


with tempfile.TemporaryDirectory() as folder:
    target = Path(sys.argv[1] if len(sys.argv) > 1 else folder) / "sphere.msh"
    target.parent.mkdir(exist_ok=True)
    write_mesh(target, near=0.2, far=0.36)
    mesh = mp.read_mesh(target)
for name, (domains,) in mesh.groups.items():
    jacobians = domains.corner_jacobians().min(axis=1) / domains.volumes().mean()
    sets = {side: len(rows) for side, rows in domains.sets.items()}
    print(f"{name}: {domains.n} tetrahedra, smallest {jacobians.min():.2f} of the mean; faces: {sets}")
ball = sum(float(domains.volumes().sum()) for domains in mesh.group("sphere"))
print(f"volume of the sphere's octant: {ball:.4f} m^3 of {np.pi * RADIUS**3 / 6:.4f} m^3")
assert abs(ball / (np.pi * RADIUS**3 / 6) - 1) < 0.03

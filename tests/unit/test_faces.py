"""Faces of domains, the conditions and loads on them, and hourglass control."""

from __future__ import annotations

import numpy as np
import pytest

import matpoint as mp
from matpoint.boundary import Constraints
from matpoint.domains import Kind
from matpoint.faces import all_faces, check_sets, outer_faces
from matpoint.kernels.faces import face_forces
from support import KIND_OF_DIM, bind, deformed_mesh, setting_of

RUBBER = mp.NeoHookean(E=1e6, nu=0.3, density=1000.0)
SHAPES = [pytest.param(dim, kind, id=kind.name.lower()) for dim in (1, 2, 3) for kind in KIND_OF_DIM[dim]]


@pytest.mark.parametrize(("dim", "kind"), SHAPES)
def test_faces_look_outward(dim, kind):
    """div x = d: the flux of x through all faces of a domain is d times its volume."""
    mesh = deformed_mesh(dim, kind, np.random.default_rng(1))
    faces = all_faces(mesh.cells, kind)
    sign = np.where(np.arange(len(faces)) % 2 == 0, -1.0, 1.0) if kind == Kind.LINE else np.ones(len(faces))
    area = np.zeros((*faces.shape, 3))
    face_forces(faces, sign, mesh.vertices, -1.0, 0.0, 0.0, 0.0, area)
    if kind != Kind.HEX:  # faces of hexahedra are not flat; for the others N_a dA at the corners is exact
        flux = np.einsum("qca,qca->q", area, mesh.vertices[faces])
        np.testing.assert_allclose(flux.reshape(mesh.n, -1).sum(axis=1), dim * mesh.volumes(), rtol=1e-12)
    # A closed surface under pressure feels no net force, whatever its faces' shape.
    np.testing.assert_allclose(area.reshape(mesh.n, -1, 3).sum(axis=1), 0.0, atol=1e-12)


@pytest.mark.parametrize(("dim", "kind"), SHAPES)
def test_pressure_on_the_whole_outside_balances_a_pressure_inside(dim, kind):
    """Principle of virtual work: sum of face forces of -p n and internal forces of sigma = -p I vanish."""
    rng = np.random.default_rng(2)
    mesh = deformed_mesh(dim, kind, rng)
    setting = setting_of(mesh, rng)
    mapping = bind(mp.EnrichedCPDI2(where="all"), setting)
    p = setting.particles
    p.stress[:] = [-3.0, -3.0, -3.0, 0, 0, 0]
    p.volume[:] = p.volume0
    faces = outer_faces(mesh)
    sign = np.where(faces[:, 0] == 0, -1.0, 1.0) if kind == Kind.LINE else np.ones(len(faces))
    force = np.zeros((*faces.shape, 3))
    face_forces(faces, sign, mesh.vertices, 3.0, 0.0, 0.0, 0.0, force)
    mapping.push([(faces.ravel(), force.reshape(-1, 3))])
    mapping.nodes.clear(mapping.team)
    mapping.to_nodes(np.zeros((1, 3)), kinematic=True, dynamic=True)
    np.testing.assert_allclose(mapping.nodes.records[:, 4:7], 0.0, atol=1e-11)


def test_traction_of_a_slanted_quadrilateral():
    x = np.array([[0, 0, 0], [2, 0, 0], [2, 1, 1], [0, 1, 1.0]])
    force = np.zeros((1, 4, 3))
    face_forces(np.array([[0, 1, 2, 3]]), np.ones(1), x, 0.0, 1.0, 2.0, 3.0, force)
    np.testing.assert_allclose(force.sum(axis=(0, 1)), 2 * np.sqrt(2) * np.array([1, 2, 3]))
    np.testing.assert_allclose(force[0], force[0, :1] * np.ones((4, 1)))


def test_boundary_sets_must_be_faces():
    box = mp.mesh_box((0, 0), (1, 1), (2, 2))
    for rows, message in (([[0, 8]], "not a face"), ([[0, 1, 2]], "shape"), (np.zeros((0, 2), int), "empty")):
        mesh = mp.Domains(box.vertices, box.cells, box.kind, sets={"odd": np.array(rows)})
        with pytest.raises(mp.InputError, match=message):
            check_sets(mesh)


# -- conditions -------------------------------------------------------------------------------


def test_conditions_along_directions_that_are_not_orthogonal():
    """The later condition wins; the earlier one keeps what it leaves free."""
    grid = mp.Grid((0, 0), (1, 1), 0.5)
    x = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
    slant = np.array([0.6, 0.8])
    drive = mp.PrescribedVelocity(mp.Box((-1, -1), (0.5, 1)), (2.0, None))
    held = Constraints([mp.Roller(mp.Box((-1, -1), (2, 1)), tuple(slant)), drive], grid, x, False, None)
    v = np.zeros((2, 3))
    for n, normal, value in zip(held.index, held.normal, held.velocities(0.0), strict=True):
        v[n] += value * normal
    np.testing.assert_allclose(v[0, 0], 2.0)
    np.testing.assert_allclose(v[0, :2] @ slant, 0.0, atol=1e-14)  # both conditions hold at the first node
    np.testing.assert_allclose(v[1], 0.0)
    assert np.bincount(held.index).tolist() == [2, 1]
    again = Constraints([drive, mp.Fixed(mp.Box((-1, -1), (2, 1)))], grid, x, False, None)
    np.testing.assert_array_equal(again.velocities(0.0), 0.0)


def block(method=None, **options):
    options.setdefault("timestep", mp.FixedStep(2e-4))
    bodies = [
        mp.Body(mp.mesh_box((0.3, 0.3), (0.8, 0.8), (4, 4)), RUBBER, name="a"),
        mp.Body(mp.mesh_box((0.8, 0.3), (1.3, 0.8), (4, 4)), RUBBER, name="b"),
    ]
    return mp.Simulation(
        mp.Grid((0, 0), (2, 2), 0.2), bodies, interpolation=method or mp.CPDI2(), threads=1, **options
    )


def test_a_surface_is_the_outside_unless_a_body_is_named():
    sim = block(boundaries=[mp.Fixed(mp.Surface("x+"))])
    held = sim.vertices.position0[sim.vertices.enriched]
    np.testing.assert_allclose(held[:, 0], 1.3)
    sim = block(boundaries=[mp.Fixed(mp.Surface("x+", body="a"))])
    np.testing.assert_allclose(sim.vertices.position0[sim.vertices.enriched, 0], 0.8)
    sim = block(boundaries=[mp.Fixed(mp.Corners(mp.Ball((0.3, 0.3), 0.01)))])
    assert len(sim.vertices.enriched) == 1
    for _ in range(5):
        sim.advance(1e-4)
    np.testing.assert_array_equal(sim.vertices.position[sim.vertices.enriched], [[0.3, 0.3, 0.0]])


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"boundaries": [mp.Fixed(mp.Surface("top"))]}, r"surface 'top' does not exist; there are x\+ \(a\)"),
        ({"boundaries": [mp.Fixed(mp.Surface("x+", body="c"))]}, "does not exist"),
        ({"boundaries": [mp.Fixed(mp.Corners(mp.Ball((1.9, 1.9), 0.01)))]}, "no corner"),
        ({"loads": [mp.Pressure(mp.Surface("x+", body="a"), 1.0)]}, "between two bodies"),
        ({"loads": [mp.Traction(mp.Surface("x+"), (1.0, 0.0, 0.0))]}, "3 components"),
        ({"loads": [mp.Pressure(mp.Surface("x+"), 1.0)], "method": mp.CPDI1()}, "use cpdi2"),
        ({"boundaries": [mp.Fixed(mp.Surface("x+"))], "method": mp.UGIMP()}, "use cpdi2"),
        ({"method": mp.EnrichedCPDI2(where=mp.Ball((1.9, 1.9), 0.01))}, "no corner"),
    ],
)
def test_what_is_refused(options, message):
    with pytest.raises(mp.InputError, match=message):
        block(**options)


@pytest.mark.parametrize("transfer", [mp.FLIP(), mp.PIC()])
@pytest.mark.parametrize("order", [mp.USL, mp.USF, mp.MUSL])
@pytest.mark.parametrize(
    "load", [mp.Pressure(mp.Surface("x+"), 1e3), mp.Traction(mp.Surface("x+"), (0.0, 5e2))]
)
def test_the_ledger_books_what_faces_feel(order, transfer, load):
    sim = block(
        mp.EnrichedCPDI2(layers=1, hourglass=0.2), scheme=order(transfer), loads=[load], sample_every=1
    )
    sim.run(0.02)
    worst, scale = sim.ledger.worst, np.abs(sim.ledger.latest.momentum).max()
    assert scale > 1.0
    assert worst["momentum"] < 1e-9 * scale
    if transfer == mp.FLIP():
        assert worst["energy"] < 0.1 * sim.ledger.latest.kinetic


def test_work_of_a_pressure_is_what_the_body_gains():
    energy = []
    for dt in (4e-4, 1e-4):
        sim = block(loads=[mp.Pressure(mp.Surface("y+"), 2e3, ramp=0.01)], timestep=mp.FixedStep(dt))
        sim.run(0.04)
        energy.append(sim.ledger.worst["energy"] / sim.ledger.latest.external_work)
    assert energy[1] < 0.5 * energy[0] < 0.02


# -- hourglass control ----------------------------------------------------------------------------


@pytest.mark.parametrize(("dim", "kind"), [(2, Kind.QUAD), (3, Kind.HEX)])
def test_hourglass_springs_leave_affine_motions_free_and_keep_momenta(dim, kind):
    rng = np.random.default_rng(3)
    setting = setting_of(deformed_mesh(dim, kind, rng), rng)
    mapping = bind(mp.EnrichedCPDI2(where="all", hourglass=0.3), setting)
    v = mapping.vertices
    A = np.eye(3)
    A[:dim, :dim] += rng.normal(size=(dim, dim))
    v.position[:] = v.position0 @ A.T + rng.normal(size=3) * (np.arange(3) < dim)
    assert abs(mapping.stored_energy()) < 1e-14  # round-off of terms of order one
    v.position[:, :dim] += rng.normal(size=(len(v), dim)) * 0.05
    v.records[:] = 0.0
    mapping.push_vertices()
    force = v.records[:, 4:7].copy()
    np.testing.assert_allclose(force.sum(axis=0), 0.0, atol=1e-12)
    np.testing.assert_allclose(np.cross(v.position, force).sum(axis=0), 0.0, atol=1e-12)
    # Forces are minus the slope of the energy.
    before, step = mapping.stored_energy(), 1e-6
    assert before > 0.0
    direction = rng.normal(size=(len(v), 3)) * (np.arange(3) < dim)
    v.position[:] += step * direction
    above = mapping.stored_energy()
    v.position[:] -= 2 * step * direction
    slope = (above - mapping.stored_energy()) / (2 * step)
    assert slope == pytest.approx(-(force * direction).sum(), rel=1e-6)

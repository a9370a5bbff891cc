"""Bodies that begin deformed, by every interpolation."""

from __future__ import annotations

import numpy as np
import pytest

import matpoint as mp
from matpoint.errors import InputError
from matpoint.kernels.corners import SIGNS
from matpoint.materials.driver import drive
from runs import RUBBER, advance

TURN = np.array([[1.2, 0.3, 0.0], [-0.1, 0.9, 0.0], [0.0, 0.0, 1.0]])
METHODS = pytest.mark.parametrize("method", list(mp.METHODS))


def place(X):
    return X @ TURN.T


def bent(X):
    x = X.copy()
    x[:, 1] += 0.2 * X[:, 0] ** 2
    return x


def bent_gradient(X):
    F = np.tile(np.eye(3), (len(X), 1, 1))
    F[:, 1, 0] = 0.4 * X[:, 0]
    return F


AFFINE = mp.Start(place, lambda X: np.tile(TURN, (len(X), 1, 1)))
BENT = mp.Start(bent, bent_gradient)


def block(method, start, **options):
    body = mp.Body(
        mp.mesh_box((0.0, 0.0), (0.5, 0.5), (4, 4)), options.pop("material", RUBBER), start=start,
        velocity=lambda X: 0.1 * X, name="block",
    )  # fmt: skip
    options = {"timestep": mp.FixedStep(1e-4), "threads": 1} | options
    return mp.Simulation(
        mp.Grid((-1.0, -1.0), (1.0, 1.0), 0.25), [body], interpolation=mp.METHODS[method], **options
    )


@METHODS
def test_particles_begin_where_the_maps_put_them(method):
    sim, rest = block(method, AFFINE), block(method, None)
    X, p = rest.particles.ordered("position"), sim.particles
    np.testing.assert_allclose(p.ordered("position0"), X, atol=1e-15)
    np.testing.assert_allclose(p.ordered("position"), place(X), atol=1e-14)
    np.testing.assert_allclose(p.ordered("velocity"), 0.1 * X, atol=1e-15)
    np.testing.assert_allclose(p.volume, np.linalg.det(TURN) * p.volume0)
    np.testing.assert_allclose(p.stress, np.tile(drive(RUBBER, [TURN]).stress, (len(X), 1)), rtol=1e-12)
    np.testing.assert_array_equal(p.mass, RUBBER.density * p.volume0)
    if sim.vertices is not None:
        np.testing.assert_allclose(sim.vertices.position, place(sim.vertices.position0), atol=1e-14)
        np.testing.assert_allclose(sim.vertices.deformation(), p.deformation_gradient, atol=1e-12)


def test_boxes_and_parallelepipeds_are_stretched_by_the_first_deformation():
    half = block("cpgimp", AFFINE).engine.mapping.half
    np.testing.assert_allclose(half[:, :2], 0.0625 * np.array([[1.2, 0.9]] * 16))
    sim = block("cpdi1", BENT)
    v, p = sim.vertices, sim.particles
    edges = SIGNS[:4, :, None] * 0.0625 * np.eye(3) * [[1], [1], [0]]
    expected = p.position[:, None] + np.einsum("pab,cb->pca", p.deformation_gradient, edges.sum(axis=1))
    np.testing.assert_allclose(v.position[v.connectivity], expected, atol=1e-14)


def test_shared_corners_lie_on_the_map_and_particles_at_their_centroids():
    sim = block("cpdi2", BENT)
    v, p = sim.vertices, sim.particles
    np.testing.assert_array_equal(v.position, bent(v.position0))
    centroid = np.einsum("pc,pca->pa", v.weights[..., 0], v.position[v.connectivity])
    np.testing.assert_array_equal(p.position, centroid)
    # Chords of x^2 over a length h lie h^2/4 above the curve in the middle.
    gap = p.position[:, 1] - bent(p.position0)[:, 1]
    np.testing.assert_allclose(gap, 0.2 * 0.125**2 / 4, rtol=1e-10)


@METHODS
def test_a_body_that_begins_at_rest_in_a_deformed_state_springs_back_and_keeps_its_momentum(method):
    sim = block(method, AFFINE)
    before, energy = sim.quantity("momentum_x"), sim.quantity("total_energy")
    advance(sim, 20)
    if method not in ("mls", "imls", "tls", "spline-imls"):  # these don't conserve it
        assert sim.quantity("momentum_x") == pytest.approx(before, rel=1e-11)
    assert sim.quantity("total_energy") == pytest.approx(energy, rel=2e-2)


@METHODS
def test_a_restart_goes_on_as_if_nothing_had_been(method):
    whole, half, again = (block(method, BENT) for _ in range(3))
    advance(whole, 8)
    advance(half, 4)
    assert again.fingerprint() == half.fingerprint() != block(method, None).fingerprint()
    again.restore({k: np.array(v) for k, v in half.state_arrays().items()}, half.state_scalars())
    advance(again, 4)
    for name in ("position", "velocity", "stress"):
        np.testing.assert_array_equal(again.particles.ordered(name), whole.particles.ordered(name))


@pytest.mark.parametrize(
    ("start", "message"),
    [
        (mp.Start(lambda X: X + 2.0, bent_gradient), "begins from 2 to 2.5 along x, outside the grid"),
        (mp.Start(lambda X: X[:, :2], bent_gradient), "finite values of shape"),
        (mp.Start(bent, lambda X: -bent_gradient(X)), "det F is not positive at X"),
        ("here", "a Start, or None"),
    ],
)
def test_starts_that_cannot_be_are_refused(start, message):
    with pytest.raises(InputError, match=message):
        block("mpm", start)


def test_a_material_with_a_memory_and_bodies_that_come_apart_are_refused():
    steel = mp.VonMises(E=1e6, nu=0.3, density=1000.0, yield_stress=1e3)
    with pytest.raises(InputError, match="has a memory"):
        block("mpm", AFFINE, material=steel)
    parts = [mp.Body(mp.mesh_box((a, 0.0), (a + 0.5, 0.5), (2, 2)), RUBBER, name=f"{a}") for a in (0.0, 0.5)]
    moved = mp.Body(parts[1].geometry, RUBBER, start=AFFINE, name="moved")
    with pytest.raises(InputError, match="away from the body that shares it"):
        mp.Simulation(
            mp.Grid((-1.0, -1.0), (2.0, 1.0), 0.25), [parts[0], moved], interpolation=mp.CPDI2(),
            timestep=mp.FixedStep(1e-4),
        )  # fmt: skip
    with pytest.raises(InputError, match="must be a function"):
        mp.Start(1.0, bent_gradient)

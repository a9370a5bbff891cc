"""Regions, domains, filling, meshes and the joining of bodies."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import matpoint as mp
from matpoint.assembly import merge, overlap
from matpoint.domains import Domains, Kind
from matpoint.fill import fill
from reference.weights import corner_weights
from support import KIND_OF_DIM, deformed_mesh

SEEDS = st.integers(0, 2**32 - 1)
KINDS = [kind for kinds in KIND_OF_DIM.values() for kind in kinds]


# -- domains -----------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", KINDS, ids=lambda k: k.name.lower())
@given(seed=SEEDS)
def test_volumes_and_centroids_are_exact(kind, seed):
    mesh = deformed_mesh(kind.dim, kind, np.random.default_rng(seed))
    x = mesh.vertices[mesh.cells]
    for k in range(0, mesh.n, max(1, mesh.n // 5)):
        if kind in (Kind.LINE, Kind.QUAD, Kind.HEX):
            V, R, _ = corner_weights(kind.name, x[k])
        else:
            edges = (x[k, 1:] - x[k, 0])[:, : kind.dim]
            V = np.linalg.det(edges) / {2: 2.0, 3: 6.0}[kind.dim]
            R = np.full(kind.corners, 1.0 / kind.corners)
        assert mesh.volumes()[k] == pytest.approx(V, rel=1e-12)
        np.testing.assert_allclose(mesh.centroids()[k], R @ x[k], atol=1e-12)


@pytest.mark.parametrize("kind", KINDS, ids=lambda k: k.name.lower())
@given(seed=SEEDS)
def test_stand_in_boxes_and_parallelepipeds_keep_the_volume(kind, seed):
    mesh = deformed_mesh(kind.dim, kind, np.random.default_rng(seed))
    np.testing.assert_allclose(8 * mesh.half_lengths().prod(axis=1), mesh.volumes(), rtol=1e-12)
    np.testing.assert_allclose(8 * np.linalg.det(mesh.edge_vectors()), mesh.volumes(), rtol=1e-12)
    assert (mesh.half_lengths()[:, kind.dim :] == 0.5).all()


def test_a_parallelepiped_stands_for_itself():
    rng = np.random.default_rng(0)
    box = mp.mesh_box((0, 0, 0), (2, 3, 4), (1, 1, 1))
    A = np.eye(3) + 0.2 * rng.normal(size=(3, 3))
    sheared = Domains(box.vertices @ A.T, box.cells, Kind.HEX)
    np.testing.assert_allclose(sheared.edge_vectors()[0], np.diag([1.0, 1.5, 2.0]) @ A.T, atol=1e-12)
    np.testing.assert_allclose(box.half_lengths(), [[1.0, 1.5, 2.0]])


SQUARE = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0.0]])


@pytest.mark.parametrize(
    ("vertices", "cells", "kind", "message"),
    [
        (SQUARE, [[0, 3, 2, 1]], Kind.QUAD, "inverted"),
        (SQUARE * [1, 0, 1], [[0, 1, 2, 3]], Kind.QUAD, "no volume"),
        (SQUARE, [[0, 1, 3, 2]], Kind.QUAD, "tangled"),
        (SQUARE, [[0, 1, 2, 4]], Kind.QUAD, "0 to 3"),
        (SQUARE, [[0, 1, 2, -1]], Kind.QUAD, "0 to 3"),
        (SQUARE, [[0, 1, 2, 2]], Kind.QUAD, "twice"),
        (SQUARE, [[0, 1, 2]], Kind.TRI, "dangling"),
        (SQUARE, [[0, 1, 2]], Kind.QUAD, "shape"),
        (SQUARE, np.zeros((0, 4), dtype=int), Kind.QUAD, "no cells"),
        (SQUARE, [[0.0, 1.0, 2.0, 3.0]], Kind.QUAD, "whole numbers"),
        (SQUARE * np.nan, [[0, 1, 2, 3]], Kind.QUAD, "not finite"),
        (SQUARE + np.array([0, 0, 1.0]), [[0, 1, 2, 3]], Kind.QUAD, "zero coordinates"),
        (SQUARE[:, :2], [[0, 1, 2, 3]], Kind.QUAD, "shape"),
        ("text", [[0, 1, 2, 3]], Kind.QUAD, "arrays of numbers"),
    ],
)
def test_meshes_that_cant_carry_particles_are_refused(vertices, cells, kind, message):
    with pytest.raises(mp.InputError, match=message) as caught:
        Domains(vertices, np.array(cells), kind)
    assert "\n" not in str(caught.value)


def test_an_inverted_cell_is_named():
    mesh = mp.mesh_box((0, 0), (1, 1), (3, 3))
    cells = mesh.cells.copy()
    cells[5] = cells[5, ::-1]
    with pytest.raises(mp.InputError, match="cell 5"):
        Domains(mesh.vertices, cells, Kind.QUAD)


# -- filling and meshes ------------------------------------------------------------------------


@pytest.mark.parametrize("dim", [1, 2, 3])
def test_filling_a_box_is_exact_with_unique_corners(dim):
    region = mp.Box((0.5,) * dim, (1.5,) * dim)
    mesh = fill(region, (0.0,) * dim, (0.25,) * dim, dim)
    assert mesh.n == 4**dim
    assert len(mesh.vertices) == 5**dim
    assert len(np.unique(mesh.vertices, axis=0)) == 5**dim
    assert mesh.volumes().sum() == pytest.approx(1.0)
    mesh.check()


def test_filling_a_ball_tends_to_its_volume():
    errors = []
    for n in (8, 32):
        mesh = fill(mp.Ball((0.0, 0.0), 1.0), (-2.0, -2.0), (1 / n, 1 / n), 2)
        errors.append(abs(mesh.volumes().sum() - np.pi))
        mesh.check()
    assert errors[1] < 0.02
    assert errors[1] < errors[0]


def test_a_region_off_the_lattice_takes_boxes_by_their_centres():
    mesh = fill(mp.Box((0.3,), (0.9,)), (0.0,), (0.25,), 1)
    np.testing.assert_allclose(mesh.centroids()[:, 0], [0.375, 0.625, 0.875])


def test_what_cant_be_filled():
    with pytest.raises(mp.InputError, match="not bounded"):
        fill(mp.HalfSpace((0, 0), (1, 0)), (0, 0), (1, 1), 2)
    with pytest.raises(mp.InputError, match="no particles"):
        fill(mp.Ball((0.5, 0.5), 1e-3), (0, 0), (0.5, 0.5), 2)


def test_annulus_meshes():
    quarter = mp.mesh_annulus(3.0, 3.2, (8, 193))
    assert quarter.n == 1544
    assert quarter.volumes().sum() == pytest.approx(np.pi / 4 * (3.2**2 - 9), rel=1e-4)
    assert (quarter.vertices[:, :2] >= 0).all()
    assert (quarter.vertices[:, 0] == 0).sum() == (quarter.vertices[:, 1] == 0).sum() == 9
    ring = mp.mesh_annulus(1.0, 2.0, (2, 12), (0.0, 2 * np.pi), centre=(5.0, 1.0))
    assert len(ring.vertices) == 36
    np.testing.assert_allclose(ring.centroids().mean(axis=0), [5.0, 1.0, 0.0], atol=1e-12)


def test_extrusion():
    flat = mp.mesh_annulus(1.0, 2.0, (2, 6))
    solid = mp.extrude(flat, (0.0, 0.5, 2.0))
    assert solid.kind == Kind.HEX
    assert solid.n == 24
    assert solid.volumes().sum() == pytest.approx(2 * flat.volumes().sum())


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: mp.mesh_box((0, 0), (1, 0), (1, 1)), "greater"),
        (lambda: mp.mesh_box((0, 0), (1, 1), (1, 0)), "divisions"),
        (lambda: mp.mesh_box((0,), (1, 1), (1, 1)), "1 to 3"),
        (lambda: mp.mesh_annulus(2, 1, (1, 1)), "inner"),
        (lambda: mp.mesh_annulus(1, 2, (1, 2), (0.0, 2 * np.pi)), "3 divisions"),
        (lambda: mp.mesh_annulus(1, 2, (1, 2), (1.0, 0.0)), "angles"),
        (lambda: mp.extrude(mp.mesh_box((0,), (1,), (2,)), (0, 1)), "quadrilaterals"),
        (lambda: mp.extrude(mp.mesh_box((0, 0), (1, 1), (2, 2)), (1, 0)), "increase"),
        (lambda: mp.domains_from_arrays(np.zeros((2, 4)), np.zeros((1, 2), int), Kind.LINE), "shape"),
    ],
)
def test_bad_meshes(call, message):
    with pytest.raises(mp.InputError, match=message):
        call()


# -- regions -----------------------------------------------------------------------------------

POINTS = np.array([[0.5, 0.5, 0], [1.5, 0.5, 0], [-1.0, 0.0, 0], [1.0, 1.0, 0], [0.0, -0.5, 0]])


@pytest.mark.parametrize(
    ("region", "inside"),
    [
        (mp.Box((0, 0), (1, 1)), [1, 0, 0, 1, 0]),
        (mp.Box((0,), (1,)), [1, 0, 0, 1, 1]),
        (mp.Ball((0, 0), 1.0), [1, 0, 1, 0, 1]),
        (mp.Annulus(0.6, 1.5), [1, 0, 1, 1, 0]),
        (mp.Annulus(0.0, 1.5, (0.0, np.pi / 2)), [1, 0, 0, 1, 0]),
        (mp.Annulus(0.0, 1.5, (np.pi, 2 * np.pi)), [0, 0, 1, 0, 1]),
        (mp.Polygon(((0, 0), (2, 0), (0, 2))), [1, 1, 0, 1, 0]),
        (mp.HalfSpace((0.2, 0), (1, 0)), [0, 0, 1, 0, 1]),
        (mp.Box((0, 0), (1, 1)) | mp.Ball((0, 0), 0.6), [1, 0, 0, 1, 1]),
        (mp.Ball((0, 0), 1.0) - mp.Box((0, 0), (1, 1)), [0, 0, 1, 0, 1]),
        (mp.Ball((0, 0), 1.0) & mp.Box((0, 0), (1, 1)), [1, 0, 0, 0, 0]),
        (mp.Where(lambda x: x[:, 0] > x[:, 1], (-2, -2), (2, 2)), [0, 1, 0, 0, 1]),
    ],
    ids=lambda v: type(v).__name__ if isinstance(v, mp.Region) else "",
)
def test_regions(region, inside):
    np.testing.assert_array_equal(region.contains(POINTS), np.array(inside, dtype=bool))
    low, high = region.bounds()
    kept = POINTS[np.array(inside, dtype=bool)]
    assert ((kept >= low - 1e-9) & (kept <= high + 1e-9)).all()


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: mp.Box((0, 0), (1, 0)), "greater"),
        (lambda: mp.Box((0, 0), (1,)), "equally long"),
        (lambda: mp.Box((0, np.nan), (1, 1)), "finite"),
        (lambda: mp.Box((0, "a"), (1, 1)), "numbers"),
        (lambda: mp.Ball((0, 0), 0.0), "radius"),
        (lambda: mp.Ball((0, 0), -1.0), "radius"),
        (lambda: mp.Annulus(2.0, 1.0), "inner"),
        (lambda: mp.Annulus(0.0, 1.0, (1.0, 0.5)), "angles"),
        (lambda: mp.Polygon(((0, 0), (1, 1))), "3 or more"),
        (lambda: mp.Polygon(((0, 0), (1, 1), (1, 0), (0, 1))), "crosses"),
        (lambda: mp.HalfSpace((0, 0), (0, 0)), "zero"),
        (lambda: mp.Where(lambda x: x[:, 0], (0, 0), (1, 1)).contains(POINTS), "flags"),
    ],
)
def test_bad_regions(call, message):
    with pytest.raises(mp.InputError, match=message):
        call()


# -- joining bodies ----------------------------------------------------------------------------


@pytest.mark.parametrize("dim", [1, 2, 3])
def test_bodies_that_touch_share_their_corners(dim):
    rest0, rest1 = (0.0,) * (dim - 1), (1.0,) * (dim - 1)
    left = mp.mesh_box((0.0, *rest0), (1.0, *rest1), (2,) * dim)
    right = mp.mesh_box((1.0, *rest0), (3.0, *rest1), (4,) + (2,) * (dim - 1))
    joined = merge([left, right], ["left", "right"])
    vertices, cells, kind, body = joined.vertices, joined.cells, joined.kind, joined.body
    assert len(vertices) == len(left.vertices) + len(right.vertices) - 3 ** (dim - 1)
    assert len(np.unique(vertices.round(9), axis=0)) == len(vertices)
    x = vertices[cells]
    np.testing.assert_allclose(x[: left.n], left.vertices[left.cells])
    np.testing.assert_allclose(x[left.n :], right.vertices[right.cells], atol=1e-6)
    assert (np.bincount(body) == [left.n, right.n]).all()
    assert (kind == int(left.kind)).all()
    overlap([("left", left), ("right", right)])


def test_three_bodies_that_meet_in_one_vertex():
    parts = [
        mp.mesh_box((0, 0), (1, 1), (1, 1)),
        mp.mesh_box((1, 0), (2, 1), (1, 1)),
        mp.mesh_box((0, 1), (2, 2), (2, 1)),
    ]
    joined = merge(parts, ["a", "b", "c"])
    vertices, cells, body = joined.vertices, joined.cells, joined.body
    assert len(vertices) == 9
    centre = int(np.flatnonzero((vertices == [1, 1, 0]).all(axis=1))[0])
    assert set(body[(cells == centre).any(axis=1)]) == {0, 1, 2}


def test_kinds_may_mix_with_padding():
    quad = mp.mesh_box((0, 0), (1, 1), (1, 1))
    triangle = Domains(np.array([[1, 0, 0], [2, 0, 0], [1, 1, 0.0]]), np.array([[0, 1, 2]]), Kind.TRI)
    joined = merge([quad, triangle], ["quad", "triangle"])
    vertices, cells, kind = joined.vertices, joined.cells, joined.kind
    assert len(vertices) == 5
    assert cells.tolist()[1][3] == -1
    assert kind.tolist() == [1, 3]


@pytest.mark.parametrize("dim", [1, 2, 3])
def test_bodies_in_one_place_are_refused(dim):
    a = mp.mesh_box((0.0,) * dim, (1.0,) * dim, (3,) * dim)
    same = mp.mesh_box((0.0,) * dim, (1.0,) * dim, (3,) * dim)
    shifted = mp.mesh_box((0.6,) * dim, (1.6,) * dim, (2,) * dim)
    inner = mp.mesh_box((0.4,) * dim, (0.5,) * dim, (1,) * dim)
    for other in (same, shifted, inner):
        with pytest.raises(mp.InputError, match="'one' and 'two' lie in one place"):
            overlap([("one", a), ("two", other)])
    overlap([("one", a), ("two", mp.mesh_box((1.1,) * dim, (2.0,) * dim, (2,) * dim))])


def test_tetrahedra_in_one_place_are_refused():
    rng = np.random.default_rng(0)
    mesh = deformed_mesh(3, Kind.TET, rng)
    with pytest.raises(mp.InputError, match="one place"):
        overlap([("one", mesh), ("two", Domains(mesh.vertices + 0.01, mesh.cells, Kind.TET))])


def test_a_ring_in_a_ring_is_no_overlap():
    overlap([("in", mp.mesh_annulus(1.0, 2.0, (4, 40))), ("out", mp.mesh_annulus(2.0, 3.0, (4, 40)))])

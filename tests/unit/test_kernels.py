"""Every transfer kernel against a plain NumPy formulation."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

import matpoint as mp
from matpoint.grid import Grid
from matpoint.kernels import EVERY_POINT, box, corners, ledger, locate, nodes, parallelepiped, vector, vertex
from matpoint.kernels.fields import per_particle
from matpoint.kernels.order import reorder
from matpoint.kernels.stretch import stretch_boxes
from matpoint.nodes import Nodes, gimp_axis, hat_axis, spline_axis
from matpoint.sorting import Slabs, cell_order
from matpoint.threads import Team
from reference import weights as reference

GRID = Grid((0.0, -1.0, 2.0), (3.0, 3.0, 5.0), (0.5, 0.8, 0.75))


def _axis_weights(name, k, x, half, axis):
    """phi and its derivative at all nodes of one axis, by definition."""
    c, h = axis.coordinates, GRID.cell[k]
    if name == "hat":
        w = np.array([reference.hat(x, node, h) for node in c])
        d = np.where(w > 0, -np.sign(x - c) / h, 0.0)
        return w, d
    if name.startswith("gimp"):
        pairs = np.array([reference.gimp_weight(x, half, node, h) for node in c])
        return pairs[:, 0], pairs[:, 1]
    return reference.spline_weights(x, GRID.lower[k], h, GRID.cells[k], int(name[-1]))


def _axes(name, dim):
    if name == "hat":
        return [hat_axis(GRID, k, 0, 0) for k in range(dim)], np.zeros((1, 3))
    if name.startswith("gimp"):
        reach = int(name[-1])
        half = np.array(GRID.cell) * {3: 0.25, 5: 1.1}[reach]
        if name.startswith("gimp-equal"):
            return [gimp_axis(GRID, k, 3, 8, reach, half[k]) for k in range(dim)], half[None]
        return [gimp_axis(GRID, k, 3, 8, reach) for k in range(dim)], np.tile(half, (9, 1))
    return [spline_axis(GRID, k, int(name[-1])) for k in range(dim)], np.zeros((1, 3))


@pytest.mark.parametrize("dim", [1, 2, 3])
@pytest.mark.parametrize("name", ["hat", "gimp3", "gimp5", "gimp-equal3", "spline2", "spline3"])
def test_box_transfers(name, dim):
    rng = np.random.default_rng(7)
    n = 9
    axes, half = _axes(name, dim)
    field = Nodes(axes)
    x = np.zeros((n, 3))
    x[:, :dim] = rng.uniform(np.array(GRID.lower)[:dim], np.array(GRID.upper)[:dim], (n, dim))
    phi, grad = np.ones((n, 1)), [np.ones((n, 1)) for _ in range(3)]
    for k in range(3):
        if k < dim:
            rows = [_axis_weights(name, k, x[p, k], half[-1, k], axes[k]) for p in range(n)]
            w, d = np.array([r[0] for r in rows]), np.array([r[1] for r in rows])
        else:
            w, d = np.ones((n, 1)), np.zeros((n, 1))
        phi = np.einsum("pi,pj->pij", phi, w).reshape(n, -1)
        grad = [np.einsum("pi,pj->pij", g, d if k == a else w).reshape(n, -1) for a, g in enumerate(grad)]
    grad = np.stack(grad, axis=2)  # (p, i, 3)
    v, m, V = rng.normal(size=(n, 3)), rng.uniform(1, 2, n), rng.uniform(1, 2, n)
    s, b = rng.normal(size=(n, 6)), rng.normal(size=(n, 3))
    sigma = s[:, [[0, 3, 5], [3, 1, 4], [5, 4, 2]]]
    box.particles_to_nodes(
        *field.rows, field.shape[1], field.shape[2], field.flat, np.arange(1), 0, 1,
        np.array([0, n]), np.arange(n, dtype=np.int32), x, half, v, m, V, s, b, 1.0, 1.0,
    )  # fmt: skip
    got = field.records
    np.testing.assert_allclose(got[:, 3], phi.T @ m, atol=1e-12)
    np.testing.assert_allclose(got[:, :3], phi.T @ (m[:, None] * v), atol=1e-12)
    force = phi.T @ (m[:, None] * b) - np.einsum("pib,pab,p->ia", grad, sigma, V)
    np.testing.assert_allclose(got[:, 4:7], force, atol=1e-11)

    field.records[:] = rng.normal(size=field.records.shape)
    after, increment = field.records[:, :3], field.records[:, 4:7]
    v1, x1, L = v.copy(), np.zeros_like(x), np.zeros((n, 3, 3))
    box.nodes_to_particles(
        *field.rows,
        field.shape[1],
        field.shape[2],
        field.flat,
        0,
        n,
        x,
        half,
        v1,
        x1,
        L,
        0.1,
        0.7,
        True,
        True,
    )
    np.testing.assert_allclose(v1, 0.7 * (v + phi @ increment) + 0.3 * (phi @ after), atol=1e-12)
    np.testing.assert_allclose(x1, x + 0.1 * (phi @ after), atol=1e-12)
    np.testing.assert_allclose(L, np.einsum("ia,pib->pab", after, grad), atol=1e-11)

    # APIC, by its definition with a dense D.
    B = np.zeros((n, 3, 3))
    box.nodes_to_affine(
        *field.rows, field.shape[1], field.shape[2], field.flat, 0, n, x, half, B, *field.coordinates
    )
    arm = field.positions()[None] - x[:, None]
    D = np.einsum("pi,pia,pib->pab", phi, arm, arm)
    expected = np.einsum("pi,ia,pib->pab", phi, after, arm)
    np.testing.assert_allclose(B, expected, atol=1e-11)
    inverse = np.zeros_like(D)
    inverse[:, :dim, :dim] = np.linalg.inv(D[:, :dim, :dim])
    C = expected @ inverse
    field.records[:] = 0.0
    box.affine_to_nodes(
        *field.rows, field.shape[1], field.shape[2], field.flat, np.arange(1), 0, 1, np.array([0, n]),
        np.arange(n, dtype=np.int32), x, half, m, B, *field.coordinates,
    )  # fmt: skip
    np.testing.assert_allclose(field.records[:, :3], np.einsum("pi,p,pab,pib->ia", phi, m, C, arm), atol=1e-9)


@pytest.mark.parametrize(("kind", "number", "count"), [("LINE", 0, 2), ("QUAD", 1, 4), ("HEX", 2, 8)])
def test_corner_weights_are_exact_integrals(kind, number, count):
    rng = np.random.default_rng(3)
    _, _ = reference._shape(kind, 0.0, 0.0, 0.0)
    for _ in range(5):
        signs = corners.SIGNS[:count].copy()
        signs[:, {0: 1, 1: 2, 2: 3}[number] :] = 0.0
        x = signs * 0.5
        x[:, : number + 1] += rng.uniform(-0.15, 0.15, (count, number + 1))
        V, R, G = reference.corner_weights(kind, x)
        weights, position = np.zeros((1, count, 4)), np.zeros((1, 3))
        connectivity = np.arange(count, dtype=np.int32)[None]
        bad = corners.corner_weights(
            0, 1, np.array([number], dtype=np.int8), connectivity, x, weights, position
        )
        assert bad == -1
        np.testing.assert_allclose(weights[0, :, 0], R, atol=1e-13)
        np.testing.assert_allclose(weights[0, :, 1:], G, atol=1e-12)
        np.testing.assert_allclose(position[0], R @ x, atol=1e-13)
        assert V > 0


def test_quad_and_hexahedron_that_turn_over_are_found():
    quad = np.array([[0, 0, 0], [1, 0, 0], [0.2, 0.2, 0], [0, 1, 0.0]])  # a dent: one corner is reflex
    hexa = np.concatenate([quad + np.array([0, 0, z]) for z in (0.0, 1.0)])
    for number, x in ((1, quad), (2, hexa)):
        n = len(x)
        weights, position = np.zeros((1, n, 4)), np.zeros((1, 3))
        kind = np.array([number], dtype=np.int8)
        connectivity = np.arange(n, dtype=np.int32)[None]
        assert corners.corner_weights(0, 1, kind, connectivity, x, weights, position) == 0
        assert not position.any()  # where the particle is, it stays


def test_gradients_are_the_volume_derivative():
    """G_a = (1/V) dV/dx_a for quads, hexes, triangles and tetrahedra, by finite differences."""
    rng = np.random.default_rng(5)
    base = {1: corners.SIGNS[:4] * [1, 1, 0], 2: corners.SIGNS, 3: np.eye(3)[[2, 0, 1]] * [1, 1, 0]}
    base[4] = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
    for number, shape in base.items():
        dim = 2 if number in (1, 3) else 3
        x = shape.astype(float).copy()
        x[:, :dim] += rng.uniform(-0.1, 0.1, (len(x), dim))
        n = len(x)
        weights, position = np.zeros((1, n, 4)), np.zeros((1, 3))
        kind, connectivity = np.array([number], dtype=np.int8), np.arange(n, dtype=np.int32)[None]
        assert corners.corner_weights(0, 1, kind, connectivity, x, weights, position) == -1
        for a in range(n):
            for k in range(dim):
                step = np.zeros_like(x)
                step[a, k] = 1e-6
                rate = (_volume(number, x + step) - _volume(number, x - step)) / 2e-6
                assert weights[0, a, k + 1] == pytest.approx(rate / _volume(number, x), abs=1e-8)


def _volume(number, x):
    if number in (1, 3):
        return 0.5 * float(np.sum(x[:, 0] * np.roll(x[:, 1], -1) - x[:, 1] * np.roll(x[:, 0], -1)))
    if number == 4:
        return float(np.linalg.det(x[1:] - x[0])) / 6
    return reference.corner_weights("HEX", x)[0]


@pytest.mark.parametrize("dim", [1, 2, 3])
def test_parallelepipeds_have_the_weights_of_their_corners(dim):
    rng = np.random.default_rng(11)
    n, count = 4, 2**dim
    x, F = rng.normal(size=(n, 3)), np.tile(np.eye(3), (n, 1, 1))
    x[:, dim:] = 0.0
    F[:, :dim, :dim] += rng.uniform(-0.2, 0.2, (n, dim, dim))
    edges0 = np.tile(np.eye(3) * 0.5, (n, 1, 1))
    edges, far = np.empty_like(edges0), np.zeros(3)
    parallelepiped.stretch_edges(0, n, F, edges0, edges, far)
    corner, weights = np.zeros((n * count, 3)), np.zeros((n, count, 4))
    parallelepiped.parallelepipeds(0, n, dim, x, edges, corner, weights)
    offset = np.abs(corner.reshape(n, count, 3) - x[:, None])
    np.testing.assert_allclose(far[:dim], offset.max(axis=(0, 1))[:dim], atol=1e-14)
    own, position = np.zeros((n, count, 4)), np.zeros((n, 3))
    kind = np.full(n, dim - 1, dtype=np.int8)
    connectivity = np.arange(n * count, dtype=np.int32).reshape(n, count)
    assert corners.corner_weights(0, n, kind, connectivity, corner, own, position) == -1
    np.testing.assert_allclose(weights, own, atol=1e-12)
    np.testing.assert_allclose(position, x, atol=1e-12)


@pytest.mark.parametrize("dim", [1, 2, 3])
def test_parallelepipeds_transfer_what_their_corners_would(dim):
    rng = np.random.default_rng(17)
    grid = Grid((0.0,) * dim, (2.0,) * dim, 0.25)
    n, count = 7, 2**dim
    x, edges = np.zeros((n, 3)), np.tile(np.eye(3) * 0.5, (n, 1, 1))
    x[:, :dim] = rng.uniform(0.7, 1.3, (n, dim))
    edges[:, :dim, :dim] = 0.2 * np.eye(dim) + rng.uniform(-0.05, 0.05, (n, dim, dim))
    v, m, V = rng.normal(size=(n, 3)), rng.uniform(1, 2, n), rng.uniform(1, 2, n)
    s, b = rng.normal(size=(n, 6)), rng.normal(size=(n, 3))
    corner, weights = np.zeros((n * count, 3)), np.zeros((n, count, 4))
    parallelepiped.parallelepipeds(0, n, dim, x, edges, corner, weights)
    connectivity = np.arange(n * count, dtype=np.int32).reshape(n, count)
    kinds, records = np.full(n, dim - 1, dtype=np.int8), vector.records(n * count)
    through, at_once = (Nodes([hat_axis(grid, k, 0, 0) for k in range(dim)]) for _ in range(2))
    ny, nz = through.shape[1:]
    vertex.particles_to_vertices(
        np.arange(1), 0, 1, np.array([0, n]), connectivity, kinds, np.full(n, 255, dtype=np.uint8), weights,
        v, m, V, s, b, 1.0, 1.0, records.reshape(-1),
    )  # fmt: skip
    vertex.vertices_to_nodes(
        *through.rows, ny, nz, through.flat, np.arange(1), 0, 1, np.array([0, n * count]),
        np.arange(n * count, dtype=np.int32), corner, records.reshape(-1),
    )  # fmt: skip
    parallelepiped.particles_to_nodes(
        *at_once.rows, ny, nz, at_once.flat, np.arange(1), 0, 1, np.array([0, n]),
        np.arange(n, dtype=np.int32), dim, x, edges, v, m, V, s, b, 1.0, 1.0,
    )  # fmt: skip
    np.testing.assert_allclose(at_once.records, through.records, atol=1e-12)
    assert np.abs(at_once.records[:, 4:7]).max() > 1.0

    vertex.nodes_to_vertices(
        *through.rows, ny, nz, through.flat, 0, n * count, np.arange(n * count, dtype=np.int32), corner,
        records.reshape(-1), np.zeros_like(corner), 0.0, False,
    )  # fmt: skip
    found = []
    for own in (False, True):
        v1, x1, L = v.copy(), np.zeros((n, 3)), np.zeros((n, 3, 3))
        if own:
            parallelepiped.nodes_to_particles(
                *at_once.rows, ny, nz, through.flat, 0, n, dim, x, edges, v1, x1, L, 0.1, 0.6, True, True
            )
        else:
            vertex.vertices_to_particles(
                0, n, connectivity, kinds, weights, records.reshape(-1), v1, x, x1, L, 0.1, 0.6, True, True
            )
        found.append((v1, x1, L))
    for a, c in zip(*found, strict=True):
        np.testing.assert_allclose(a, c, atol=1e-11)


def test_slabs_of_parallelepipeds_have_room_for_rounding():
    """A domain of two cells whose centre lies on a border: rounding may put its corner one cell farther."""
    sim = mp.Simulation(
        mp.Grid((1.9,) * 2, (11.9,) * 2, 0.5),
        [mp.Body(mp.mesh_box((4.9,) * 2, (8.9,) * 2, (4, 4)), mp.NeoHookean(1e6, 0.3, 1e3))],
        interpolation=mp.CPDI1(),
        timestep=mp.FixedStep(1e-4),
    )
    assert sim.engine.mapping.nodes.slabs[:2] == (5, 5)


def test_vertex_transfers():
    rng = np.random.default_rng(13)
    field = Nodes([hat_axis(GRID, k, 0, 0) for k in range(2)])
    nv, n = 12, 6
    x = np.zeros((nv, 3))
    x[:, :2] = rng.uniform(GRID.lower[:2], GRID.upper[:2], (nv, 2))
    connectivity = rng.integers(0, nv, (n, 4)).astype(np.int32)
    weights, v = rng.normal(size=(n, 4, 4)), rng.normal(size=(n, 3))
    m, V, s, b = rng.uniform(1, 2, n), rng.uniform(1, 2, n), rng.normal(size=(n, 6)), rng.normal(size=(1, 3))
    edges, kinds = np.array([0, 2, 4, n]), np.ones(n, dtype=np.int8)
    seen, first = np.zeros(nv, dtype=bool), np.zeros(n, dtype=np.uint8)
    vertex.find_first(edges, connectivity, kinds, seen, first)
    np.testing.assert_array_equal(seen, np.isin(np.arange(nv), connectivity))
    assert sum(int(bits).bit_count() for bits in first) == seen.sum()
    records = vector.records(nv)
    records[seen] = 7.0  # of the step before
    vertex.particles_to_vertices(
        np.array([0, 2, 1]), 0, 3, edges, connectivity, kinds, first, weights,
        v, m, V, s, b, 1.0, 1.0, records.reshape(-1),
    )  # fmt: skip
    R, G = np.zeros((nv, n)), np.zeros((nv, n, 3))
    for p in range(n):
        for c in range(4):
            R[connectivity[p, c], p] += weights[p, c, 0]
            G[connectivity[p, c], p] += weights[p, c, 1:]
    sigma = s[:, [[0, 3, 5], [3, 1, 4], [5, 4, 2]]]
    np.testing.assert_allclose(records[:, 3], R @ m, atol=1e-12)
    np.testing.assert_allclose(records[:, :3], R @ (m[:, None] * v), atol=1e-12)
    force = R @ (m[:, None] * b) - np.einsum("apb,pcb,p->ac", G, sigma, V)
    np.testing.assert_allclose(records[:, 4:7], force, atol=1e-12)

    S = np.array(
        [
            np.outer(
                [reference.hat(a[0], c, GRID.cell[0]) for c in field.coordinates[0]],
                [reference.hat(a[1], c, GRID.cell[1]) for c in field.coordinates[1]],
            ).ravel()
            for a in x
        ]
    )
    vertex.vertices_to_nodes(
        *field.rows, field.shape[1], field.shape[2], field.flat, np.arange(1), 0, 1,
        np.array([0, nv]), np.arange(nv, dtype=np.int32), x, records.reshape(-1),
    )  # fmt: skip
    np.testing.assert_allclose(field.records, S.T @ records, atol=1e-11)
    back = vector.records(nv)
    moved, again = np.zeros_like(x), np.zeros_like(x)
    vertex.nodes_to_vertices(
        *field.rows, *field.shape[1:], field.flat, 0, nv, np.arange(nv, dtype=np.int32), x, back.reshape(-1),
        moved, 0.3, True,
    )  # fmt: skip
    np.testing.assert_allclose(back, S @ field.records, atol=1e-11)
    np.testing.assert_allclose(moved, x + 0.3 * back[:, :3], atol=1e-14)
    vertex.move_vertices(1, 4, np.array([0, 2, 5, 7, 8]), back.reshape(-1), x, again, 0.3)
    np.testing.assert_array_equal(again[[2, 5, 7]], moved[[2, 5, 7]])
    assert not again[[0, 8]].any()
    v1, x0, x1, L = v.copy(), rng.normal(size=(n, 3)), np.zeros((n, 3)), np.zeros((n, 3, 3))
    vertex.vertices_to_particles(
        0,
        n,
        connectivity,
        kinds,
        weights,
        back.reshape(-1),
        v1,
        x0,
        x1,
        L,
        0.1,
        0.6,
        True,
        True,
    )
    np.testing.assert_allclose(v1, 0.6 * (v + R.T @ back[:, 4:7]) + 0.4 * (R.T @ back[:, :3]), atol=1e-11)
    np.testing.assert_allclose(x1, x0 + 0.1 * (R.T @ back[:, :3]), atol=1e-11)
    np.testing.assert_allclose(L, np.einsum("ac,apb->pcb", back[:, :3], G), atol=1e-11)


def test_solve_with_damping():
    rng = np.random.default_rng(2)
    records = rng.normal(size=(6, 8))
    records[:, 3] = [1.0, 2.0, 0.0, 3.0, 1e-300, 0.5]
    records[4, [0, 1, 2, 4, 5, 6]] *= 1e-300
    start, dt, rate, factor = records.copy(), 0.1, 0.4, 0.3
    other = records.copy()
    nodes.solve(records.reshape(-1), 1, 3, 2, 1, (1, 0, 0), (3, 2, 1), dt, rate, factor)
    np.testing.assert_array_equal(records[:2], other[:2])  # nodes of the first plane are not active
    nodes.solve(records.reshape(-1), 0, 1, 2, 1, (0, 0, 0), (1, 2, 1), dt, rate, factor)
    nodes.solve(other.reshape(-1), 0, 1, 1, 1, (0, 0, 0), (1, 1, 6), dt, rate, factor)
    np.testing.assert_array_equal(records, other)
    for n in range(6):
        m = start[n, 3]
        if m == 0.0:
            assert not records[n, [0, 1, 2, 4, 5, 6]].any()
            continue
        v, f = start[n, :3] / m, start[n, 4:7]
        f = f - factor * np.abs(f) * np.sign(v)
        np.testing.assert_allclose(records[n, 4:7], (f / m - rate * v) * dt, rtol=1e-12)
        np.testing.assert_allclose(records[n, :3], v + records[n, 4:7], rtol=1e-12)


@pytest.mark.parametrize("flip", [1.0, 0.0, 0.8])
def test_constrain_and_its_reaction(flip):
    rng = np.random.default_rng(4)
    records = rng.normal(size=(5, 8))
    records[:, 3] = [1.0, 2.0, 3.0, 0.0, 1.5]
    start = records.copy()
    index = np.array([1, 1, 2, 3])
    normal = np.array([[1.0, 0, 0], [0, 1.0, 0], [0.6, 0.8, 0], [1.0, 0, 0]])
    points = rng.normal(size=(4, 3))
    before, after, external = np.array([0.1, 0.0, 0.3, 9.0]), np.array([0.2, 0.0, 0.4, 9.0]), np.zeros(7)
    nodes.constrain(records, index, points, normal, before, after, flip, external)
    end, begin = records[:, :3], records[:, :3] - records[:, 4:7]
    for c in range(3):
        assert end[index[c]] @ normal[c] == pytest.approx(after[c])
        assert begin[index[c]] @ normal[c] == pytest.approx(before[c])
    np.testing.assert_allclose(records[[0, 3, 4]], start[[0, 3, 4]])
    # What FLIP and PIC particles receive from the conditions is what the ledger books.
    change = flip * (records[:, 4:7] - start[:, 4:7]) + (1 - flip) * (records[:, :3] - start[:, :3])
    np.testing.assert_allclose(external[:3], start[:, 3] @ change, atol=1e-12)


@pytest.fixture
def in_pieces(monkeypatch):
    """Let few points be worth several pieces."""
    monkeypatch.setattr("matpoint.threads._WORTH_IT", 1)
    monkeypatch.setattr("matpoint.threads._SHORTEST", 64)
    monkeypatch.setattr("matpoint.sorting._WORTH_IT", 1)


@pytest.mark.parametrize("threads", [1, 3])
def test_slabs_are_a_stable_sort_across_the_axis_that_the_points_fill(threads, in_pieces):
    rng = np.random.default_rng(6)
    field = Nodes([hat_axis(GRID, k, 0, 0) for k in range(3)])
    x = rng.uniform(np.array(GRID.lower), np.array(GRID.upper), (5000, 3))
    chosen = rng.permutation(5000)[:4000].astype(np.int32)
    team = Team(threads)
    for points in (chosen, EVERY_POINT):
        picked = points if len(points) else np.arange(5000)
        slabs = Slabs(field, team, 5000, points)
        slabs.renew(x, x.min(0), x.max(0))  # 6, 5 and 4 cells: across the first axis
        slab = ((x[picked, 0] - GRID.lower[0]) / GRID.cell[0]).astype(int)
        np.testing.assert_array_equal(slabs.order, picked[np.argsort(slab, kind="stable")])
        np.testing.assert_array_equal(slabs.pointer, np.searchsorted(np.sort(slab), np.arange(7)))
    corner = x[(x[:, 0] < 0.4) & (x[:, 1] > 0.7)]
    slabs = Slabs(field, team, len(corner))
    slabs.renew(corner, corner.min(0), corner.max(0))  # 1, 3 and 4 cells: across the last
    slab = ((corner[:, 2] - GRID.lower[2]) / GRID.cell[2]).astype(int)
    np.testing.assert_array_equal(slabs.order, np.argsort(slab, kind="stable"))
    team.close()


@pytest.mark.parametrize("chosen", [EVERY_POINT, np.arange(11, 20000, 3, dtype=np.int32)])
@pytest.mark.parametrize("threads", [1, 3])
def test_a_survey_on_the_way_to_slabs_changes_nothing_but_the_time(threads, chosen, in_pieces):
    rng = np.random.default_rng(10)
    field, team = Nodes([hat_axis(GRID, k, 0, 0) for k in range(3)]), Team(threads)
    lower, upper = np.array(GRID.lower), np.array(GRID.upper)
    x = rng.uniform(lower + 0.01, lower + 0.4 * (upper - lower), (20000, 3))
    slabs = Slabs(field, team, len(x), chosen)
    # Across one cell border, across none, into a block that is longest along another axis, and out.
    for way in ((0.3, 0.0, 0.0), (1e-4, 0.0, 0.0), (0.0, 0.0, 0.5), (0.0, 0.0, 0.0)):
        x = np.minimum(x + np.array(way) * (upper - lower), upper)
        lost, low, high = slabs.survey(x, lower, upper)
        assert lost == -1
        np.testing.assert_array_equal([low, high], [x.min(0), x.max(0)])
        slabs.renew(x, low, high)
        fresh = Slabs(field, team, len(x), chosen)
        fresh.renew(x, low, high)
        np.testing.assert_array_equal(slabs.order, fresh.order)
        np.testing.assert_array_equal(slabs.pointer, fresh.pointer)
    x[[7000, 19000]] += 10.0
    assert slabs.survey(x, lower, upper)[0] == 7000
    team.close()


@pytest.mark.parametrize("reach", [3, 5, 8])
def test_slabs_of_averaged_hats_are_as_thick_as_what_boxes_of_any_size_write_to(reach):
    rng = np.random.default_rng(9)
    r, half = rng.uniform(10, 11, 4000), rng.uniform(0, 0.5 * (reach - 2), 4000)
    half[:9] = 0.5 * (reach - 2)
    r[:9], half[0] = 10.0, half[0] + 5e-10  # a hair more is taken
    first = np.floor(r - half).astype(int)
    below, above = 10 - first, first + reach - 1 - 10
    assert below.max() + above.max() == gimp_axis(GRID, 0, 3, 8, reach).slab


@pytest.mark.parametrize("threads", [1, 3])
@pytest.mark.parametrize("dim", [1, 2, 3])
def test_cell_order_is_a_stable_sort(dim, threads, in_pieces):
    rng = np.random.default_rng(7)
    grid = Grid(GRID.lower[:dim], GRID.upper[:dim], GRID.cell[:dim])
    x = np.zeros((5000, 3))
    x[:, :dim] = rng.uniform(np.array(grid.lower) - 1e-3, np.array(grid.upper) + 1e-3, (5000, dim))
    cells = np.floor((x[:, :dim] - grid.lower) / grid.cell).astype(int) + 1
    key = np.ravel_multi_index(cells.T, np.array(grid.cells) + 2)
    team = Team(threads)
    order = np.argsort(key, kind="stable")
    np.testing.assert_array_equal(cell_order(team, grid, x), order)
    assert cell_order(team, grid, x[order]) is None
    team.close()


def test_runs_of_particles_two_apart_share_no_vertex():
    rng = np.random.default_rng(8)
    n, nv = 400, 300
    near = np.sort(rng.integers(0, nv - 20, n))
    connectivity = (near[:, None] + rng.integers(0, 20, (n, 4))).astype(np.int32)
    connectivity[::7, 3] = -1
    edges = np.zeros(n + 2, dtype=np.int64)
    taken = vertex.independent_blocks(connectivity, nv, 8, edges)
    edges = edges[:taken]
    assert edges[0] == 0
    assert edges[-1] == n
    assert (np.diff(edges)[:-1] >= 8).all()
    runs = [set(connectivity[a:b].ravel().tolist()) - {-1} for a, b in itertools.pairwise(edges.tolist())]
    assert len(runs) > 5
    for k, run in enumerate(runs):
        for other in runs[k + 2 :]:
            assert not run & other


def test_points_outside_are_found():
    x = np.array([[0.5, 0, 0], [1.5, 0, 0], [np.nan, 0, 0]])
    low, high = np.array([0.0, -np.inf, -np.inf]), np.array([1.0, np.inf, np.inf])
    least, most = np.zeros(3), np.zeros(3)
    assert locate.survey(x, 0, 1, low, high, least, most) == -1
    assert locate.survey(x, 0, 3, low, high, least, most) == 1
    assert locate.survey(x, 2, 3, low, high, least, most) == 2
    y = np.random.default_rng(1).normal(size=(20, 3))
    assert locate.survey(y, 0, 20, low - np.inf, high + np.inf, least, most) == -1
    np.testing.assert_array_equal(least, y.min(axis=0))
    np.testing.assert_array_equal(most, y.max(axis=0))
    half = np.full((3, 3), 0.6)
    assert locate.find_stretched(x, half, 0, 1, low, high) == 0


def test_stretched_boxes():
    rng = np.random.default_rng(8)
    F = np.eye(3) + rng.uniform(-0.3, 0.3, (5, 3, 3))
    half0, half = rng.uniform(0.1, 0.2, (5, 3)), np.zeros((5, 3))
    assert stretch_boxes(0, 5, F, half0, half, False) == -1
    np.testing.assert_allclose(half, half0 * np.einsum("pkk->pk", F), rtol=1e-14)
    assert stretch_boxes(0, 5, F, half0, half, True) == -1
    values, vectors = np.linalg.eigh(np.einsum("pac,pad->pcd", F, F))
    U = np.einsum("pkm,pm,plm->pkl", vectors, np.sqrt(values), vectors)
    np.testing.assert_allclose(half, half0 * np.einsum("pkk->pk", U), rtol=1e-10)
    F[3, 1, 1] = 0.0
    assert stretch_boxes(0, 5, F, half0, half, False) == 3


def test_compiled_user_field():
    import numba

    @numba.njit
    def push(X, x, t):
        return X[0] + t, 2.0 * x[1], 3.0

    rng = np.random.default_rng(9)
    X, x, values = rng.normal(size=(4, 3)), rng.normal(size=(4, 3)), np.zeros((4, 3))
    per_particle(push, X, x, 0.5, values)
    np.testing.assert_allclose(values, np.stack([X[:, 0] + 0.5, 2 * x[:, 1], np.full(4, 3.0)], axis=1))


@pytest.mark.parametrize("rows", [1, 5])
def test_sums_of_loads(rows):
    rng = np.random.default_rng(10)
    m, body = rng.uniform(1, 2, 5), rng.normal(size=(rows, 3))
    before, after = rng.normal(size=(5, 3)), rng.normal(size=(5, 3))
    sums = np.full((3, 7), np.nan)
    ledger.sum_loads(2, m, body, before, after, sums)
    force = m[:, None] * body
    total = sums.sum(axis=0)
    np.testing.assert_allclose(total[:3], force.sum(axis=0))
    assert total[3] == pytest.approx((force * (after - before)).sum())
    np.testing.assert_allclose(total[4:], np.cross(before, force).sum(axis=0))


def test_sums_of_motion_and_of_apics_moments():
    rng = np.random.default_rng(11)
    m, x, v, B = rng.uniform(1, 2, 7), *rng.normal(size=(2, 7, 3)), rng.normal(size=(7, 3, 3))
    sums, moments = np.full((3, 8), np.nan), np.full((3, 3), np.nan)
    ledger.sum_motion(0, 3, 3, m, x, v, sums)
    ledger.sum_motion(3, 7, 3, m, x, v, sums)
    ledger.sum_moments(0, 7, 3, m, B, moments)
    assert sums[1, 0] == pytest.approx(m[3:6].sum())
    total = sums.sum(axis=0)
    np.testing.assert_allclose(total[1:4], m @ v)
    np.testing.assert_allclose(total[4:7], m @ np.cross(x, v))
    assert total[7] == pytest.approx(m @ (v**2).sum(axis=1))
    b = np.einsum("p,pab->ab", m, B)
    np.testing.assert_allclose(moments.sum(axis=0), [b[2, 1] - b[1, 2], b[0, 2] - b[2, 0], b[1, 0] - b[0, 1]])


def test_rows_take_a_new_order_in_place():
    rng = np.random.default_rng(12)
    done = np.zeros(50, dtype=bool)
    for order in (rng.permutation(50), np.arange(50), np.roll(np.arange(50), 1)):
        rows = rng.integers(0, 255, (50, 24)).astype(np.uint8)
        wanted = rows[order]
        reorder(order, rows, done, np.zeros(24, dtype=np.uint8))
        np.testing.assert_array_equal(rows, wanted)
        assert not done.any()

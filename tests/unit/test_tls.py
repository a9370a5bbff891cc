"""Conservative Taylor least squares: what it keeps, what it reproduces, and where it gives way."""

from __future__ import annotations

import numpy as np
import pytest

import matpoint as mp
from matpoint.domains import Kind
from matpoint.problems import PROBLEMS
from runs import RUBBER, advance, two_blocks
from support import bind, deformed_mesh, setting_of

KIND = {1: Kind.LINE, 2: Kind.QUAD, 3: Kind.HEX}


def _crowd(dim, rng, per_cell=4):
    """A setting whose particles stand at random and fill the whole grid, with random fields."""
    setting = setting_of(deformed_mesh(dim, KIND[dim], rng), rng)
    grid = setting.grid
    n = int(np.prod(grid.cells)) * per_cell
    p = mp.Particles(n)
    p.position[:, :dim] = rng.uniform(grid.lower, grid.upper, (n, dim))
    p.volume[:] = np.prod(np.subtract(grid.upper, grid.lower)) / n
    p.volume0[:] = p.volume
    p.mass[:] = p.volume * rng.uniform(0.5, 2.0, n)
    p.velocity[:, :dim] = rng.normal(size=(n, dim))
    p.stress[:] = rng.normal(size=(n, 6))
    setting.particles = p
    setting.domains_half = np.ones((n, 3)) * rng.uniform(0.05, 0.3, (n, 1))
    return setting


@pytest.mark.parametrize("dim", [1, 2, 3])
@pytest.mark.parametrize(
    "options", [{}, {"degree": 2, "points": 3}, {"degree": 3, "points": 1}, {"degree": 0}]
)
def test_cells_keep_mass_momentum_force_and_mean_stress(dim, options):
    rng = np.random.default_rng(4)
    setting = _crowd(dim, rng)
    mapping = bind(mp.TLS(boxes=False, **options), setting)
    p, q = setting.particles, mapping.quadrature
    body = rng.normal(size=(len(p), 3))
    mapping.nodes.clear(mapping.team)
    mapping.to_nodes(body, kinematic=True, dynamic=True)
    records = mapping.nodes.records
    np.testing.assert_allclose(records[:, 3].sum(), p.mass.sum(), rtol=1e-13)
    np.testing.assert_allclose(records[:, :3].sum(axis=0), p.mass @ p.velocity, rtol=0, atol=1e-12)
    np.testing.assert_allclose(records[:, 4:7].sum(axis=0), p.mass @ body, rtol=0, atol=1e-11)
    assert (q.mass > 0).all()
    whole = np.unique(q.cell)
    assert len(whole) > 0.3 * np.prod(setting.grid.cells)
    for c in whole:
        inside, at = mapping.cells.cell == c, np.flatnonzero(q.cell == c)
        if not inside.any():
            assert not q.mass[at].any()
            continue
        m = p.mass[inside]
        np.testing.assert_allclose(q.mass[at].sum(), m.sum(), rtol=1e-12)
        np.testing.assert_allclose(q.mass[at] @ q.velocity[at], m @ p.velocity[inside], atol=1e-12)
        np.testing.assert_allclose(q.mass[at] @ q.body[at], m @ body[inside], atol=1e-12)
        mean = p.volume[inside] @ p.stress[inside] / p.volume[inside].sum()
        np.testing.assert_allclose(q.volume[at] @ q.stress[at] / q.volume[at].sum(), mean, atol=1e-12)


@pytest.mark.parametrize("dim", [1, 2, 3])
def test_boxes_count_for_the_cells_that_they_lie_in(dim):
    """Shares by overlaps of intervals; what lies in no whole cell stays at its particle."""
    rng = np.random.default_rng(8)
    setting = _crowd(dim, rng)
    p, grid = setting.particles, setting.grid
    p.deformation_gradient[:] += rng.uniform(-0.3, 0.3, p.deformation_gradient.shape)
    half = setting.domains_half * np.abs(np.einsum("pkk->pk", p.deformation_gradient))
    mapping = bind(mp.TLS(), setting)
    mapping.nodes.clear(mapping.team)
    mapping.to_nodes(np.zeros((1, 3)), kinematic=True, dynamic=True)
    q = mapping.quadrature
    rest = np.ones(len(p))
    for c in np.unique(q.cell):
        share = np.ones(len(p))
        at = np.unravel_index(c, tuple(mapping.cells.cells))[:dim]
        for a, k in enumerate(mapping.cells.first[:dim] + np.array(at)):
            low, x, wide = grid.lower[a] + k * grid.cell[a], p.position[:, a], half[:, a]
            length = np.minimum(x + wide, low + grid.cell[a]) - np.maximum(x - wide, low)
            share *= np.maximum(length, 0.0) / (2 * wide)
        rest -= share
        at = np.flatnonzero(q.cell == c)
        np.testing.assert_allclose(q.mass[at].sum(), share @ p.mass, atol=1e-12)
        np.testing.assert_allclose(q.mass[at] @ q.velocity[at], (share * p.mass) @ p.velocity, atol=1e-12)
    np.testing.assert_allclose(q.mass[len(q.cell) :], (rest * p.mass)[rest > 1e-14], atol=1e-12)
    records = mapping.nodes.records
    np.testing.assert_allclose(records[:, 3].sum(), p.mass.sum(), rtol=1e-13)
    np.testing.assert_allclose(records[:, :3].sum(axis=0), p.mass @ p.velocity, rtol=0, atol=1e-12)


@pytest.mark.parametrize("dim", [1, 2, 3])
@pytest.mark.parametrize("degree", [1, 2])
def test_fits_are_least_squares_but_for_the_mean(dim, degree):
    """Differences between the Gauss points of a cell, against NumPy's least squares."""
    rng = np.random.default_rng(9)
    setting = _crowd(dim, rng, 12)
    mapping = bind(mp.TLS(degree=degree, boxes=False, tolerance=1e-8), setting)
    p, q, grid = setting.particles, mapping.quadrature, setting.grid
    mapping.nodes.clear(mapping.team)
    mapping.to_nodes(np.zeros((1, 3)), kinematic=True, dynamic=True)

    def columns(x):
        y = (x[:, :dim] - np.array(grid.lower)) / np.array(grid.cell)
        parts = [np.ones(len(y)), *y.T]
        if degree == 2:
            parts += [y[:, a] * y[:, b] for a in range(dim) for b in range(a, dim)]
        return np.stack(parts, axis=1)

    checked = 0
    for c in np.unique(q.cell)[:20]:
        inside, at = mapping.cells.cell == c, np.flatnonzero(q.cell == c)
        A = columns(p.position[inside])
        if len(A) < A.shape[1] or np.linalg.cond(A) > 1e6:
            continue
        checked += 1
        for values, found in ((p.stress[inside], q.stress[at]), (p.velocity[inside], q.velocity[at])):
            fit = columns(q.position[at]) @ np.linalg.lstsq(A, values, rcond=None)[0]
            np.testing.assert_allclose(found - found[0], fit - fit[0], atol=1e-7)
    assert checked > 3


def test_linear_stress_without_its_mean_and_constant_density_are_reproduced():
    rng = np.random.default_rng(2)
    setting = _crowd(2, rng, 9)
    p = setting.particles
    p.mass[:] = 3.0 * p.volume
    p.stress[:] = p.position[:, :1] * 2.0 - p.position[:, 1:2]
    mapping = bind(mp.TLS(keep_stress=False, boxes=False), setting)
    mapping.nodes.clear(mapping.team)
    mapping.to_nodes(np.zeros((1, 3)), kinematic=True, dynamic=True)
    q = mapping.quadrature
    g = len(q.cell)
    rich = q.ranks == 3
    assert rich.mean() > 0.9
    expected = q.position[:g, :1] * 2.0 - q.position[:g, 1:2]
    np.testing.assert_allclose(q.stress[:g][rich], np.broadcast_to(expected, (g, 6))[rich], atol=1e-9)
    # The density is constant in each cell, since that of the particles is.
    cells = q.mass[:g].reshape(-1, 4)
    np.testing.assert_allclose(cells, cells[:, :1] * np.ones(4), rtol=1e-9, atol=1e-14)


def test_one_particle_in_a_cell_and_particles_on_a_line_lower_the_rank():
    sim = two_blocks(mp.TLS(degree=2))
    sim.engine.locate(), sim.engine.clear(), sim.engine.gather()
    assert sim.quantity("grid_mass_error") < 1e-14
    rng = np.random.default_rng(0)
    setting = _crowd(2, rng, 1)
    p = setting.particles
    p.position[:, 1] = 0.2  # a single row of cells, all on one line
    p.volume[:] = 10.0
    mapping = bind(mp.TLS(degree=2, boxes=False), setting)
    mapping.nodes.clear(mapping.team)
    mapping.to_nodes(np.zeros((1, 3)), kinematic=True, dynamic=True)
    counts = np.bincount(mapping.cells.cell, minlength=len(mapping.cells.filled))[mapping.quadrature.cell]
    assert (mapping.ranks <= np.minimum(counts, 3)).all()  # 1, x, x^2
    assert np.isfinite(mapping.nodes.records).all()


def test_particles_level_with_a_cell_s_centre_have_no_column_across_it():
    """Their distances from it are rounding, not a direction in which something varies."""
    rng = np.random.default_rng(6)
    setting = _crowd(2, rng, 1)
    p, grid = setting.particles, setting.grid
    cells = np.stack(np.unravel_index(np.arange(len(p)) // 4, grid.cells), axis=1)
    centre = np.array(grid.lower) + (cells + 0.5) * np.array(grid.cell)
    p.position[:, :2] = centre
    p.position[:, 0] *= 1.0 + 1e-16 * rng.integers(-3, 4, len(p))
    p.position[:, 1] += grid.cell[1] * rng.uniform(-0.5, 0.5, len(p))
    p.volume[:] = 10.0
    mapping = bind(mp.TLS(boxes=False), setting)
    mapping.nodes.clear(mapping.team)
    mapping.to_nodes(np.zeros((1, 3)), kinematic=True, dynamic=True)
    assert mapping.ranks.max() == 2
    speed = np.abs(mapping.quadrature.velocity).max()
    assert speed < 40 * np.abs(p.velocity).max()


@pytest.mark.parametrize(("seed", "cells"), [(7, 8), (7, 32), (3, 32)])
def test_particles_placed_at_random_run_and_keep_the_rank_honest(seed, cells):
    """Columns that hardly differ between four particles used to make a fit explode at the first steps."""
    problem = PROBLEMS["mms-2d"](cells=cells, staggered=True, random=seed)
    sim = problem.simulation(mp.TLS(), threads=1)
    sim.run(problem.end / 4)
    assert problem.errors(sim)[0] < {8: 6e-4, 32: 6e-5}[cells]
    assert 1 <= sim.quantity("smallest_rank") <= 3
    assert sim.quantity("grid_mass_error") < 1e-13
    assert sim.quantity("grid_momentum_error") < 1e-13


def test_the_smallest_rank_is_that_of_cells_with_a_particle():
    problem = PROBLEMS["mms-2d"](cells=16, staggered=True, per_cell=1)
    sim = problem.simulation(mp.TLS(), threads=1)
    sim.run(problem.end / 4)
    assert (np.bincount(sim.engine.mapping.cells.cell, minlength=256) == 0).any()
    assert sim.quantity("smallest_rank") == 1


@pytest.mark.parametrize("dim", [1, 2, 3])
def test_blocks_collide_and_the_grid_has_their_mass(dim):
    sim = advance(two_blocks(mp.TLS(), dim), 100)
    assert sim.quantity("grid_mass_error") < 1e-13
    assert sim.quantity("grid_momentum_error") < 1e-13
    assert np.isfinite(sim.particles.velocity).all()


def test_sorting_and_a_restart_keep_each_particle_its_box():
    def start():
        return two_blocks(mp.TLS(), scheme=mp.MUSL(mp.XPIC(3)), sort_every=7)

    straight, first, second = advance(start(), 40), advance(start(), 20), start()
    arrays = {name: a.copy() for name, a in first.state_arrays().items()}
    second.restore(arrays, first.state_scalars())
    advance(second, 20)
    for name in ("id", "position", "velocity", "stress"):
        np.testing.assert_array_equal(getattr(straight.particles, name), getattr(second.particles, name))


@pytest.mark.parametrize("transfer", [mp.FLIP(), mp.XPIC(3)])
def test_stress_noise_of_a_bar_that_stretches_through_its_grid_falls(transfer):
    """Second differences of the stress from particle to particle; MPM's are errors of crossing."""
    noise = {}
    for choice in (mp.Linear(), mp.TLS()):
        body = mp.Body(mp.Box((0.0,), (1.0,)), RUBBER, 3, velocity=lambda x: 3.0 * np.sin(2 * np.pi * x))
        walls = [mp.Fixed(mp.Plane("x", 0.0)), mp.Fixed(mp.Plane("x", 1.0))]
        sim = mp.Simulation(
            mp.Grid(0.0, 1.0, 1 / 32), [body], interpolation=choice, scheme=mp.USL(transfer),
            timestep=mp.FixedStep(1e-4), boundaries=walls, threads=1,
        )  # fmt: skip
        advance(sim, 150)
        s = sim.particles.ordered("stress")[:, 0]
        noise[choice.name] = float(np.abs(np.diff(s, 2)).mean())
    assert noise["tls"] < 0.5 * noise["mpm"]


def test_wrong_options_are_refused():
    wrong = [
        {"degree": 4},
        {"degree": -1},
        {"points": 5},
        {"points": 0},
        {"tolerance": 1.0},
        {"basis": mp.UGIMP()},
    ]
    for options in [*wrong, {"keep_stress": 1}, {"boxes": 0}]:
        with pytest.raises(mp.InputError, match=f"TLS: {next(iter(options))}"):
            mp.TLS(**options)

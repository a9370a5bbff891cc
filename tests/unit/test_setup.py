"""Grids, bodies, conditions, loads and time steps: what they do, and what they refuse."""

from __future__ import annotations

import math

import numpy as np
import pytest

import matpoint as mp
from matpoint.boundary import Constraints
from matpoint.interpolation.enriched import interface_vertices, widen
from matpoint.loads import Loads
from matpoint.timestep import stable_step
from runs import RUBBER, SOFT, advance, two_blocks

GRID = mp.Grid((0, 0), (2, 1), 0.25)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (((0, 0), (1, 1), 0.3), "whole number"),
        (((0, 0), (1, 1), -0.5), "positive"),
        (((0, 0), (1, 0), 0.5), "greater"),
        (((0, 0), (1, math.inf), 0.5), "finite"),
        (((0, 0, 0, 0), (1, 1, 1, 1), 0.5), "1 to 3"),
        (((0, 0), (1,), 0.5), "agree"),
        (((0, "a"), (1, 1), 0.5), "numbers"),
        (((0, 0, 0), (1, 1, 1), 1e-4), "nodes"),
    ],
)
def test_bad_grids(arguments, message):
    with pytest.raises(mp.InputError, match=message):
        mp.Grid(*arguments)


def test_grid_sizes():
    grid = mp.Grid((0, -1), (1, 1), (0.25, 0.5))
    assert (grid.dim, grid.cells, grid.finest) == (2, (4, 4), 0.25)
    assert mp.Grid(0.0, 1.0, 0.1).cells == (10,)


def _simulation(**options):
    options.setdefault("interpolation", mp.Linear())
    options.setdefault("timestep", mp.FixedStep(1e-4))
    bodies = options.pop("bodies", [mp.Body(mp.Box((0.5, 0.25), (1.0, 0.75)), RUBBER)])
    return mp.Simulation(options.pop("grid", GRID), bodies, threads=1, **options)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: mp.Body("cube", RUBBER), "region or Domains"),
        (lambda: mp.Body(mp.Box((0,), (1,)), "rubber"), "must be a material"),
        (lambda: mp.Body(mp.Box((0,), (1,)), RUBBER, per_cell=0), "per_cell"),
        (lambda: mp.Body(mp.Box((0,), (1,)), RUBBER, velocity=(math.nan,)), "velocity"),
        (lambda: _simulation(bodies=[]), "no bodies"),
        (lambda: _simulation(bodies=[mp.Body(mp.Box((0, 0), (3, 1)), RUBBER)]), "outside the grid"),
        (lambda: _simulation(bodies=[mp.Body(mp.mesh_box((0,), (1,), (2,)), RUBBER)]), "1-D"),
        (lambda: _simulation(bodies=[mp.Body(mp.Box((0, 0), (1, 1)), RUBBER, (2, 2, 2))]), "per_cell"),
        (
            lambda: _simulation(bodies=[mp.Body(mp.Box((0, 0), (1, 1)), RUBBER, velocity=lambda x: x[0])]),
            "shape",
        ),
        (lambda: _simulation(sort_every=0), "sort_every"),
        (lambda: _simulation(scheme=mp.USL("flip")), "transfer"),
        (lambda: _simulation(interpolation=mp.CPDI2(), scheme=mp.USL(mp.APIC())), "APIC"),
        (lambda: mp.BSpline(4), "degree"),
        (lambda: mp.CPGIMP("V"), "stretch"),
        (lambda: mp.EnrichedCPDI2(-1), "layers"),
        (lambda: mp.FLIP(1.5), "blend"),
        (lambda: mp.FixedStep(-1.0), "dt"),
        (lambda: mp.CFL(0.0), "fraction"),
        (lambda: mp.CFL(0.5, every=0), "every"),
        (lambda: mp.CFL(0.5, largest=-1.0), "largest"),
        (lambda: mp.MassDamping(-1.0), "rate"),
        (lambda: mp.LocalDamping(1.0), "factor"),
        (lambda: mp.Gravity((0, math.nan)), "finite"),
        (lambda: mp.Gravity((0, -1), ramp=-1.0), "ramp"),
        (lambda: _simulation(loads=[mp.Gravity((0, 0, -1))]), "gravity"),
        (lambda: mp.Plane("w", 0.0), "axis"),
        (lambda: mp.Plane("x", math.nan), "finite"),
        (lambda: mp.Plane("x", 0.0, "left"), "side"),
        (lambda: mp.Roller(mp.Box((0,), (1,))), "normal"),
        (lambda: mp.Roller(mp.Box((0,), (1,)), (0.0, 0.0)), "not zero"),
        (lambda: mp.PrescribedVelocity(mp.Plane("x", 0.0), (None, None)), "at least one"),
        (lambda: _simulation(boundaries=[mp.Fixed(mp.Plane("x", 0.3))]), "nearest is 0.25"),
        (lambda: _simulation(boundaries=[mp.Fixed(mp.Plane("z", 0.0))]), "does not exist"),
        (lambda: _simulation(boundaries=[mp.Fixed(mp.Ball((9.0, 9.0), 0.1))]), "no node"),
        (
            lambda: _simulation(interpolation=mp.BSpline(2), boundaries=[mp.Fixed(mp.Plane("x", 0.5))]),
            "face of the grid",
        ),
        (
            lambda: _simulation(boundaries=[mp.PrescribedVelocity(mp.Plane("x", 0.0), (1.0,))]),
            "2 axes",
        ),
    ],
)
def test_what_is_refused(call, message):
    with pytest.raises(mp.InputError, match=message) as caught:
        call()
    assert "\n" not in str(caught.value)


def test_run_needs_an_end_after_the_start():
    sim = _simulation()
    for end in (0.0, -1.0, math.nan):
        with pytest.raises(mp.InputError, match="end time"):
            sim.run(end)


# -- conditions --------------------------------------------------------------------------------


def test_planes_take_the_nodes_on_and_beyond_them():
    x = np.array([[k * 0.25, 0.0, 0.0] for k in range(-2, 11)])
    low = mp.Plane("x", 0.0).select(GRID, x)
    assert low.sum() == 3
    assert low[:3].all()
    high = mp.Plane("x", 1.75, "upper").select(GRID, x)
    assert high.sum() == 4
    inner = mp.Plane(0, 0.5, "lower").select(GRID, x)
    assert inner.sum() == 5


def no_vertices(where):
    raise AssertionError(where)


def test_prescribed_velocity_of_place_and_time():
    x = np.array([[0.0, 0.0, 0], [0.0, 0.5, 0], [1.0, 0.5, 0]])
    condition = mp.PrescribedVelocity(mp.Plane("x", 0.0), (lambda x, t: t * x[:, 1], None))
    held = Constraints([condition], GRID, x, False, no_vertices)
    np.testing.assert_array_equal(held.index, [0, 1])
    np.testing.assert_allclose(held.velocities(2.0), [0.0, 1.0])
    broken = Constraints(
        [mp.PrescribedVelocity(mp.Plane("x", 0.0), (lambda x, t: np.nan, None))], GRID, x, False, no_vertices
    )
    with pytest.raises(mp.InputError, match="not a finite"):
        broken.velocities(0.0)


@pytest.mark.parametrize("interpolation", [mp.Linear(), mp.UGIMP(), mp.BSpline(2), mp.CPDI1(), mp.CPDI2()])
def test_a_moving_wall_drives_the_body_and_does_the_work(interpolation):
    """A block glued to a wall that is set in motion follows it on average; the ledger closes."""
    grid = mp.Grid((0.0,), (2.0,), 0.125)
    body = mp.Body(mp.Box((0.0,), (0.5,)), RUBBER)
    wall = mp.PrescribedVelocity(mp.Plane("x", 0.0), (lambda x, t: 0.05 * min(t / 0.02, 1.0),))
    sim = mp.Simulation(
        grid, [body], interpolation=interpolation, timestep=mp.FixedStep(2e-4), boundaries=[wall],
        sample_every=1, threads=1,
    )  # fmt: skip
    speeds = []
    for _ in range(800):
        sim.advance(2e-4)
        speeds.append(sim.particles.mass @ sim.particles.velocity[:, 0] / sim.particles.mass.sum())
    assert np.mean(speeds[200:]) == pytest.approx(0.05, rel=0.1)
    assert sim.ledger.worst["momentum"] < 1e-9
    work = sim.ledger.latest.external_work
    assert work == pytest.approx(sim.ledger.latest.kinetic + sim.ledger.latest.strain, rel=0.05)


def test_rollers_and_symmetry_hold_the_normal_only():
    body = mp.Body(mp.Box((0.0, 0.0), (0.5, 0.5)), RUBBER, velocity=(0.1, 0.2))
    for condition in (mp.Roller(mp.Plane("x", 0.0)), mp.Symmetry(mp.Plane("x", 0.0))):
        sim = mp.Simulation(
            GRID,
            [body],
            interpolation=mp.Linear(),
            timestep=mp.FixedStep(1e-4),
            boundaries=[condition],
            threads=1,
        )
        sim.advance(1e-4)
        x = sim.engine.mapping.nodes.positions()
        v = sim.engine.mapping.nodes.records
        wall = (x[:, 0] == 0.0) & (v[:, 3] > 0)
        assert np.abs(v[wall, 0]).max() == 0.0
        np.testing.assert_allclose(v[wall, 1], 0.2)


def test_enriched_vertices_on_a_plane_obey_it():
    """An interface that runs into a fixed plane: its vertices there stand still."""
    grid = mp.Grid((0, 0), (1.0, 1.0), 0.25)
    bodies = [
        mp.Body(mp.mesh_box((0.25, 0.5), (0.375, 1.0), (1, 4)), RUBBER),
        mp.Body(mp.mesh_box((0.375, 0.5), (0.5, 1.0), (1, 4)), SOFT),
    ]
    sim = mp.Simulation(
        grid, bodies, interpolation=mp.EnrichedCPDI2(), timestep=mp.FixedStep(1e-4),
        boundaries=[mp.Fixed(mp.Plane("y", 1.0))], loads=[mp.Gravity((0.0, -10.0))], threads=1,
    )  # fmt: skip
    v = sim.vertices
    assert len(v.enriched) == 5
    np.testing.assert_allclose(v.position0[v.enriched, 0], 0.375)
    advance(sim, 50)
    moved = np.abs(v.position - v.position0).max(axis=1)
    top = v.enriched[np.abs(v.position0[v.enriched, 1] - 1.0) < 1e-12]
    assert len(top) == 1
    assert moved[top].max() == 0.0
    assert moved[np.setdiff1d(v.enriched, top)].min() > 1e-8


def test_enrichment_takes_interfaces_triple_points_and_layers():
    """A 6 x 6 patch: three materials that meet in one point."""
    mesh = mp.mesh_box((0, 0), (6, 6), (6, 6))
    x = mesh.centroids()
    material = np.where(x[:, 0] < 3, 0, np.where(x[:, 1] < 3, 1, 2))
    first = interface_vertices(mesh.cells, material, len(mesh.vertices))
    chosen, layer, everything = (np.flatnonzero(widen(first, mesh.cells, n)) for n in (0, 1, 9))
    at = {tuple(p) for p in mesh.vertices[chosen, :2]}
    assert at == {(3.0, float(y)) for y in range(7)} | {(float(k), 3.0) for k in range(3, 7)}
    one = mesh.vertices[layer]
    assert {tuple(p) for p in one[:, :2]} == {
        (float(i), float(j)) for i in range(7) for j in range(7) if 2 <= i <= 4 or (i > 3 and 2 <= j <= 4)
    }
    assert len(everything) == len(mesh.vertices)
    assert not interface_vertices(mesh.cells, 0 * material, len(mesh.vertices)).any()


# -- loads and time steps ----------------------------------------------------------------------


def test_loads_add_up():
    p = _simulation().particles
    ramped = mp.Gravity((0.0, -10.0), ramp=2.0)
    pulsed = mp.Gravity((1.0,), history=math.cos)
    both = Loads([ramped, pulsed], 2).evaluate(p, 1.0)
    np.testing.assert_allclose(both, [[math.cos(1.0), -5.0, 0.0]])
    field = mp.BodyForce(lambda X, x, t: 2 * X + t)
    total = Loads([ramped, field], 2).evaluate(p, 3.0)
    np.testing.assert_allclose(total, 2 * p.position0 + 3.0 + [0.0, -10.0, 0.0])
    with pytest.raises(mp.InputError, match="shape"):
        Loads([mp.BodyForce(lambda X, x, t: X[0])], 2).evaluate(p, 0.0)
    with pytest.raises(mp.InputError, match="not a finite"):
        Loads([mp.BodyForce(lambda X, x, t: X * np.nan)], 2).evaluate(p, 0.0)


def test_a_free_fall_is_exact():
    sim = _simulation(loads=[mp.Gravity((0.0, -10.0))], interpolation=mp.CPDI2())
    advance(sim, 100)
    np.testing.assert_allclose(sim.particles.velocity[:, 1], -10.0 * sim.time, rtol=1e-12)
    fallen = sim.particles.position0[:, 1] - sim.particles.position[:, 1]
    # Symplectic Euler: dt^2 (1 + 2 + ... + n) g.
    np.testing.assert_allclose(fallen, 10.0 * 1e-8 * 100 * 101 / 2, rtol=1e-9)
    # Velocities stand half a step before positions, so work runs ahead by 1 / n.
    assert sim.ledger.worst["energy"] == pytest.approx(sim.ledger.latest.kinetic / 100)


def test_the_limit_by_hand():
    sim = _simulation(bodies=[mp.Body(mp.Box((0.5, 0.25), (1.0, 0.75)), RUBBER, velocity=(3.0, 4.0))])
    E, nu, rho = RUBBER.E, RUBBER.nu, RUBBER.density
    c = math.sqrt(E * (1 - nu) / ((1 + nu) * (1 - 2 * nu)) / rho)
    assert stable_step(sim) == pytest.approx(0.25 / (c + 5.0))
    fluid = mp.NewtonianFluid(viscosity=1e6, bulk_modulus=1e3, density=1000.0)
    thick = _simulation(
        bodies=[mp.Body(mp.Box((0.5, 0.25), (1.0, 0.75)), fluid)], timestep=mp.FixedStep(1e-7)
    )
    assert stable_step(thick) < 0.25**2 / (2 * 2 * 1e3)


def test_enriched_vertices_shorten_the_limit():
    plain, enriched = two_blocks_touching(mp.CPDI2()), two_blocks_touching(mp.EnrichedCPDI2())
    assert enriched.vertex_spacing().min() == pytest.approx(0.0625)
    ratio = stable_step(enriched) / stable_step(plain)
    assert ratio == pytest.approx(0.7 * 0.0625 / 0.125)


def two_blocks_touching(interpolation):
    grid = mp.Grid((0, 0), (2, 1), 0.125)
    bodies = [
        mp.Body(mp.Box((0.5, 0.25), (1.0, 0.75)), RUBBER),
        mp.Body(mp.Box((1.0, 0.25), (1.5, 0.75)), SOFT),
    ]
    return mp.Simulation(grid, bodies, interpolation=interpolation, timestep=mp.FixedStep(1e-4), threads=1)


def test_a_step_over_the_limit_is_refused_with_both_numbers():
    limit = stable_step(_simulation())
    with pytest.raises(mp.InputError) as caught:
        _simulation(timestep=mp.FixedStep(2 * limit))
    assert f"{2 * limit:.4g}" in str(caught.value)
    assert f"{limit:.4g}" in str(caught.value)
    with pytest.warns(UserWarning, match="over the stability limit"):
        sim = _simulation(timestep=mp.FixedStep(2 * limit, allow_unstable=True))
    assert sim.notes


def test_cfl_steps_follow_the_state_and_end_on_time():
    sim = two_blocks(mp.CPDI2(), timestep=mp.CFL(0.3))
    sim.run(0.0123)
    assert sim.time == pytest.approx(0.0123, rel=1e-12)
    assert sim.step == pytest.approx(0.0123 / (0.3 * 0.125 / 38.7), rel=0.2)
    held = two_blocks(mp.CPDI2(), timestep=mp.CFL(0.3, largest=1e-4))
    held.run(0.001)
    assert held.step == 10


def test_damping_takes_energy():
    results = {}
    for name, damping in (("none", None), ("mass", mp.MassDamping(50.0)), ("local", mp.LocalDamping(0.5))):
        grid = mp.Grid((0.0,), (1.5,), 0.125)
        body = mp.Body(mp.Box((0.0,), (1.0,)), RUBBER)
        sim = mp.Simulation(
            grid, [body], interpolation=mp.CPDI2(), timestep=mp.FixedStep(2e-4), damping=damping,
            boundaries=[mp.Fixed(mp.Plane("x", 0.0))], loads=[mp.Gravity((10.0,))], threads=1,
        )  # fmt: skip
        sim.run(0.5)
        results[name] = sim
    assert results["local"].quantity("kinetic_energy") < 1e-4 * results["none"].ledger.latest.strain
    assert results["mass"].quantity("kinetic_energy") < 1e-4 * results["none"].ledger.latest.strain
    # At rest the stress carries the weight, rho g (1 - x), up to half a particle: both particles of a
    # cell share its strain.
    for name in ("mass", "local"):
        p = results[name].particles
        np.testing.assert_allclose(
            p.stress[:, 0], 1000.0 * 10.0 * (1.0 - p.position0[:, 0]), rtol=0.02, atol=320
        )


# -- failures of runs --------------------------------------------------------------------------


def test_a_number_that_is_not_one_is_found():
    sim = two_blocks(mp.CPDI2())
    advance(sim, 3)
    particle = int(np.argmax(sim.particles.position[:, 0]))
    sim.particles.velocity[particle] = np.nan
    with pytest.raises(mp.RunError) as caught:
        advance(sim, 3)
    assert "not a finite number" in str(caught.value)
    assert caught.value.step in (3, 4)
    assert caught.value.exit_code == 3


def test_a_deformation_that_turns_inside_out_is_found():
    sim = two_blocks(mp.Linear())
    sim.particles.deformation_gradient[7, 0, 0] = -1.0
    with pytest.raises(mp.RunError, match="det F") as caught:
        sim.advance(1e-4)
    assert caught.value.particle == sim.particles.id[7]
    assert len(caught.value.position) == 3


def test_cpgimp_names_a_domain_that_vanishes_or_outgrows_the_grid():
    from runs import spinning_block

    sim = spinning_block(mp.CPGIMP())
    sim.particles.deformation_gradient[:, 0, 0] = 1e-9
    sim.particles.velocity[:, 0] = -1e4 * sim.particles.position[:, 0]
    with pytest.raises(mp.RunError, match=r"stretch='U'|det F"):
        sim.advance(2e-4)
    wide = spinning_block(mp.CPGIMP(), cells=4)
    wide.particles.deformation_gradient[:, 0, 0] = 30.0
    with pytest.raises(mp.RunError, match="use CPDI"):
        wide.advance(1e-9)

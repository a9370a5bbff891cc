"""Conservation, invariance and reproducibility of whole runs."""

from __future__ import annotations

import numpy as np
import pytest

import matpoint as mp
from matpoint.ledger import take_entry
from runs import RUBBER, SOFT, advance, spinning_block, two_blocks

BOX = [mp.Linear(), mp.UGIMP(), mp.CPGIMP(), mp.CPGIMP("U"), mp.BSpline(2), mp.BSpline(3)]
VERTEX = [mp.CPDI1(), mp.CPDI2(), mp.EnrichedCPDI2(), mp.EnrichedCPDI2(layers=2)]
SCHEMES = [mp.USL(), mp.USF(), mp.MUSL(), mp.USL(mp.FLIP(0.9)), mp.MUSL(mp.PIC())]
APIC_SCHEMES = [mp.USL(mp.APIC()), mp.USF(mp.APIC()), mp.MUSL(mp.APIC())]


def _id(value):
    if isinstance(value, mp.Scheme):
        return f"{value.name}-{value.transfer.name}{value.transfer.share:g}"
    return value.name + str(getattr(value, "stretch", "")) + str(getattr(value, "layers", ""))


COMBINATIONS = [(i, s) for i in BOX + VERTEX for s in SCHEMES] + [(i, s) for i in BOX for s in APIC_SCHEMES]


@pytest.mark.parametrize(("interpolation", "scheme"), COMBINATIONS, ids=_id)
def test_mass_and_momentum_are_conserved_in_a_collision(interpolation, scheme):
    """Hundreds of steps, particles crossing cells, two materials, no wall."""
    sim = advance(two_blocks(interpolation, scheme=scheme, sample_every=1), 300)
    scale = float(sim.particles.mass @ np.abs(sim.particles.velocity[:, 0])) + 1.0
    assert sim.ledger.worst["mass"] < 1e-13 * sim.ledger.start.mass
    assert sim.ledger.worst["momentum"] < 1e-10 * scale
    # They met: momentum went over, and the bodies' mean velocities changed.
    left = sim.particles.body == 0
    assert sim.particles.velocity[left, 0].mean() < 1.0


@pytest.mark.parametrize("interpolation", BOX, ids=_id)
def test_apic_conserves_angular_momentum(interpolation):
    sim = advance(spinning_block(interpolation, scheme=mp.USL(mp.APIC()), sample_every=1), 200)
    total = float(np.linalg.norm(sim.ledger.start.angular_momentum))
    assert sim.ledger.worst["angular_momentum"] < 1e-11 * total
    pic = advance(spinning_block(interpolation, scheme=mp.USL(mp.PIC()), sample_every=1), 200)
    assert pic.ledger.worst["angular_momentum"] > 0.9 * total  # PIC loses the spin that APIC keeps


@pytest.mark.parametrize("dim", [1, 2, 3])
@pytest.mark.parametrize("interpolation", BOX + VERTEX, ids=_id)
def test_rigid_translation_makes_no_stress(interpolation, dim):
    sim = spinning_block(interpolation, dim, spin=0.0, cells=4)
    advance(sim, 60)
    np.testing.assert_allclose(sim.particles.stress, 0.0, atol=1e-6 * RUBBER.E * 1e-4)
    np.testing.assert_allclose(sim.particles.velocity[:, 0], 0.7, rtol=1e-11)
    expected = sim.particles.position0[:, 0] + 0.7 * sim.time
    np.testing.assert_allclose(sim.particles.position[:, 0], expected, rtol=0, atol=1e-11)


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("interpolation", [i for i in BOX if i != mp.CPGIMP()] + VERTEX, ids=_id)
def test_a_prescribed_rigid_spin_makes_no_stress_and_keeps_domains(interpolation, dim):
    """A turn by exact rotations, each an affine velocity field on the nodes: stress to round-off."""
    sim = spinning_block(interpolation, dim, spin=0.0, drift=0.0, cells=4)
    engine, steps, dt = sim.engine, 36, 1e-3
    angle = 2 * np.pi / steps
    turn = np.eye(3)
    turn[:2, :2] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
    engine.dt = dt
    for _ in range(steps):
        engine.locate()
        engine.clear()
        engine.mapping.nodes.records[:, :3] = engine.mapping.points() @ (turn - np.eye(3)).T / dt
        engine.flip = 0.0
        engine.scatter()
        engine.advance()
    np.testing.assert_allclose(sim.particles.stress, 0.0, atol=1e-9 * RUBBER.E)
    np.testing.assert_allclose(sim.particles.position, sim.particles.position0, atol=1e-12)
    if sim.vertices is not None:
        np.testing.assert_allclose(sim.vertices.position, sim.vertices.position0, atol=1e-12)


@pytest.mark.parametrize("interpolation", [mp.CPDI1(), mp.CPDI2()], ids=_id)
def test_the_stress_of_a_free_spin_falls_with_the_cell_size(interpolation):
    """Nodes at the surface see only particles inside: an error of the grid, gone as it is refined."""
    rms = []
    for cells in (8, 16):
        sim, worst = spinning_block(interpolation, spin=2.0, drift=0.0, cells=cells), 0.0
        for _ in range(40):
            advance(sim, 10)
            worst = max(worst, float(np.sqrt((sim.particles.stress**2).mean())))
        rms.append(worst)
    assert rms[0] < 0.005 * RUBBER.E
    assert rms[1] < 0.6 * rms[0]


@pytest.mark.parametrize("interpolation", [mp.BSpline(2), mp.UGIMP(), mp.CPGIMP("U"), *VERTEX], ids=_id)
def test_any_number_of_threads_gives_the_same_bits(interpolation, monkeypatch):
    monkeypatch.setattr("matpoint.threads._WORTH_IT", 1)  # else such small runs stay on one thread
    monkeypatch.setattr("matpoint.threads._SHORTEST", 64)

    def run(threads):
        grid = mp.Grid((0, 0), (2, 2), 0.05)
        bodies = [
            mp.Body(mp.Box((0.3, 0.3), (0.9, 1.7)), RUBBER, 3, velocity=(3.0, 1.0)),
            mp.Body(mp.Box((0.95, 0.3), (1.6, 1.7)), SOFT, 3, velocity=(-3.0, 0.5)),
        ]
        sim = mp.Simulation(
            grid,
            bodies,
            interpolation=interpolation,
            timestep=mp.FixedStep(1e-4),
            threads=threads,
            sort_every=7,
        )
        return advance(sim, 40)

    first = run(1)
    for threads in (2, 3):
        other = run(threads)
        for name in ("id", "position", "velocity", "stress", "deformation_gradient"):
            np.testing.assert_array_equal(getattr(first.particles, name), getattr(other.particles, name))


@pytest.mark.parametrize("interpolation", BOX + VERTEX, ids=_id)
def test_sorting_changes_nothing_but_the_order(interpolation):
    often, never = two_blocks(interpolation, sort_every=5), two_blocks(interpolation, sort_every=10**6)
    advance(often, 120), advance(never, 120)
    for name in ("position", "velocity", "stress", "position0", "body"):
        a, b = often.particles.ordered(name), never.particles.ordered(name)
        np.testing.assert_allclose(a, b, rtol=1e-7, atol=1e-7 * (np.abs(b).max() + 1e-30))


@pytest.mark.parametrize("scheme", [mp.USL(), mp.MUSL(mp.APIC())], ids=_id)
@pytest.mark.parametrize("interpolation", BOX + VERTEX, ids=_id)
def test_a_restart_gives_the_same_bits(interpolation, scheme):
    if isinstance(scheme.transfer, mp.APIC) and interpolation.uses_vertices:
        return
    straight = advance(two_blocks(interpolation, scheme=scheme, sort_every=13), 60)
    first = advance(two_blocks(interpolation, scheme=scheme, sort_every=13), 30)
    arrays = {name: a.copy() for name, a in first.state_arrays().items()}
    second = two_blocks(interpolation, scheme=scheme, sort_every=13)
    second.restore(arrays, first.state_scalars())
    assert second.fingerprint() == straight.fingerprint()
    advance(second, 30)
    for name in ("id", "position", "velocity", "stress", "deformation_gradient"):
        np.testing.assert_array_equal(getattr(straight.particles, name), getattr(second.particles, name))


def test_energy_is_kept_by_a_vibrating_bar():
    """A free bar's stretching mode: FLIP with USL keeps energy to a few per mille over periods."""
    grid = mp.Grid(-0.25, 1.25, 1 / 16)
    body = mp.Body(mp.Box((0.0,), (1.0,)), RUBBER, 2, velocity=lambda x: 0.5 * np.cos(np.pi * x) * [1, 0, 0])
    sim = mp.Simulation(grid, [body], interpolation=mp.CPDI2(), timestep=mp.FixedStep(1e-4))
    start = take_entry(sim.engine).total
    period = 2 * 1.0 / float(RUBBER.wave_speed(np.eye(3)[None])[0])
    kinetic = []
    for _ in range(round(2 * period / 1e-4)):
        sim.advance(1e-4)
        kinetic.append(take_entry(sim.engine).kinetic)
    assert sim.ledger.worst["energy"] < 0.02 * start
    # Kinetic energy vanishes twice a period: at T/4, 3T/4, ...
    turns = np.flatnonzero(np.diff(np.sign(np.diff(kinetic))) > 0) + 1
    assert turns[0] * 1e-4 == pytest.approx(period / 4, rel=0.03)

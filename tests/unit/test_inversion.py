"""Domains that turn over: refused, or given a parallelepiped of their own."""

from __future__ import annotations

import json

import numpy as np
import pytest

import matpoint as mp
from matpoint.output.summary import Summary
from runs import advance, two_blocks
from support import gather_field


def _dented(interpolation, dim):
    """A run in which one corner has been pushed through its domain."""
    sim = advance(two_blocks(interpolation, dim), 3)
    v = sim.vertices
    particle = int(np.argmin(sim.particles.position.sum(axis=1)))
    corner = v.connectivity[particle, 0]  # a corner that no other domain shares
    opposite = v.connectivity[particle, {1: 1, 2: 2, 3: 6}[dim]]
    v.position[corner] += 1.2 * (v.position[opposite] - v.position[corner])
    v.position_next[:] = v.position
    if len(sim.engine.mapping.position_next):
        sim.engine.mapping.position_next[:] = sim.particles.position
    return sim, particle


@pytest.mark.parametrize("dim", [1, 2, 3])
@pytest.mark.parametrize("method", [mp.CPDI2, mp.EnrichedCPDI2])
def test_stop_names_the_particle(method, dim):
    sim, particle = _dented(method(), dim)
    with pytest.raises(mp.RunError, match="turned over") as caught:
        sim.engine.advance()
    assert caught.value.particle == sim.particles.id[particle]
    assert caught.value.step == 3


@pytest.mark.parametrize("dim", [1, 2, 3])
@pytest.mark.parametrize("method", [mp.CPDI2, mp.EnrichedCPDI2])
def test_falling_back_goes_on_counted_and_conserving(tmp_path, method, dim):
    sim, particle = _dented(method(on_inversion="cpdi1"), dim)
    name = sim.particles.id[particle]
    vertices = len(sim.vertices)
    sim.engine.advance()
    assert sim.quantity("fallen_domains") == 1
    assert len(sim.vertices) == vertices + 2**dim
    before = sim.particles.mass @ sim.particles.velocity
    path = tmp_path / "r.vtkhdf"
    sim.run(sim.time + 40 * sim.dt, [mp.VTKHDF(path, mp.EverySteps(10))])
    np.testing.assert_allclose(sim.particles.mass @ sim.particles.velocity, before, atol=1e-9)
    assert sim.quantity("fallen_domains") == 1
    # The domain follows F: its corners are those of the parallelepiped.
    row = int(np.flatnonzero(sim.particles.id == name)[0])
    assert list(sim.engine.mapping.fallen) == [row]
    F = sim.vertices.deformation()[row]
    np.testing.assert_allclose(F, sim.particles.deformation_gradient[row], atol=1e-10)
    sim.sort()
    again = two_blocks(method(on_inversion="cpdi1"), dim)
    again.restore({k: a.copy() for k, a in sim.state_arrays().items()}, sim.state_scalars())
    advance(sim, 5), advance(again, 5)
    np.testing.assert_array_equal(sim.particles.position, again.particles.position)


def test_a_fallen_domain_is_reported(tmp_path):
    from test_output import _read_vtk

    sim, particle = _dented(mp.CPDI2(on_inversion="cpdi1"), 2)
    name = int(sim.particles.id[particle])
    assert len(sim.fallen) == 0
    assert not sim.notes
    sim.run(
        sim.time + 2 * sim.dt,
        [Summary(tmp_path / "summary.json"), mp.VTKHDF(tmp_path / "r.vtkhdf", mp.EverySteps(1))],
    )
    assert list(sim.fallen) == [name]
    (note,) = sim.notes
    assert "1 domain turned over" in note
    assert note.endswith(f"the first in step 4: particle {name}")
    summary = json.loads((tmp_path / "summary.json").read_text())
    assert summary["fallen_domains"] == 1
    assert summary["notes"] == [note]
    flags = _read_vtk(tmp_path / "r.vtkhdf")[-1][-1]["cell", "fallen"]
    assert list(np.flatnonzero(flags)) == [name]
    again = two_blocks(mp.CPDI2(on_inversion="cpdi1"), 2)
    again.restore({k: a.copy() for k, a in sim.state_arrays().items()}, sim.state_scalars())
    assert again.notes == [note.replace("in step 4", "in or before step 5")]


def test_identities_hold_with_a_fallen_domain():
    sim, _ = _dented(mp.CPDI2(on_inversion="cpdi1"), 2)
    sim.engine.advance()
    mapping = sim.engine.mapping
    mapping.before()

    class Setting:
        particles = sim.particles

    x_i = mapping.points()
    value, unit = gather_field(mapping, Setting, x_i)
    np.testing.assert_allclose(value, sim.particles.position, atol=1e-12)
    np.testing.assert_allclose(unit[:, :2, :2], np.broadcast_to(np.eye(2), (len(value), 2, 2)), atol=1e-11)


def test_vtk_file_follows_a_change_of_corners(tmp_path):
    from test_output import _read_vtk

    sim, _ = _dented(mp.CPDI2(on_inversion="cpdi1"), 2)
    path = tmp_path / "r.vtkhdf"
    writer = mp.VTKHDF(path, mp.EverySteps(1))
    writer.open(sim)
    writer.write(sim)
    sim.engine.advance()
    for _ in range(2):
        writer.write(sim)
    steps = _read_vtk(path)
    assert [len(s[1]) for s in steps] == [len(sim.vertices) - 4, len(sim.vertices), len(sim.vertices)]
    for _, points, cells, cell_type, data in steps[1:]:
        assert cell_type == 9
        assert cells.max() == len(points) - 1
        centres = points[cells.reshape(-1, 4)].mean(axis=1)
        np.testing.assert_allclose(centres, sim.particles.ordered("position"), atol=2e-3)
        assert len(data["cell", "id"]) == len(sim.particles)


def test_unknown_policy():
    with pytest.raises(mp.InputError, match="on_inversion"):
        mp.CPDI2(on_inversion="hope")
    with pytest.raises(mp.InputError, match="on_inversion"):
        mp.EnrichedCPDI2(on_inversion="hope")

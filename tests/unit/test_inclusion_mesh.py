"""Meshes of an inclusion in a plate: volumes, sets, shared vertices, shapes."""

from __future__ import annotations

import numpy as np
import pytest

import matpoint as mp
from matpoint.assembly import merge
from matpoint.problems.relaxation import Ramp

SIZE = 2.0
BOTH = pytest.mark.parametrize("dim", [2, 3])
RADII = pytest.mark.parametrize("radii", [(1.0,), (1.0, 1.25)])


def shell(dim, inner, outer):
    """The volume [m^d] of a quarter of a ring, or an octant of a shell."""
    return np.pi / 4 * (outer**2 - inner**2) if dim == 2 else np.pi / 6 * (outer**3 - inner**3)


@BOTH
@RADII
def test_volumes_converge(dim, radii):
    error = []
    for divisions in (4, 8):
        parts = mp.mesh_inclusion(dim, radii, SIZE, divisions)
        volumes = np.array([part.volumes().sum() for part in parts])
        assert volumes.sum() == pytest.approx(SIZE**dim, rel=1e-12)
        exact = [shell(dim, *pair) for pair in zip((0.0, *radii), radii, strict=False)]
        error.append(np.abs(volumes[:-1] - exact) / exact)
    assert error[0].max() < 0.03
    assert (error[1] < 0.3 * error[0]).all()  # order 2: chords of the circle


@BOTH
@RADII
@pytest.mark.parametrize("divisions", [1, 2, 4, 7])
def test_neighbours_meet_exactly_and_no_domain_is_crushed(dim, radii, divisions):
    parts = mp.mesh_inclusion(dim, radii, SIZE, divisions)
    assert [part.dim for part in parts] == [dim] * (len(radii) + 1)
    for k, radius in enumerate(radii):
        inner, outer = (set(map(tuple, part.vertices)) for part in parts[k : k + 2])
        shared = np.array(sorted(inner & outer))
        assert len(shared) == (2 * divisions + 1 if dim == 2 else 3 * divisions * (divisions + 1) + 1)
        np.testing.assert_allclose(np.linalg.norm(shared, axis=1), radius, rtol=1e-14)
    joined = merge(parts, [str(k) for k in range(len(parts))])
    total = len(np.unique(np.concatenate([part.vertices for part in parts]), axis=0))
    assert len(joined.vertices) == total
    shape = min((part.corner_jacobians().min(axis=1) / part.volumes()).min() for part in parts)
    assert shape > (0.4 if dim == 2 else 0.19) if divisions < 4 else 0.6


@BOTH
def test_boundary_sets(dim):
    parts = mp.mesh_inclusion(dim, (1.0, 1.25), SIZE, 3)
    planes = {"x-", "y-", "z-"} if dim == 3 else {"x-", "y-"}
    assert [set(part.sets) for part in parts] == [planes, planes, planes | {"outer"}]
    for part in parts:
        for k, name in enumerate(sorted(planes)):
            assert len(part.sets[name])
            assert (part.vertices[part.sets[name], k] == 0.0).all()
    outer = parts[-1].sets["outer"]
    assert len(outer) == (6 if dim == 2 else 27)
    assert (parts[-1].vertices[outer].max(axis=2) == SIZE).all()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((1, (1.0,), 2.0, 4), "dim = 1; 2 and 3 are allowed"),
        ((2, (), 2.0, 4), "radii are empty"),
        ((2, (1.0, 0.5), 2.0, 4), "must increase"),
        ((2, (1.0,), 1.0, 4), "below size = 1"),
        ((2, (-1.0,), 2.0, 4), "radii = -1.0 must be a positive number"),
        ((3, (1.0,), 2.0, 0), "divisions = 0 must be a whole number >= 1"),
    ],
)
def test_refused(arguments, message):
    with pytest.raises(mp.InputError, match=message):
        mp.mesh_inclusion(*arguments)


def test_a_ramp_ends_at_its_displacement():
    calls = []
    ramp = Ramp(lambda x: calls.append(1) or 2.0 * x, rise=0.5)
    x = np.array([[1.0, 3.0, 0.0]])
    first, second = ramp.velocities(2)
    times = (np.arange(1000) + 0.5) * 5e-4
    assert sum(second(x, t)[0] for t in times) * 5e-4 == pytest.approx(6.0)
    assert first(x, 0.25)[0] == pytest.approx(8.0)
    assert first(x, 0.0) == first(x, 0.5) == first(x, 0.7) == 0.0
    assert len(calls) == 1

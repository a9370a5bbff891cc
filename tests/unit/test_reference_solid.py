"""Finite-element solids and their static solutions: by hand, by differences, and for order."""

from __future__ import annotations

import numpy as np
import pytest
from solid_blocks import LAME, RHO, SHEAR, block, boundary, solid

from matpoint.errors import InputError, RunError
from matpoint.reference.elastica import Elastica
from matpoint.reference.prescribed import Prescribed
from matpoint.reference.solid import Solid
from matpoint.reference.static import solve_static

KINDS = pytest.mark.parametrize("kind", ["quad", "tri", "hex", "tet"])


def cauchy(F):
    """S 27 by hand, for one F (3, 3)."""
    J = np.linalg.det(F)
    s = (LAME * np.log(J) * np.eye(3) + SHEAR * (F @ F.T - np.eye(3))) / J
    return np.array([s[0, 0], s[1, 1], s[2, 2], s[0, 1], s[1, 2], s[0, 2]])


@KINDS
def test_patch(kind):
    """A linear motion of the boundary makes a linear motion inside, and one stress."""
    body = solid(kind, (3, 3, 3), shake=0.2)
    d = body.dim
    H = np.array([[0.2, 0.1, 0.05], [-0.15, -0.1, 0.1], [0.1, 0.05, 0.3]])[:d, :d]
    held = boundary(body.vertices)
    give = [Prescribed(held, i, lambda X, share, i=i: share * (X @ H[i])) for i in range(d)]
    result = solve_static(body, prescribed=give, increments=2)
    np.testing.assert_allclose(result.displacement, body.vertices @ H.T, atol=1e-12)
    F = np.eye(3)
    F[:d, :d] += H
    np.testing.assert_allclose(result.stress, np.tile(cauchy(F), (len(body.cells), 1)), atol=1e-10)
    np.testing.assert_allclose(result.reactions.sum(axis=0), 0.0, atol=1e-12)
    assert body.mass.sum() == pytest.approx(RHO)
    assert max(result.iterations) <= 8


@KINDS
def test_forces_and_tangent_are_derivatives(kind):
    body = solid(kind, (2, 1, 1), shake=0.0)
    rng, e = np.random.default_rng(3), 1e-6
    u = 0.1 * rng.standard_normal(body.vertices.shape[::-1])
    direction = rng.standard_normal(u.shape)
    ahead, behind = u + e * direction, u - e * direction
    slope = (body.strain_energy(ahead) - body.strain_energy(behind)) / (2 * e)
    assert slope == pytest.approx(float((body.forces(u)[0] * direction).sum()), rel=1e-7)
    change = (body.forces(ahead)[0] - body.forces(behind)[0]) / (2 * e)
    K = body.stiffness(u)
    np.testing.assert_allclose((K @ direction.T.ravel()), change.T.ravel(), atol=1e-7)
    assert abs(K - K.T).max() < 1e-13


@pytest.mark.parametrize("kind", ["quad", "tri"])
def test_static_error_is_of_order_two(kind):
    """A smooth finite motion, with the body force that it needs by differences of P."""

    def motion(X):
        x, y = np.moveaxis(X, -1, 0)
        return 0.1 * np.stack([np.sin(np.pi * x) * np.sin(np.pi * y), x * y * (1 - y)], axis=-1)

    def gradient(X):
        x, y = np.moveaxis(X, -1, 0)
        s, c = np.sin(np.pi * X), np.cos(np.pi * X)
        rows = [
            [np.pi * c[..., 0] * s[..., 1], np.pi * s[..., 0] * c[..., 1]],
            [y * (1 - y), x * (1 - 2 * y)],
        ]
        return np.eye(2) + 0.1 * np.moveaxis(np.array(rows), (0, 1), (-2, -1))

    def piola(X):
        F = gradient(X)
        J, inverse = np.linalg.det(F), np.linalg.inv(F)
        return (LAME * np.log(J))[..., None, None] * np.swapaxes(inverse, -1, -2) + SHEAR * (
            F - np.swapaxes(inverse, -1, -2)
        )

    def force(X, e=1e-5):
        steps = e * np.eye(2)
        return -sum((piola(X + steps[k]) - piola(X - steps[k]))[..., k] for k in range(2)) / (2 * e * RHO)

    errors = []
    for n in (4, 8, 16):
        body = solid(kind, (n, n))
        held = boundary(body.vertices)
        give = [Prescribed(held, i, lambda X, s, i=i: s * motion(X)[:, i]) for i in range(2)]
        u = solve_static(body, prescribed=give, body=force).displacement
        errors.append(np.abs(u - motion(body.vertices)).max())
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert (orders > 1.8).all(), (errors, orders)
    assert errors[-1] < 2e-3


def test_slender_cantilever_is_an_elastica():
    """P L^2/(E I) = 10: nu = 0, so that plane strain has the modulus of a bar."""
    thick = 0.04
    X, cells = block("quad", (120, 2), (1.0, thick))
    body = Solid(X, cells, "quad", 0.0, 0.5e6, 1.0)
    stiffness = 1e6 * thick**3 / 12
    w, u = Elastica(1.0, stiffness, 10 * stiffness).tip()
    end, held = np.flatnonzero(X[:, 0] == 1.0), np.flatnonzero(X[:, 0] == 0.0)
    pull = np.zeros_like(X)
    pull[end, 1] = 10 * stiffness * np.array([0.25, 0.5, 0.25])
    give = [Prescribed(held, 0), Prescribed(held, 1)]
    result = solve_static(body, prescribed=give, nodal=pull, increments=8)
    tip = result.displacement[end].mean(axis=0)
    np.testing.assert_allclose(tip, [-u, w], rtol=0.01)
    np.testing.assert_allclose(result.reactions.sum(axis=0), [0.0, -10 * stiffness], atol=1e-7)


@pytest.mark.parametrize(
    ("change", "word"),
    [
        ({"kind": "cube"}, "cube"),
        ({"cells": np.zeros((1, 3), int)}, "shape"),
        ({"cells": np.array([[0, 1, 2, 9]])}, "whole numbers"),
        ({"cells": np.array([[0, 3, 2, 1]])}, "inverted"),
        ({"vertices": np.full((4, 3), np.nan)}, "finite"),
        ({"vertices": np.array([[0, 0.0], [1, 0], [1, 1], [0, 1], [5, 5]])}, "dangling"),
        ({"shear": 0.0}, "positive"),
        ({"lame": np.ones(3)}, "lame"),
        ({"density": np.nan}, "density"),
    ],
)
def test_bad_solids_are_refused(change, word):
    good = {
        "vertices": np.array([[0, 0.0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]),
        "cells": np.array([[0, 1, 2, 3]]),
        "kind": "quad",
        "lame": 1.0,
        "shear": 1.0,
        "density": 1.0,
    }
    with pytest.raises(InputError, match=word):
        Solid(**{**good, **change})


def test_bad_static_problems_are_refused():
    body = solid("quad", (1, 1))
    with pytest.raises(InputError, match="holds"):
        solve_static(body, prescribed=[])
    with pytest.raises(InputError, match="increments"):
        solve_static(body, prescribed=[Prescribed(np.arange(2), 0)], increments=0)
    crush = [Prescribed(np.arange(4), 0, lambda X, s: -2 * s * X[:, 0]), Prescribed(np.arange(4), 1)]
    with pytest.raises(RunError, match="turns"):
        solve_static(body, prescribed=crush)

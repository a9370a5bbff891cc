"""What every material promises, over random deformations."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from material_cases import CASES, Case, stress, stress_and_state
from matpoint import tensor


def over(keep=lambda case: True):
    """Run a test over the materials that a rule keeps."""
    kept = {name: case for name, case in CASES.items() if keep(case)}
    return pytest.mark.parametrize("case", kept.values(), ids=kept.keys())


every = over()
elastic = over(lambda case: case.elastic)
indifferent = over(lambda case: case.indifferent)
solid = over(lambda case: hasattr(case.material, "lame"))
numbers = st.lists(st.floats(-0.25, 0.25), min_size=9, max_size=9)
quaternions = st.lists(st.floats(-1.0, 1.0), min_size=4, max_size=4).filter(lambda q: np.dot(q, q) > 0.01)


def deformation(values: list[float]) -> np.ndarray:
    """A deformation gradient with a positive determinant."""
    F = np.eye(3) + np.reshape(values, (3, 3))
    return F if np.linalg.det(F) > 0.2 else np.eye(3) + 0.2 * np.reshape(values, (3, 3))


def rotation(q: list[float]) -> np.ndarray:
    return Rotation.from_quat(q).as_matrix()


def scale_of(case: Case) -> float:
    """The stiffness at rest [Pa]: what stresses are compared with."""
    return float(case.material.density * case.material.wave_speed(np.eye(3)[None])[0] ** 2)


@every
@given(numbers)
def test_stress_is_symmetric_and_finite(case, values):
    sigma = stress(case.material, deformation(values))
    assert np.isfinite(sigma).all()
    np.testing.assert_allclose(sigma, sigma.T, rtol=0, atol=1e-12 * scale_of(case))


@elastic
@given(numbers)
def test_stress_is_the_derivative_of_the_energy(case, values):
    F, h = deformation(values), 1e-5
    shifted = np.array([F + sign * h * E for E in np.eye(9).reshape(9, 3, 3) for sign in (1.0, -1.0)])
    # The trial state of plasticity below yield is a function of F: take it from the law.
    states = np.array([stress_and_state(case.material, G)[1] for G in shifted])
    W = case.material.energy(shifted, states).reshape(9, 2)
    P = ((W[:, 0] - W[:, 1]) / (2.0 * h)).reshape(3, 3)
    expected = P @ F.T / np.linalg.det(F)
    np.testing.assert_allclose(stress(case.material, F), expected, rtol=0, atol=2e-8 * scale_of(case))


@indifferent
@given(numbers, quaternions)
def test_a_rotation_only_turns_the_stress(case, values, q):
    F, Q = deformation(values), rotation(q)
    rate = np.array([[0.3, -0.2, 0.5], [0.1, 0.4, 0.0], [0.7, 0.0, -0.1]])
    sigma, state = stress_and_state(case.material, F, L=rate)
    turned, turned_state = stress_and_state(case.material, Q @ F, L=Q @ rate @ Q.T)
    atol = 1e-11 * scale_of(case)
    np.testing.assert_allclose(turned, Q @ sigma @ Q.T, rtol=0, atol=atol)
    # ... and in a second step from the turned, perhaps yielded, state.
    G = F @ np.diag([1.1, 0.95, 1.02])
    again = stress_and_state(case.material, G, F, state)[0]
    turned_again = stress_and_state(case.material, Q @ G, Q @ F, turned_state)[0]
    np.testing.assert_allclose(turned_again, Q @ again @ Q.T, rtol=0, atol=atol)


@indifferent
@given(quaternions)
def test_a_rigid_rotation_gives_no_stress(case, q):
    np.testing.assert_allclose(stress(case.material, rotation(q)), 0.0, atol=1e-13 * scale_of(case))


@pytest.mark.parametrize("angle", [1e-3, 1e-2, 0.1])
def test_linear_elasticity_is_not_frame_indifferent_beyond_second_order(angle):
    material = CASES["linear-elastic"].material
    Q = Rotation.from_rotvec([0.0, 0.0, angle]).as_matrix()
    false_strain = np.cos(angle) - 1.0
    expected = 2.0 * false_strain * (material.lame + np.array([material.shear, material.shear, 0.0]))
    sigma = stress(material, Q)
    np.testing.assert_allclose(np.diag(sigma), expected, rtol=1e-9)
    assert abs(false_strain + angle**2 / 2.0) < angle**4 / 20.0


@solid
@given(numbers)
def test_small_strains_give_linear_elasticity(case, values):
    size = 1e-6
    H = size * np.reshape(values, (3, 3))
    strain = 0.5 * (H + H.T)
    linear = case.material.lame * np.trace(strain) * np.eye(3) + 2.0 * case.material.shear * strain
    sigma = stress(case.material, np.eye(3) + H)
    np.testing.assert_allclose(sigma, linear, rtol=0, atol=20.0 * size**2 * scale_of(case) + 1e-9)


def largest_acoustic(case: Case, F: np.ndarray, state: np.ndarray, n: np.ndarray) -> float:
    """ρ0 c² of waves along n: the largest eigenvalue of u → J dσ(u ⊗ n F) n, by differences."""
    J, h = np.linalg.det(F), 1e-6
    columns = []
    for u in np.eye(3):
        pair = [
            stress_and_state(case.material, F + sign * h * np.outer(u, n) @ F, F, state)[0] @ n
            for sign in (1.0, -1.0)
        ]
        columns.append((pair[0] - pair[1]) * J / (2.0 * h))
    return float(np.linalg.eigvals(np.array(columns).T).real.max())


@every
@given(numbers, st.integers(0, 2**31))
def test_wave_speed_bounds_the_acoustic_tensor(case, values, seed):
    F = deformation(values)
    _, state = stress_and_state(case.material, F)
    bound = case.material.density * case.material.wave_speed(F[None], state[None])[0] ** 2
    axes = np.linalg.svd(F)[0].T
    random = np.random.default_rng(seed).normal(size=(5, 3))
    directions = np.concatenate([axes, random / np.linalg.norm(random, axis=1, keepdims=True)])
    found = max(largest_acoustic(case, F, state, n) for n in directions)
    assert found <= bound * (1.0 + 1e-6) + 1e-6 * scale_of(case)
    if case.exact_speed:
        assert found >= bound * (1.0 - 1e-6) - 1e-6 * scale_of(case)
    else:
        assert found >= 0.3 * bound or not case.elastic


@elastic
def test_wave_speed_is_exact_at_rest(case):
    state = case.material.initial_state(1)
    found = largest_acoustic(case, np.eye(3), state[0], np.array([0.6, 0.0, 0.8]))
    np.testing.assert_allclose(found, scale_of(case), rtol=1e-5)


@given(st.lists(st.sampled_from([0.5, 1.0, 1.0 + 1e-9, 3.0, 1e-8]), min_size=3, max_size=3), quaternions)
def test_spectral_functions_with_repeated_eigenvalues(values, q):
    Q = rotation(q)
    S = Q @ np.diag(values) @ Q.T
    S = 0.5 * (S + S.T)
    found, vectors = tensor.eigen(tuple(map(tuple, S.tolist())))
    V = np.array(vectors)
    np.testing.assert_allclose(V @ V.T, np.eye(3), atol=4e-15)
    np.testing.assert_allclose(np.sort(found), np.linalg.eigvalsh(S), atol=4e-15 * max(values))
    np.testing.assert_allclose(np.array(tensor.spectral(found, vectors)), S, atol=4e-15 * max(values))

"""The stress kernel against NumPy, a user's law through the same door, and the cache."""

from __future__ import annotations

import os
import subprocess
import sys
from math import nan, sqrt

import numba
import numpy as np
import pytest

from material_cases import CASES, USER, stress_and_state
from matpoint.errors import InputError
from matpoint.kernels.stress import stress_kernel
from matpoint.materials import NeoHookean, UserMaterial
from matpoint.tensor import identity, scale


def arrays(material, n=40):
    """Everything the kernel takes for n random particles, as a dict in its order."""
    rng = np.random.default_rng(7)
    return {
        "F": np.eye(3) + 0.2 * rng.uniform(-1.0, 1.0, (n, 3, 3)),
        "L": rng.uniform(-1.0, 1.0, (n, 3, 3)),
        "volume0": rng.uniform(0.5, 2.0, n),
        "volume": np.zeros(n),
        "state": np.concatenate([material.initial_state(n), np.full((n, 2), 5.0)], axis=1),
        "stress": np.zeros((n, 6)),
    }


def passed(a):
    """The arrays as the kernel takes them: velocity gradients begin with particle 0."""
    F, *rest = a.values()
    return F, 0, *rest


@pytest.mark.parametrize("case", CASES.values(), ids=CASES.keys())
def test_kernel_equals_numpy(case):
    material, dt = case.material, 1e-3
    given, a = arrays(material), arrays(material)
    index = np.array([3, 17, 0, 39, 8, 21, 5], dtype=np.int32)
    assert stress_kernel(material)(index, 1, 6, *passed(a), dt) == -1
    used = len(material.state_variables)
    done = set(index[1:6])
    for p in range(40):
        if p not in done:
            assert all(np.array_equal(a[name][p], given[name][p]) for name in a)
            continue
        F = (np.eye(3) + dt * given["L"][p]) @ given["F"][p]
        sigma, state = stress_and_state(material, F, given["F"][p], given["state"][p, :used], given["L"][p])
        np.testing.assert_allclose(a["F"][p], F, rtol=1e-14, atol=1e-15)
        np.testing.assert_allclose(a["volume"][p], np.linalg.det(F) * given["volume0"][p], rtol=1e-13)
        expected = sigma[[0, 1, 2, 0, 1, 0], [0, 1, 2, 1, 2, 2]]
        np.testing.assert_allclose(a["stress"][p], expected, rtol=1e-11, atol=1e-6)
        np.testing.assert_allclose(a["state"][p, :used], state, rtol=1e-12, atol=1e-13)
        assert (a["state"][p, used:] == 5.0).all()


@pytest.mark.parametrize("bad", [-2000.0 * np.eye(3), np.full((3, 3), nan), np.full((3, 3), 1e200)])
def test_a_bad_particle_is_named_and_left_alone(bad):
    material = CASES["neo-hookean"].material
    given, a = arrays(material), arrays(material)
    a["L"][9] = bad
    index = np.array([4, 9, 2], dtype=np.int32)
    assert stress_kernel(material)(index, 0, 3, *passed(a), 1e-3) == 9
    assert np.array_equal(a["F"][9], given["F"][9])
    assert not a["stress"][[9, 2]].any()
    assert a["stress"][4].any()


def test_a_stress_that_is_not_finite_is_found():
    def fragile(F, F_new, L, dt, state, params):
        value = params.k if F_new[0][0] < 1.05 else params.k / 0.0
        return scale(value, identity())

    a = arrays(USER, 3)
    a["state"] = np.zeros((3, 0))
    a["F"][:] = np.eye(3)
    a["L"][:] = 0.0
    a["F"][2, 0, 0] = 1.1
    kernel = stress_kernel(UserMaterial(fragile, {"k": 1.0}, 1.0, modulus=1.0))
    assert kernel(np.arange(3, dtype=np.int32), 0, 3, *passed(a), 1e-3) == 2
    assert not a["stress"][2].any()


def test_a_users_law_equals_the_built_in_one():
    built_in, own = CASES["neo-hookean"].material, USER
    a, b = arrays(built_in), arrays(own)
    index = np.arange(40)
    assert stress_kernel(built_in)(index, 0, 40, *passed(a), 1e-3) == -1
    assert stress_kernel(own)(index, 0, 40, *passed(b), 1e-3) == -1
    for name in ("F", "volume", "stress"):
        np.testing.assert_allclose(a[name], b[name], rtol=1e-12, atol=1e-9)
    np.testing.assert_allclose(b["state"][:, 0], 1e-3)


def test_two_users_laws_with_like_parameters_stay_apart():
    def one(F, F_new, L, dt, state, params):
        return scale(params.k, identity())

    def ten(F, F_new, L, dt, state, params):
        return scale(10.0 * params.k, identity())

    for law, expected in ((one, 2.0), (ten, 20.0), (one, 2.0)):
        material = UserMaterial(law, {"k": 2.0}, 1.0, modulus=1.0)
        a = arrays(material, 1)
        assert stress_kernel(material)(np.arange(1, dtype=np.int32), 0, 1, *passed(a), 1e-3) == -1
        assert a["stress"][0, 0] == expected


@numba.njit
def _square(x):
    return x * x


def test_a_users_law_may_call_jitted_functions_and_be_one():
    @numba.njit
    def law(F, F_new, L, dt, state, params):
        return scale(_square(params.k) + sqrt(4.0), identity())

    material = UserMaterial(law, {"k": 3}, 1.0, modulus=1.0)
    a = arrays(material, 2)
    assert stress_kernel(material)(np.arange(2, dtype=np.int32), 0, 2, *passed(a), 1e-3) == -1
    np.testing.assert_allclose(a["stress"][:, :3], 11.0)


def _forgotten(x):
    return x


def test_a_law_that_numba_cannot_compile_is_refused_in_a_few_words():
    def law(F, F_new, L, dt, state, params):
        return scale(_forgotten(params.k), identity())

    material = UserMaterial(law, {"k": 3.0}, 1.0, modulus=1.0)
    with pytest.raises(
        InputError, match=r"stress law 'law' can't be compiled by Numba: .*_forgotten"
    ) as caught:
        stress_kernel(material)
    assert len(str(caught.value).splitlines()) <= 2
    assert len(str(caught.value)) < 500


_SCRIPT = """
from matpoint.kernels.stress import stress_kernel, update_stress
from matpoint.materials import MATERIALS, material_from
import inspect
values = dict(E=1.0, nu=0.3, density=1.0, yield_stress=1.0, viscosity=1.0, bulk_modulus=1.0)
for name, kind in MATERIALS.items():
    names = inspect.signature(kind).parameters
    stress_kernel(material_from(name, **{k: v for k, v in values.items() if k in names}))
print(len(MATERIALS), sum(update_stress.stats.cache_hits.values()))
"""


def test_a_second_process_compiles_nothing(tmp_path):
    environment = {k: v for k, v in os.environ.items() if k != "NUMBA_CACHE_DIR"} | {
        "MATPOINT_CACHE": str(tmp_path)
    }
    counts = []
    for _ in range(2):
        run = subprocess.run(
            [sys.executable, "-c", _SCRIPT], env=environment, capture_output=True, text=True, check=True
        )
        counts.append([int(word) for word in run.stdout.split()])
    laws = counts[0][0]
    assert counts == [[laws, 0], [laws, laws]]


def test_the_kernel_is_a_reusable_callable():
    material = NeoHookean(1e6, 0.3, 1000.0)
    a = arrays(material, 1)
    kernel = stress_kernel(material)
    assert [kernel(np.arange(1, dtype=np.int32), 0, 1, *passed(a), 0.0) for _ in range(2)] == [-1, -1]

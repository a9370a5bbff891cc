"""A material whose stress law is a user's own function."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cache
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np

from matpoint.errors import InputError
from matpoint.kernels.laws import StressLaw, stress_law
from matpoint.materials import checks
from matpoint.materials.contract import Array, Material, largest_squares
from matpoint.tensor import Tensor, add, identity, scale


@cache
def _parameter_class(function: StressLaw, names: tuple[str, ...]) -> Any:
    """Return the named tuple class of a user's law: one per function, so that it is compiled once."""
    # The functional form is the only one for names known at run time.
    parameters = NamedTuple("UserParameters", [(name, float) for name in names])  # pyright: ignore
    stress_law(parameters)(function)
    return parameters


@dataclass(frozen=True, eq=False)
class UserMaterial(Material):
    """A material by a plain Python function, compiled by Numba when a run begins.

    The function goes through the same door as the built-in laws::

        def law(F, F_new, L, dt, state, params):
            '''Return the Cauchy stress.'''
            J = tensor.det(F_new)
            return tensor.scale(params.bulk * (J - 1.0), tensor.identity())

        UserMaterial(law, parameters={"bulk": 1e6}, density=1000.0, modulus=1e6)

    All tensors are nested tuples, ((xx, xy, xz), (yx, yy, yz), (zx, zy, zz)), for which
    :mod:`matpoint.tensor` has the algebra. F and F_new are the deformation gradients before and
    after the step, L the velocity gradient [1/s] and dt the step [s]. ``state[k]`` is the k-th
    internal variable, to be updated in place; ``params.name`` a parameter. It must return the
    symmetric Cauchy stress [Pa].

    Parameters
    ----------
    function
        The stress law. It may call ``math`` and functions decorated with ``numba.njit``.
    parameters
        Name → number, seen by the function as ``params``.
    density
        Density in the reference configuration [kg/m³], > 0.
    state
        Internal variables, name → value at the start, in the order of ``state[k]``.
    modulus
        Stiffness for the time step [Pa]: the largest ∂P/∂F (λ + 2μ of an elastic solid). The wave
        speed is taken as s √(modulus/density), s the largest stretch.
    speed
        Instead of ``modulus``: a function of (F (n,3,3), state (n,S)) → wave speeds [m/s], (n,).
    stored_energy
        A function of (F, state) → energy per reference volume [J/m³], (n,); without it the
        energy balance of a run lacks this material's strain energy.

    Raises
    ------
    InputError
        A value is out of range, or the function fails, or gives no symmetric, finite 3×3 tensor, when
        it is tried once in plain Python at a small deformation.
    """

    function: StressLaw
    parameters: Mapping[str, float]
    density: float
    state: Mapping[str, float] = field(default_factory=dict)
    modulus: float | None = None
    speed: Callable[[Array, Array], Array] | None = None
    stored_energy: Callable[[Array, Array], Array] | None = None

    def __post_init__(self) -> None:
        if not callable(self.function):
            raise InputError(f"UserMaterial: function = {self.function!r} must be a Python function")
        checks.positive(self, "density", "kg/m³")
        for name in ("parameters", "state"):
            object.__setattr__(self, name, MappingProxyType(_numbers(name, getattr(self, name))))
        if (self.modulus is None) == (self.speed is None):
            raise InputError("UserMaterial: give either modulus [Pa] or speed, for the time step needs one")
        if self.modulus is not None:
            checks.positive(self, "modulus", "Pa")
        self._try_out()

    def _try_out(self) -> None:
        """Call the law once in plain Python and look at what it gives."""
        name = getattr(self.function, "__name__", "law")
        rate: Tensor = ((0.3, 0.1, 0.2), (-0.1, 0.2, 0.4), (0.0, 0.1, -0.3))
        moved = add(identity(), scale(1e-3, rate))
        law: Any = getattr(self.function, "py_func", self.function)
        try:
            given = law(identity(), moved, rate, 1e-3, self.initial_state(1)[0], self.params)
            sigma = np.array(given, dtype=float)
        except Exception as error:
            raise InputError(
                f"UserMaterial: the stress law {name!r} fails: {type(error).__name__}: {error}"
            ) from error
        if sigma.shape != (3, 3) or not np.isfinite(sigma).all():
            raise InputError(
                f"UserMaterial: the stress law {name!r} must return a finite 3x3 stress, not {sigma.tolist()}"
            )
        if np.abs(sigma - sigma.T).max() > 1e-9 * np.abs(sigma).max():
            raise InputError(
                f"UserMaterial: the stress law {name!r} must return a symmetric stress, not {sigma.tolist()}"
            )

    @property
    def params(self) -> Any:
        """The parameters as the named tuple that the function takes."""
        return _parameter_class(self.function, tuple(self.parameters))(*self.parameters.values())

    @property
    def state_variables(self) -> Mapping[str, float]:
        """The user's internal variables."""
        return self.state

    def wave_speed(self, F: Array, state: Array | None = None) -> Array:
        """Return the user's speed, or s √(modulus/density), s the largest stretch [m/s], (n,)."""
        if self.speed is not None:
            state = self.initial_state(len(F)) if state is None else state
            return np.asarray(self.speed(F, state), dtype=float)
        assert self.modulus is not None
        return np.sqrt(self.modulus / self.density * largest_squares(F))

    def energy(self, F: Array, state: Array | None = None) -> Array | None:
        """Return the user's stored energy [J/m³], (n,), or None without one."""
        if self.stored_energy is None:
            return None
        state = self.initial_state(len(F)) if state is None else state
        return np.asarray(self.stored_energy(F, state), dtype=float)


def _numbers(name: str, values: Any) -> dict[str, float]:
    """Return a mapping of names to finite floats, or refuse it."""
    allowed = "it must map names to finite numbers"
    try:
        numbers = {key: float(value) for key, value in dict(values).items()}
    except (TypeError, ValueError) as error:
        raise InputError(f"UserMaterial: {name} = {values!r} is not allowed: {allowed}") from error
    for key, value in numbers.items():
        named = isinstance(key, str) and key.isidentifier() and not key.startswith("_")
        if not (named and math.isfinite(value)):
            raise InputError(f"UserMaterial: {name}[{key!r}] = {value!r} is not allowed: {allowed}")
    return numbers

"""The door of stress laws: how a kernel finds the law of a material, built-in or a user's.

A law is a plain function of nested tuples and scalars::

    law(F, F_new, L, dt, state, params) -> sigma

with F and F_new the deformation gradient before and after the step, L the velocity gradient
[1/s], dt the step [s], ``state`` the particle's row of internal variables, to be updated in
place, and ``params`` a named tuple. It returns the symmetric Cauchy stress [Pa]. The *class* of
``params`` identifies the law, so that the choice is made when a kernel is compiled, and the
compiled kernel can be cached (a kernel that closes over a function cannot).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from numba import types
from numba.extending import overload

from matpoint.jit import FAST_MATH
from matpoint.tensor import Tensor

StressLaw = Callable[[Tensor, Tensor, Tensor, float, Any, Any], Tensor]
Law = TypeVar("Law", bound=StressLaw)

_LAWS: dict[type, StressLaw] = {}


def stress_law(parameters: type) -> Callable[[Law], Law]:
    """Return a decorator that makes a function the stress law of a named tuple class.

    Parameters
    ----------
    parameters
        The ``typing.NamedTuple`` class whose instances the function takes as ``params``.
    """

    def register(law: Law) -> Law:
        # Numba's dispatcher takes named tuple classes of one name and shape for one type, and would run
        # the law of the first for the second: no two may have the same name.
        if any(known.__name__ == parameters.__name__ for known in _LAWS if known is not parameters):
            parameters.__name__ = f"{parameters.__name__}_{len(_LAWS)}"
        _LAWS[parameters] = law
        return law

    return register


def law_of(params: Any) -> StressLaw:
    """Return the plain function of the law that these parameters belong to."""
    return _LAWS[type(params)]


def is_cacheable(params: Any) -> bool:
    """Return whether kernels for these parameters may be kept on disk.

    Only the package's own laws: the cache is keyed by the package's sources and would not
    notice an edit of anyone else's.
    """
    return law_of(params).__module__.split(".")[0] == __name__.split(".")[0]


def cauchy_stress(F: Tensor, F_new: Tensor, L: Tensor, dt: float, state: Any, params: Any) -> Tensor:
    """Return the Cauchy stress [Pa] by the law of ``params``, in kernels and in plain Python."""
    return law_of(params)(F, F_new, L, dt, state, params)


@overload(cauchy_stress, jit_options={"fastmath": FAST_MATH, "error_model": "numpy"}, strict=False)
def _cauchy_stress(F: Any, F_new: Any, L: Any, dt: Any, state: Any, params: Any) -> Any:
    if isinstance(params, types.NamedTuple | types.NamedUniTuple):
        law: Any = _LAWS.get(params.instance_class)
        # A function that is compiled already would be opaque to the inliner: take its source.
        return getattr(law, "py_func", law)
    return None

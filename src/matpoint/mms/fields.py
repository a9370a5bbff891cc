"""All fields of a manufactured solution, as compiled functions of reference position and time."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import sympy as sp

from matpoint.checks import function, instance, number
from matpoint.deformed import Start
from matpoint.errors import InputError
from matpoint.loads import BodyForce
from matpoint.materials import Material
from matpoint.mms.compiled import compiled
from matpoint.mms.components import refuse_components, refuse_kinks, refuse_unreal, told
from matpoint.mms.coordinates import COORDINATES, TIME
from matpoint.mms.folds import refuse_folds
from matpoint.mms.laws import OwnLaw
from matpoint.mms.soundness import Field, instants, places, refuse_infinite, some_places

_VOIGT = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))
_F = sp.Matrix(3, 3, sp.symbols("F:3:3", real=True))


@dataclass(frozen=True, eq=False)
class Manufactured:
    """The motion x = X + u(X, t) of a material, and the body force that makes it an exact solution.

    Derivatives are symbolic. The force is b = (ρ0 u_tt - Div P)/ρ0 with Div P = (∂P/∂F) : ∂²u/∂X², where
    ∂P/∂F is differentiated with respect to F itself, so that long displacements stay manageable.
    Every function takes reference positions X (n, 3) [m] and a time [s].

    Parameters
    ----------
    law
        u(X, t) [m]: one, two or three sympy expressions of ``matpoint.mms.X, Y, Z, t``, or numbers; axes
        that are not given do not move.
    material
        It gives density and stress.
    first_piola
        P(F) [Pa], a function of a 3 x 3 sympy matrix that gives another; left out, it is the material's own
        from ``LAWS``, and the attribute is that function. ``NeoHookean`` and ``SaintVenantKirchhoff`` take
        any displacement, ``Hencky`` only one along the axes, u_k(X_k, t), where F is diagonal. For other
        materials whose stress is a function of F alone, such as ``LinearElastic``, give P = det(F) σ F⁻ᵀ
        yourself. Stresses of ``VonMises``, which yields, and ``NewtonianFluid``, which depends on the
        rate, are no functions of F.

    Raises
    ------
    InputError
        If a component is no real expression of the coordinates and time that can be differentiated twice and
        that NumPy can compute, the material's P(F) is not known or can't
        take such an F, or ``first_piola`` does not give a 3 x 3 matrix of F.

    Notes
    -----
    What the expressions do between is not looked at here: where a body lies and how long a run lasts is not
    known. :meth:`refuse_folds` and :meth:`refuse_infinite` do so for given places and times.
    """

    law: Sequence[Any]
    material: Material
    first_piola: Callable[[sp.Matrix], sp.Matrix] = None  # type: ignore[assignment]

    def __post_init__(self) -> None:
        if self.first_piola is None or isinstance(self.first_piola, OwnLaw):  # of this material, if replaced
            object.__setattr__(self, "first_piola", OwnLaw(self.material))
        refuse_components(self.law)
        instance("manufactured solution: material", self.material, Material, "a material")
        function("manufactured solution: first_piola", self.first_piola)
        for k, u in enumerate(self._u[: self.dim]):
            refuse_kinks(f"manufactured solution: component {k}", u, self._second_derivatives(k))
        _ = self._stress  # refuses what has no P(F)
        self._try_out()

    @property
    def dim(self) -> int:
        """The dimension."""
        return len(self.law)

    # -- the symbolic part -------------------------------------------------------------------

    @cached_property
    def _u(self) -> list[sp.Expr]:
        given = [u if isinstance(u, sp.Expr) else sp.Float(float(u)) for u in self.law]
        return given + [sp.Integer(0)] * (3 - self.dim)

    @cached_property
    def _gradient(self) -> sp.Matrix:
        """F = I + ∂u/∂X."""
        return sp.Matrix(3, 3, lambda i, j: sp.diff(self._u[i], COORDINATES[j]) + int(i == j))

    @cached_property
    def _known(self) -> dict[sp.Symbol, sp.Expr]:
        """The components of F that are the same everywhere: mostly zeros and ones."""
        pairs = zip(_F, self._gradient, strict=True)
        return {symbol: value for symbol, value in pairs if value.is_number}

    @cached_property
    def _stress(self) -> sp.Matrix:
        """P as a function of the symbols of F."""
        F = _F.subs({s: v for s, v in self._known.items() if v == 0})
        try:
            P = self.first_piola(F)
        except InputError:
            raise
        except Exception as error:
            raise InputError(
                "manufactured solution: first_piola fails on the matrix F with"
                f" {type(error).__name__}: {error}"
            ) from None
        if not isinstance(P, sp.MatrixBase) or P.shape != (3, 3) or P.free_symbols - F.free_symbols:
            raise InputError(
                f"manufactured solution: first_piola gives {told(P)}; it must be a 3 x 3 sympy matrix of the"
                " components of F alone"
            )
        refuse_unreal("manufactured solution: first_piola", P)
        return P

    def _second_derivatives(self, k: int) -> list[sp.Expr]:
        """∂²u_k/∂X² and ∂²u_k/∂t²."""
        return [*(v for (i, *_), v in self._hessian.items() if i == k), sp.diff(self._u[k], TIME, 2)]

    def _try_out(self) -> None:
        """Refuse what NumPy can't compute; numbers at this place mean nothing, there may be no body."""
        X = np.array([[0.371, 0.243, 0.517]])
        with np.errstate(all="ignore"):
            for name, field in self._fields.items():
                try:
                    field(X, 0.137)
                except Exception as error:
                    raise InputError(
                        f"manufactured solution: {name} can't be computed ({type(error).__name__}:"
                        f" {str(error).splitlines()[0]}); only functions that NumPy or SciPy know are allowed"
                    ) from None

    @property
    def _fields(self) -> dict[str, Field]:
        return {
            "the displacement": self.displacement, "the velocity": self.velocity, "F": self.deformation,
            "the stress": self.stress, "the body force": self.body_force,
        }  # fmt: skip

    @cached_property
    def _hessian(self) -> dict[tuple[int, int, int], sp.Expr]:
        """∂²u_i/∂X_J∂X_K with J <= K, those that are not zero."""
        found = {}
        for i in range(3):
            for j in range(3):
                for k in range(j, 3):
                    value = sp.diff(self._gradient[i, j], COORDINATES[k])
                    if value != 0:
                        found[i, j, k] = value
        return found

    @cached_property
    def _divergence(self) -> tuple[list[sp.Symbol], list[sp.Expr]]:
        """Symbols of ∂²u/∂X², and Div P in terms of them and of F."""
        symbols = {key: sp.Symbol("H{}{}{}".format(*key), real=True) for key in self._hessian}
        rows = []
        for i in range(3):
            total: sp.Expr = sp.Integer(0)
            for k, left, j in ((k, a, b) for k in range(3) for a in range(3) for b in range(3)):
                second = symbols.get((k, min(left, j), max(left, j)))
                if second is not None:
                    total += sp.diff(self._stress[i, j], _F[k, left]) * second
            rows.append(total.subs(self._known))
        return list(symbols.values()), rows

    # -- compiled functions ------------------------------------------------------------------

    def _rows(self, name: str) -> list[sp.Expr]:
        rate = [sp.diff(u, TIME) for u in self._u]
        if name == "second":
            return [*self._gradient, *self._hessian.values(), *(sp.diff(v, TIME) for v in rate)]
        return {"u": self._u, "v": rate, "F": list(self._gradient)}[name]

    @cached_property
    def _functions(self) -> dict[str, Callable[[Any, int], np.ndarray]]:
        """Fields as functions of X, Y, Z, t, each made when it is first wanted."""
        return {}

    @cached_property
    def _cauchy(self) -> Callable[[Any, int], np.ndarray]:
        """σ = P Fᵀ/J as a function of F."""
        sigma = self._stress * _F.T / _F.det()
        return compiled(list(_F), [sigma[pair].subs(self._known) for pair in _VOIGT])

    @cached_property
    def _internal(self) -> Callable[[Any, int], np.ndarray]:
        """Div P as a function of F and ∂²u/∂X²."""
        symbols, rows = self._divergence
        return compiled([*_F, *symbols], rows)

    def _evaluate(self, name: str, given: np.ndarray, time: float) -> np.ndarray:
        X, now = places(given), np.float64(number("manufactured solution: time", time))
        if name not in self._functions:
            self._functions[name] = compiled((*COORDINATES, TIME), self._rows(name))
        return self._functions[name]((X[:, 0], X[:, 1], X[:, 2], now), len(X))

    def displacement(self, X: np.ndarray, time: float) -> np.ndarray:
        """Return u [m], (n, 3)."""
        return self._evaluate("u", X, time).T

    def position(self, X: np.ndarray, time: float) -> np.ndarray:
        """Return x = X + u [m], (n, 3)."""
        return places(X) + self.displacement(X, time)

    def velocity(self, X: np.ndarray, time: float) -> np.ndarray:
        """Return ∂u/∂t [m/s], (n, 3)."""
        return self._evaluate("v", X, time).T

    def deformation(self, X: np.ndarray, time: float) -> np.ndarray:
        """Return F [-], (n, 3, 3)."""
        return self._evaluate("F", X, time).T.reshape(-1, 3, 3)

    def stress(self, X: np.ndarray, time: float) -> np.ndarray:
        """Return the Cauchy stress [Pa], (n, 6): xx, yy, zz, xy, yz, xz."""
        return self._cauchy(self._evaluate("F", X, time), len(X)).T

    def body_force(self, X: np.ndarray, time: float) -> np.ndarray:
        """Return b = (ρ0 u_tt - Div P)/ρ0 [m/s²], (n, 3)."""
        found = self._evaluate("second", X, time)
        return (found[-3:] - self._internal(found[:-3], len(X)) / self.material.density).T

    def refuse_folds(self, X: np.ndarray, times: Sequence[float] | np.ndarray) -> None:
        """Refuse a motion that folds: one with det F <= 0, or no number, at one of some places and times.

        Parameters
        ----------
        X
            Reference positions [m], (n, 3), for instance a lattice over the body.
        times
            [s].

        Raises
        ------
        InputError
            With the place and the time where det F is least, and what would help.
        """
        refuse_folds(self.deformation, some_places(X), instants(times))

    def refuse_infinite(self, X: np.ndarray, times: Sequence[float] | np.ndarray) -> None:
        """Refuse a solution with a field that is no finite number at one of some places and times.

        Parameters
        ----------
        X
            Reference positions [m], (n, 3), for instance a lattice over the body.
        times
            [s].

        Raises
        ------
        InputError
            With the field, and the first place and time.
        """
        refuse_infinite(self._fields, some_places(X), instants(times))

    # -- for runs ----------------------------------------------------------------------------

    def load(self) -> BodyForce:
        """Return the body force as a load."""
        return BodyForce(lambda X, x, time: self.body_force(X, time))

    def start(self, time: float = 0.0) -> Start:
        """Return the exact start at a time [s], for a body."""
        return Start(lambda X: self.position(X, time), lambda X: self.deformation(X, time))

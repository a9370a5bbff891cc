"""MLS and IMLS reconstruction around a grid basis (T; methods, section 5)."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations_with_replacement
from types import MappingProxyType
from typing import ClassVar

import numpy as np

from matpoint.checks import instance, number, positive, whole
from matpoint.errors import InputError
from matpoint.interpolation.box import BoxInterpolation
from matpoint.interpolation.bspline import BSpline
from matpoint.interpolation.consistent import ConsistentMapping
from matpoint.interpolation.contract import Interpolation, Mapping, Setting
from matpoint.interpolation.linear import Linear
from matpoint.interpolation.quadrature import Solver
from matpoint.interpolation.reconstructed import ReconstructedMapping
from matpoint.kernels.reconstruct import MODES

_HIGHEST = 3
_GAUSS = (
    "rho, sigma, rho b at Gauss points g by least squares; m_i = sum_g N_i rho w, f_i = sum_g N_i rho b w"
    " - grad N_i . sigma w;"
)
_AT_NODES = " p_i = m_i sum_p phi_i(x_p) v_p"
_EQUATIONS = MappingProxyType(
    {
        "particles to nodes": f"{_GAUSS}{_AT_NODES}  (T 24-31)",
        "momentum to nodes": f"m_i = sum_g N_i rho w;{_AT_NODES}  (T 28, 31)",
    }
)
_CONSISTENT = MappingProxyType(
    {
        "particles to nodes": f"{_GAUSS} p_i = sum_g N_i rho v w  (T 24-30)",
        "momentum to nodes": "p_i = sum_g N_i rho v w",
        "solve": "M v = p, M v+ = p + f dt, M_ij = sum_g N_i N_j rho w, conditions inside",
        "velocity": "M v = p, M_ij = sum_g N_i N_j rho w, conditions inside",
    }
)
_HATS = Linear()


def monomials(dim: int, degree: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return how the monomials of ``dim`` coordinates up to a degree follow from each other.

    Returns
    -------
    counts : ndarray, shape (degree + 1,)
        How many there are of degree d or less.
    parent, axis : ndarray, shape (columns,)
        Column k > 0 is column ``parent[k]`` times coordinate ``axis[k]``.
    """
    terms = [()] + [t for d in range(1, degree + 1) for t in combinations_with_replacement(range(dim), d)]
    parent = [terms.index(t[:-1]) if t else 0 for t in terms]
    axis = [t[-1] if t else 0 for t in terms]
    counts = [sum(len(t) <= d for t in terms) for d in range(degree + 1)]
    return np.array(counts), np.array(parent), np.array(axis)


@dataclass(frozen=True)
class _Reconstruction(Interpolation):
    """What MLS and IMLS share."""

    basis: BoxInterpolation = _HATS
    degree: int = 2
    velocity_degree: int = 1
    points: int = 2
    support: float = 1.5
    reproject: bool = False
    citation: ClassVar[tuple[str, ...]] = ("sulsky1994", "wallstedt2011", "tran2019")
    equations = _EQUATIONS

    def __post_init__(self) -> None:
        what = type(self).__name__
        instance(f"{what}: basis", self.basis, Linear | BSpline, "Linear() or BSpline(2 or 3)")
        for name in ("degree", "velocity_degree"):
            if whole(f"{what}: {name}", getattr(self, name), 0) > _HIGHEST:
                raise InputError(f"{what}: {name} = {getattr(self, name)!r} must be from 0 to {_HIGHEST}")
        if whole(f"{what}: points", self.points) > 4:
            raise InputError(f"{what}: points = {self.points!r} must be from 1 to 4")
        if not 0.5 < number(f"{what}: support", self.support) <= 4.0:
            raise InputError(f"{what}: support = {self.support!r} must be above 0.5 and at most 4 cells")
        if not isinstance(self.reproject, bool):
            raise InputError(f"{what}: reproject = {self.reproject!r} must be true or false")

    def _solver(self) -> Solver:
        raise TypeError("a subclass says how it solves")

    def bind(self, setting: Setting) -> Mapping:
        grid = setting.grid
        axes = [self.basis.axis(grid, k) for k in range(grid.dim)]
        fields, velocities = monomials(grid.dim, self.degree), monomials(grid.dim, self.velocity_degree)
        return ReconstructedMapping(
            setting, axes, self._solver(), fields, velocities, self.support, self.points
        )

    @property
    def affine(self) -> bool:
        return False

    @property
    def default_scheme(self) -> str:
        return "musl" if self.reproject else "usl"


@dataclass(frozen=True)
class IMLS(_Reconstruction):
    """Improved moving least squares: fields at Gauss points by orthogonal polynomials (T).

    Density, stress and body force are reconstructed at Gauss points and integrated as finite elements do;
    velocities are reconstructed at the nodes. No moment matrix is inverted, so few particles or particles on
    a line lower the degree by themselves. It conserves neither mass nor momentum exactly: the ledger and the
    quantity ``grid_mass_error`` show the drift.

    Parameters
    ----------
    basis
        The grid's functions: ``Linear()`` or ``BSpline(2)``, ``BSpline(3)``.
    degree, velocity_degree
        Of the polynomials for fields and for velocities, 0 to 3.
    points
        Gauss points per cell and axis.
    support
        Radius of the fields' weight, a quadratic spline, in cells (T 27 with the authors' code).
    reproject
        Map the updated velocities to the nodes once more before their gradient is taken (T 36): the MUSL
        order of stages. The printed method does, the authors' code does not; it costs the second order on
        fine grids.
    tolerance
        A column is dropped when its orthogonal part squared is below this share of itself. With one particle
        a cell, columns that hardly differ make the fit extrapolate: at 1e-8 such a run breaks, from 1e-4 to
        0.03 it lives; with more particles none is dropped and nothing changes.
    """

    tolerance: float = 1e-3

    def __post_init__(self) -> None:
        super().__post_init__()
        if not positive("IMLS: tolerance", self.tolerance) < 1:
            raise InputError(f"IMLS: tolerance = {self.tolerance!r} must be below 1")

    @property
    def name(self) -> str:
        return "imls"

    def _solver(self) -> Solver:
        return Solver(MODES["imls"], self.tolerance, np.inf)


@dataclass(frozen=True)
class SplineIMLS(Interpolation):
    """A scheme of third order in space while particles cross cells.

    Quadratic B-splines as test functions; density, stress, body force and velocity by IMLS of degree 3 at
    Gauss points; velocities projected in L2 with the consistent mass, which also gives the accelerations.
    With velocities staggered by half a step it is of second order in time.

    Parameters
    ----------
    degree
        Of the polynomials.
    points
        Gauss points per cell and axis.
    support
        Radius of the weight in cells.
    basis_degree
        Of the splines, 2 or 3.
    tolerance
        As for :class:`IMLS`. Where a ring meets a wall its particles stand on lines that are almost parallel
        to it: with 1e-8 to 3e-4 a cubic column between them stays, and such runs break. Displacements of
        waves between walls are the same to two digits from 1e-8 to 3e-3.
    """

    degree: int = 3
    points: int = 3
    support: float = 1.5
    basis_degree: int = 2
    tolerance: float = 1e-3
    walls_only: ClassVar[bool] = True
    consistent: ClassVar[bool] = True
    citation: ClassVar[tuple[str, ...]] = ("sulsky1994", "steffen2008", "tran2019")
    equations = _CONSISTENT

    def __post_init__(self) -> None:
        IMLS(BSpline(self.basis_degree), self.degree, self.degree, self.points, self.support)
        positive("SplineIMLS: tolerance", self.tolerance)

    @property
    def name(self) -> str:
        return "spline-imls"

    @property
    def affine(self) -> bool:
        return False

    def bind(self, setting: Setting) -> Mapping:
        grid, basis = setting.grid, BSpline(self.basis_degree)
        axes = [basis.axis(grid, k) for k in range(grid.dim)]
        fields = monomials(grid.dim, self.degree)
        solver = Solver(MODES["imls"], self.tolerance, np.inf)
        return ConsistentMapping(setting, axes, solver, fields, fields, self.support, self.points)


@dataclass(frozen=True)
class MLS(_Reconstruction):
    """Moving least squares by the inverse of the moment matrix (Wallstedt and Guilkey 2011).

    In exact arithmetic the same as :class:`IMLS` where every moment matrix is regular. Where the condition
    number passes ``limit`` the point counts as ill-conditioned (quantity ``bad_points``) and the degree is
    lowered there.

    Parameters
    ----------
    basis, degree, velocity_degree, points, support, reproject
        As for :class:`IMLS`.
    limit
        Largest condition number that is solved.
    raw
        Monomials of x/h as they stand in textbooks, instead of (x_p - x)/h: their matrices are
        ill-conditioned far from the origin.
    """

    limit: float = 1e12
    raw: bool = False

    def __post_init__(self) -> None:
        super().__post_init__()
        positive("MLS: limit", self.limit)
        if not isinstance(self.raw, bool):
            raise InputError(f"MLS: raw = {self.raw!r} must be true or false")

    @property
    def name(self) -> str:
        return "mls"

    def _solver(self) -> Solver:
        return Solver(MODES["raw-mls" if self.raw else "mls"], 0.0, self.limit)

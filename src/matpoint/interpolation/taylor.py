"""Conservative Taylor least squares: fields by cell, with mass and momentum kept (Wobbes et al. 2019)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from matpoint.checks import instance, positive, whole
from matpoint.errors import InputError
from matpoint.interpolation.box import BoxInterpolation
from matpoint.interpolation.bspline import BSpline
from matpoint.interpolation.cells import room
from matpoint.interpolation.contract import Interpolation, Mapping, Setting
from matpoint.interpolation.linear import Linear
from matpoint.interpolation.quadrature import Quadrature, Solver, refuse_crowds, workspace
from matpoint.interpolation.reconstructed import ReconstructedMapping
from matpoint.interpolation.reconstruction import monomials
from matpoint.kernels import taylor as kernels
from matpoint.kernels.reconstruct import HEAVY, MODES
from matpoint.particles import Particles

_HATS = Linear()
_HIGHEST = 3
_SLIVER = 1e-14  # share of a particle that rounding may leave over


class TaylorQuadrature(Quadrature):
    """Gauss points with a polynomial for each cell; whole cells without particles are empty.

    Attributes
    ----------
    keep_stress : bool
        As for :class:`TLS`.
    half : ndarray, shape (n, 3) or (1, 3)
        Half-lengths [m] of the particles' boxes, zeros for particles as points.
    """

    surrounded = False  # a fit takes the cell's own particles
    keep_stress = True
    half = np.zeros((1, 3))
    # Grown as needed, each quadrature's own from then on.
    _fields, _totals, _fitted = np.zeros((0, 13)), np.zeros((0, 14)), np.zeros((0, 13))
    _covered, _slot, _numbers, _rest = np.zeros(0), *np.zeros((3, 0), dtype=np.int64)

    def evaluate(self, particles: Particles, body: np.ndarray) -> None:
        p, c, team = particles, self._list, self._team
        chosen, (counts, parent, axis) = self._whole, self._monomials
        self._make_room(len(p), len(chosen))
        fields, slot, totals = self._fields, self._slot[: len(c.filled)], self._totals[: len(chosen)]
        team.split(
            len(p),
            lambda a, b: kernels.gather_fields(a, b, p.mass, p.volume, p.stress, body, p.velocity, fields),
        )
        slot.fill(-1)
        slot[chosen] = self._numbers[: len(chosen)]
        totals.fill(0.0)
        kernels.sum_in_cells(
            p.position, self.half, p.mass, p.volume, fields, slot, *c.arguments, totals, self._covered
        )
        found = team.split(
            len(chosen),
            lambda a, b: kernels.fields_in_cells(
                a, b, chosen, self._unit, self._shares, counts[-1], parent, axis, self._solver.tolerance,
                self.keep_stress, *c.arguments, c.size, p.position, c.order, c.pointer,
                fields, totals, self._fitted, self.ranks, *workspace(team, self._monomials),
            ),
            HEAVY,
        )  # fmt: skip
        refuse_crowds(found, c)
        self._add_points(particles)

    def _make_room(self, particles: int, cells: int) -> None:
        """Let the arrays serve so many particles and whole cells."""
        self._fields, self._covered = room(self._fields, particles), room(self._covered, particles)
        self._slot, self._totals = room(self._slot, len(self._list.filled)), room(self._totals, cells)
        self._fitted = room(self._fitted, cells * len(self._unit))
        if len(self._numbers) < cells:
            self._numbers = np.arange(len(self._totals))

    def _add_points(self, p: Particles) -> None:
        """Put Gauss points and particles together; these carry what went to no cell."""
        covered, gauss = self._covered[: len(p)], len(self._whole) * len(self._unit)
        count = kernels.list_rest(covered, _SLIVER, self._rest[:0])
        self._rest = room(self._rest, count)
        kernels.list_rest(covered, _SLIVER, self._rest)
        self._resize(gauss, gauss + count)
        carried = (self.mass, self.volume, self.stress, self.body, self.velocity)
        self._team.split(gauss, lambda a, b: kernels.carry_cells(a, b, self._fitted, self._shares, *carried))
        self._team.split(
            count,
            lambda a, b: kernels.carry_rest(
                a, b, self._rest, gauss, covered, p.position, p.mass, p.volume, self._fields, self.position,
                *carried,
            ),
        )  # fmt: skip
        self._sort_points()


class TaylorMapping(ReconstructedMapping):
    """Mass, momentum and forces of the cells' polynomials to the nodes, by the basis alone."""

    quadrature_kind = TaylorQuadrature
    quadrature: TaylorQuadrature
    boxes: np.ndarray | None = None  # half-lengths [m] of the initial domains, if they count

    @property
    def ranks(self) -> np.ndarray:
        """Columns kept at the Gauss points of cells with a particle's centre; others have no fit."""
        found = self.quadrature.ranks
        return found[found > 0]

    @property
    def conditions(self) -> np.ndarray:
        return self.quadrature.conditions

    def before(self) -> None:
        if self.boxes is not None:
            F, q, boxes = self.particles.deformation_gradient, self.quadrature, self.boxes
            q.half = room(q.half, len(F))
            self.team.split(len(F), lambda a, b: kernels.boxes_along(a, b, boxes, F, q.half))
        super().before()

    def permute(self, order: np.ndarray) -> None:
        super().permute(order)
        if self.boxes is not None:
            self.boxes = np.ascontiguousarray(self.boxes[order])

    def state(self) -> dict[str, np.ndarray]:
        return super().state() | ({} if self.boxes is None else {"boxes": self.boxes})

    def restore(self, arrays: dict[str, np.ndarray]) -> None:
        super().restore(arrays)
        if self.boxes is not None:
            self.boxes = np.array(arrays["boxes"])

    def to_nodes(self, body: np.ndarray, *, kinematic: bool, dynamic: bool) -> None:
        self.quadrature.evaluate(self.particles, body)
        self._scatter(kinematic, dynamic)
        if kinematic:
            self._compare()

    def velocities_to_nodes(self) -> None:
        Mapping.velocities_to_nodes(self)


@dataclass(frozen=True)
class TLS(Interpolation):
    """Conservative Taylor least squares: a polynomial for each cell from its own particles (Wobbes et al.).

    The fit's mean over the cell is replaced by the particles': the density integrates to their mass, density
    times velocity to their momentum, density times body force to their force, so that all three are exact
    on the grid. What goes to no whole cell is integrated at its particle, as MPM does. What FLIP hands to
    the particles is weighed by their own masses at the nodes, so that their momentum is kept only as far as
    those agree. Velocity errors of the manufactured bar on 64 and 128 cells: 0.14 and 0.069; with
    ``boxes = False`` 0.41 and 0.21, by IMLS, which conserves nothing, 0.11 and 0.026.

    Parameters
    ----------
    basis
        The grid's functions: ``Linear()`` or ``BSpline(2)``, ``BSpline(3)``.
    degree
        Of the polynomials, 0 to 3; few particles, or particles on a line, lower it by themselves. The
        manufactured bar gains nothing from 2.
    points
        Gauss points per cell and axis.
    keep_stress
        Keep the particles' mean stress, by volume, as well. Necessary with ``boxes = False``, where its error
        as particles cross goes along with that of the mass; with boxes fine grids gain without it.
    boxes
        Particles count for each cell with the share of their box that lies there, with half-lengths
        l_k0 |F_kk| as in cpGIMP. Without, as in the paper, they count for the cell of their centre, and its
        mass jumps when one crosses: the order is then one.
    tolerance
        A column is dropped when its orthogonal part squared is below this share of itself. Cells have few
        particles of their own, and no weights fade them out: hence more than for :class:`IMLS`. Particles
        placed at random break runs of the plane waves from 1e-4 to 1e-3 and lose the order up to 0.03; from
        0.07 on it is kept. Four equal particles in a row have a share of 0.079 in their cubic column.
    """

    basis: BoxInterpolation = _HATS
    degree: int = 1
    points: int = 2
    keep_stress: bool = True
    boxes: bool = True
    tolerance: float = 0.07
    citation: ClassVar[tuple[str, ...]] = ("sulsky1994", "wobbes2019")

    def __post_init__(self) -> None:
        instance("TLS: basis", self.basis, Linear | BSpline, "Linear() or BSpline(2 or 3)")
        if whole("TLS: degree", self.degree, 0) > _HIGHEST:
            raise InputError(f"TLS: degree = {self.degree!r} must be from 0 to {_HIGHEST}")
        if whole("TLS: points", self.points) > 4:
            raise InputError(f"TLS: points = {self.points!r} must be from 1 to 4")
        for name in ("keep_stress", "boxes"):
            if not isinstance(getattr(self, name), bool):
                raise InputError(f"TLS: {name} = {getattr(self, name)!r} must be true or false")
        if not positive("TLS: tolerance", self.tolerance) < 1:
            raise InputError(f"TLS: tolerance = {self.tolerance!r} must be below 1")

    @property
    def name(self) -> str:
        return "tls"

    @property
    def affine(self) -> bool:
        return False

    def bind(self, setting: Setting) -> Mapping:
        grid = setting.grid
        axes = [self.basis.axis(grid, k) for k in range(grid.dim)]
        fields = monomials(grid.dim, self.degree)
        solver = Solver(MODES["imls"], self.tolerance, np.inf)
        mapping = TaylorMapping(setting, axes, solver, fields, fields, 1.0, self.points)
        mapping.quadrature.keep_stress = self.keep_stress
        if self.boxes:
            mapping.boxes = setting.domains_half.copy()
        return mapping

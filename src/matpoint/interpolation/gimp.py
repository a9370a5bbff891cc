"""GIMP: hats averaged over a box around the particle (Bardenhagen and Kober 2004; S, section 2)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from matpoint.errors import InputError
from matpoint.grid import Grid
from matpoint.interpolation.box import BoxMapping
from matpoint.interpolation.contract import Book, Interpolation, Mapping, ParticleError, Setting, first_fault
from matpoint.kernels.locate import find_stretched
from matpoint.kernels.stretch import longest_box, stretch_boxes
from matpoint.nodes import Axis, gimp_axis
from matpoint.sorting import Slabs
from matpoint.threads import Team

_BELOW, _ABOVE = 3, 8  # nodes beyond the box, for domains of up to 6 cells
_SAME = 1e-12  # relative difference of lengths that only rounding makes
_REACHES = (3, 5, 8)  # rows are compiled for these lengths


def _reach(team: Team, half: np.ndarray, grid: Grid) -> int:
    """The shortest row that sees every domain: 2l <= h, 3h, 6h."""
    inverse = np.zeros(3)
    inverse[: grid.dim] = 1.0 / np.array(grid.cell)
    longest = max(team.split(len(half), lambda a, b: longest_box(half, a, b, inverse)))
    for reach in _REACHES:
        if longest <= reach - 2 + 1e-9:
            return reach
    raise ParticleError(
        int(np.argmax((half * inverse).max(axis=1))),
        f"its domain is {longest:.3g} cells long and {_REACHES[-1] - 2} is the most; use CPDI",
    )


def _axes(grid: Grid, reach: int) -> list[Axis]:
    return [gimp_axis(grid, k, _BELOW, _ABOVE, reach) for k in range(grid.dim)]


@dataclass(frozen=True)
class UGIMP(Interpolation):
    """Boxes that keep their initial size (uGIMP)."""

    citation: ClassVar[tuple[str, ...]] = ("sulsky1994", "bardenhagen2004")

    @property
    def name(self) -> str:
        return "ugimp"

    def bind(self, setting: Setting) -> Mapping:
        half, grid = setting.domains_half, setting.grid
        reach = _reach(setting.team, half, grid)
        if np.ptp(half, axis=0).max() > _SAME * half.max():
            return BoxMapping(setting, _axes(grid, reach), half.copy())
        axes = [gimp_axis(grid, k, _BELOW, _ABOVE, reach, float(half[0, k])) for k in range(grid.dim)]
        return BoxMapping(setting, axes, half[:1].copy())


class _StretchedMapping(BoxMapping):
    """Boxes that follow the deformation gradient."""

    def __init__(self, setting: Setting, use_stretch_tensor: bool) -> None:
        self._half0 = setting.domains_half
        self._use_stretch_tensor = use_stretch_tensor
        self._reach = _reach(setting.team, self._half0, setting.grid)
        super().__init__(setting, _axes(setting.grid, self._reach), self._half0.copy())
        grid = setting.grid
        reach = np.array(grid.cell) * _BELOW
        self._room = np.full(3, -np.inf), np.full(3, np.inf)
        self._room[0][: grid.dim] = np.array(grid.lower) - reach
        self._room[1][: grid.dim] = np.array(grid.upper) + reach

    def before(self) -> None:
        super().before()
        x = self.particles.position
        lost = first_fault(self.team, len(x), lambda a, b: find_stretched(x, self.half, a, b, *self._room))
        if lost >= 0:
            raise ParticleError(lost, f"its domain reaches more than {_BELOW} cells out of the grid")

    def advance(self, book: Book | None = None) -> None:
        super().advance(book)
        F = self.particles.deformation_gradient
        bad = first_fault(
            self.team,
            len(F),
            lambda a, b: stretch_boxes(a, b, F, self._half0, self.half, self._use_stretch_tensor),
        )
        if bad >= 0:
            raise ParticleError(
                bad, "a diagonal component of F is not positive; use CPGIMP(stretch='U') or CPDI"
            )
        self._set_reach(_reach(self.team, self.half, self.grid))

    def _set_reach(self, reach: int) -> None:
        if reach != self._reach:
            self._reach = reach
            self.nodes.set_axes(_axes(self.grid, reach))
            self._slabs = Slabs(self.nodes, self.team, len(self.particles))

    def permute(self, order: np.ndarray) -> None:
        super().permute(order)
        self._half0 = np.ascontiguousarray(self._half0[order])

    def state(self) -> dict[str, np.ndarray]:
        return super().state() | {"half0": self._half0}

    def restore(self, arrays: dict[str, np.ndarray]) -> None:
        super().restore(arrays)
        self._half0 = np.array(arrays["half0"])
        self._set_reach(_reach(self.team, self.half, self.grid))


@dataclass(frozen=True)
class CPGIMP(Interpolation):
    """Boxes whose lengths follow the deformation (cpGIMP).

    Parameters
    ----------
    stretch
        ``"F"``: l_k = l_k0 F_kk (S, section 2); ``"U"``: the diagonal of the right stretch tensor,
        which survives rotation.
    """

    stretch: str = "F"
    citation: ClassVar[tuple[str, ...]] = ("sulsky1994", "bardenhagen2004", "wallstedt2007")

    def __post_init__(self) -> None:
        if self.stretch not in ("F", "U"):
            raise InputError(f'CPGIMP: stretch = {self.stretch!r}; "F" and "U" are allowed')

    @property
    def name(self) -> str:
        return "cpgimp"

    def bind(self, setting: Setting) -> Mapping:
        return _StretchedMapping(setting, self.stretch == "U")

"""The box family's transfers: rows of 1-D weights, whatever the basis (methods, section 2)."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass

import numpy as np

from matpoint.grid import Grid
from matpoint.interpolation.contract import Interpolation, Mapping, ParticleError, Setting, first_fault
from matpoint.kernels import box as kernels
from matpoint.kernels.locate import find_outside, order_by_slab
from matpoint.nodes import Axis, Nodes

_LEFT = "it left the grid; make the grid's box larger, or look for an instability (dt, loads, units)"


class Slabs:
    """Points in order of slab, renewed each step."""

    def __init__(self, nodes: Nodes, points: np.ndarray) -> None:
        axis = nodes.slab_axis
        line = nodes.coordinates[axis]
        self.axis, self.origin = axis, float(line[0])
        span = float(line[-1] - line[0])
        cells = max(1, len(line) - 1)
        count = max(1, -(-cells // nodes.slab_cells))
        self.inverse = cells / (span * nodes.slab_cells) if span > 0 else 0.0
        self.points = points
        self.pointer = np.zeros(count + 1, dtype=np.int64)
        self.order = points.copy()
        self._scratch = np.zeros(len(points), dtype=np.int64)

    def renew(self, position: np.ndarray) -> None:
        """Sort the points again, where they are now."""
        order_by_slab(
            position,
            self.axis,
            self.origin,
            self.inverse,
            self.points,
            self._scratch,
            self.pointer,
            self.order,
        )


def wide_bounds(grid: Grid) -> tuple[np.ndarray, np.ndarray]:
    """Return the box's corners [m] with a hair of tolerance; missing axes are unbounded."""
    hair = 1e-9 * np.array(grid.cell)
    lower, upper = np.full(3, -np.inf), np.full(3, np.inf)
    lower[: grid.dim], upper[: grid.dim] = np.array(grid.lower) - hair, np.array(grid.upper) + hair
    return lower, upper


class BoxMapping(Mapping):
    """Transfers of the box family."""

    def __init__(self, setting: Setting, axes: list[Axis], half: np.ndarray | None = None) -> None:
        self.particles, self.team, self.grid = setting.particles, setting.team, setting.grid
        self.nodes = Nodes(axes)
        self.half = np.zeros((1, 3)) if half is None else half
        self.position_next = self.particles.position.copy()
        self.bounds = wide_bounds(setting.grid)
        self._slabs = Slabs(self.nodes, np.arange(len(self.particles)))

    def before(self) -> None:
        x = self.particles.position
        lost = first_fault(self.team, len(x), lambda a, b: find_outside(x, a, b, *self.bounds))
        if lost >= 0:
            raise ParticleError(lost, _LEFT)
        self._slabs.renew(x)

    def to_nodes(self, body: np.ndarray, *, kinematic: bool, dynamic: bool) -> None:
        p, n, s = self.particles, self.nodes, self._slabs
        self.team.coloured(
            s.pointer,
            lambda slabs, a, b: kernels.particles_to_nodes(
                *n.rows, n.shape[1], n.shape[2], n.flat, slabs, a, b, s.pointer, s.order,
                p.position, self.half, p.velocity, p.mass, p.volume, p.stress, body,
                float(kinematic), float(dynamic),
            ),
        )  # fmt: skip

    def to_particles(self, dt: float, flip: float, *, move: bool, differentiate: bool) -> None:
        p, n = self.particles, self.nodes
        self.team.split(
            len(p),
            lambda a, b: kernels.nodes_to_particles(
                *n.rows, n.shape[1], n.shape[2], n.flat, a, b, p.position, self.half, p.velocity,
                self.position_next, p.velocity_gradient, dt, flip, move, differentiate,
            ),
        )  # fmt: skip

    def affine_to_nodes(self) -> None:
        """Add APIC's affine momentum to the nodes."""
        p, n, s = self.particles, self.nodes, self._slabs
        self.team.coloured(
            s.pointer,
            lambda slabs, a, b: kernels.affine_to_nodes(
                *n.rows, n.shape[1], n.shape[2], n.flat, slabs, a, b, s.pointer, s.order,
                p.position, self.half, p.mass, p.affine_moment, *n.coordinates,
            ),
        )  # fmt: skip

    def nodes_to_affine(self) -> None:
        """Bring APIC's moment of velocity B [m^2/s] to the particles."""
        p, n = self.particles, self.nodes
        self.team.split(
            len(p),
            lambda a, b: kernels.nodes_to_affine(
                *n.rows, n.shape[1], n.shape[2], n.flat, a, b, p.position, self.half,
                p.affine_moment, *n.coordinates,
            ),
        )  # fmt: skip

    def advance(self) -> None:
        p = self.particles
        p.position, self.position_next = self.position_next, p.position

    def permute(self, order: np.ndarray) -> None:
        if len(self.half) > 1:
            self.half = np.ascontiguousarray(self.half[order])

    def state(self) -> dict[str, np.ndarray]:
        return {"half": self.half}

    def restore(self, arrays: dict[str, np.ndarray]) -> None:
        self.half = np.array(arrays["half"])


@dataclass(frozen=True)
class BoxInterpolation(Interpolation):
    """Base of the box family: a subclass gives one axis, and perhaps half-lengths."""

    @abstractmethod
    def axis(self, grid: Grid, k: int) -> Axis:
        """Return the rows of axis ``k``."""

    def bind(self, setting: Setting) -> Mapping:
        grid = setting.grid
        return BoxMapping(setting, [self.axis(grid, k) for k in range(grid.dim)])

"""The box family's transfers: rows of 1-D weights, whatever the basis (methods, section 2)."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from matpoint.grid import Grid
from matpoint.interpolation.contract import Book, Interpolation, Mapping, ParticleError, Setting, Take
from matpoint.kernels import box as kernels
from matpoint.nodes import Axis, Nodes
from matpoint.sorting import Slabs
from matpoint.threads import Team

LEFT = "it left the grid; make the grid's box larger, or look for an instability (dt, loads, units)"


def wide_bounds(grid: Grid) -> tuple[np.ndarray, np.ndarray]:
    """Return the box's corners [m] with a hair of tolerance; missing axes are unbounded."""
    hair = 1e-9 * np.array(grid.cell)
    lower, upper = np.full(3, -np.inf), np.full(3, np.inf)
    lower[: grid.dim], upper[: grid.dim] = np.array(grid.lower) - hair, np.array(grid.upper) + hair
    return lower, upper


class Carriers(Protocol):
    """What scatters: particles, or points that carry their fields in their stead."""

    position: np.ndarray
    velocity: np.ndarray
    mass: np.ndarray
    volume: np.ndarray
    stress: np.ndarray


def scatter(
    team: Team, nodes: Nodes, slabs: Slabs, points: Carriers, half: np.ndarray, body: np.ndarray,
    *, kinematic: bool, dynamic: bool,
) -> None:  # fmt: skip
    """Add mass and momentum (``kinematic``) and forces (``dynamic``) of points to the nodes.

    ``half`` are half-lengths [m] of their boxes, (n, 3) or (1, 3); ``body`` is the body force per mass.
    """
    n, s, p = nodes, slabs, points
    team.coloured(
        s.pointer,
        lambda chosen, a, b: kernels.particles_to_nodes(
            *n.rows, n.shape[1], n.shape[2], n.flat, chosen, a, b, s.pointer, s.order,
            p.position, half, p.velocity, p.mass, p.volume, p.stress, body,
            float(kinematic), float(dynamic),
        ),
    )  # fmt: skip


class BoxMapping(Mapping):
    """Transfers of the box family."""

    def __init__(self, setting: Setting, axes: list[Axis], half: np.ndarray | None = None) -> None:
        self.particles, self.team, self.grid = setting.particles, setting.team, setting.grid
        self.nodes = Nodes(axes)
        self.half = np.zeros((1, 3)) if half is None else half
        self.position_next = self.particles.position.copy()
        self.bounds = wide_bounds(setting.grid)
        self._slabs = Slabs(self.nodes, self.team, len(self.particles))

    def before(self) -> None:
        x = self.particles.position
        lost, low, high = self._slabs.survey(x, *self.bounds)
        if lost >= 0:
            raise ParticleError(lost, LEFT)
        self.activate(low, high)
        self._slabs.renew(x, low, high)

    def activate(self, low: np.ndarray, high: np.ndarray) -> None:
        """Choose the nodes to work on, for particles in a box [m]."""
        self.nodes.active_within(low, high)

    def to_nodes(self, body: np.ndarray, *, kinematic: bool, dynamic: bool) -> None:
        scatter(
            self.team, self.nodes, self._slabs, self.particles, self.half, body,
            kinematic=kinematic, dynamic=dynamic,
        )  # fmt: skip

    def bring(self, start: int, stop: int, gradient: np.ndarray, take: Take) -> None:
        p, n = self.particles, self.nodes
        kernels.nodes_to_particles(
            *n.rows, n.shape[1], n.shape[2], n.flat, start, stop, p.position, self.half, p.velocity,
            self.position_next, gradient, *take,
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

    def advance(self, book: Book | None = None) -> None:
        self.swap_positions()

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

"""What an interpolation declares, and what it becomes once bound to a grid and particles.

An :class:`Interpolation` is a choice: a small frozen dataclass. ``bind`` turns it into a
:class:`Mapping`, which owns the nodes and carries out the transfers of a step.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from collections.abc import Mapping as Mapping_
from dataclasses import dataclass, field
from functools import cached_property
from types import MappingProxyType
from typing import ClassVar, NamedTuple

import numpy as np

from matpoint.errors import InputError
from matpoint.faces import Facets
from matpoint.grid import Grid
from matpoint.interpolation.spare import Spare
from matpoint.kernels.neumann import set_out
from matpoint.kernels.nodes import solve
from matpoint.measures import edge_vectors, half_lengths, measured
from matpoint.nodes import Nodes
from matpoint.particles import Particles
from matpoint.places import Corners, Surface
from matpoint.threads import BLOCK, Team, lowest
from matpoint.vertices import Vertices

#: ``deform(start, stop, gradient)`` deforms particles start:stop; it returns the first that can't be, or -1.
Deform = Callable[[int, int, np.ndarray], int]
#: ``book(start, stop, before, after)`` is told where the step takes particles start:stop, (m, 3) [m] each, by
#: blocks that begin at multiples of ``BLOCK``, in any order and on any thread.
Book = Callable[[int, int, np.ndarray, np.ndarray], object]


class ParticleError(Exception):
    """A particle that can't go on; the simulation adds step, time, id and position."""

    def __init__(self, particle: int, cause: str) -> None:
        super().__init__(cause)
        self.particle, self.cause = particle, cause


@dataclass
class Setting:
    """All that an interpolation may need to bind.

    Attributes
    ----------
    vertices, connectivity, kind
        The shared corners of all domains: (nv, 3) [m], (n, K) padded with -1, (n,).
    facets
        Boundary sets of the bodies.
    held : ndarray of int64
        Vertices under conditions of their own: they are to be degrees of freedom.
    stiffness : ndarray, shape (n,)
        P-wave modulus rho c^2 [Pa] of each particle's material at rest.
    notes : list of str
        What the user should know of how an interpolation was bound.
    """

    grid: Grid
    particles: Particles
    team: Team
    vertices: np.ndarray
    connectivity: np.ndarray
    kind: np.ndarray
    facets: tuple[Facets, ...] = ()
    held: np.ndarray = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    stiffness: np.ndarray = field(default_factory=lambda: np.zeros(0))
    notes: list[str] = field(default_factory=list)

    @cached_property
    def domains_half(self) -> np.ndarray:
        """Half-lengths [m] of the box that stands for each particle's initial domain, shape (n, 3)."""
        return measured(half_lengths, self.vertices, self.connectivity, self.kind, (3,))

    @cached_property
    def domains_edges(self) -> np.ndarray:
        """Half edge vectors [m] of each particle's initial parallelepiped, as rows, shape (n, 3, 3)."""
        return measured(edge_vectors, self.vertices, self.connectivity, self.kind, (3, 3))

    def faces_of(self, surface: Surface) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return corners, sign and outer flag of the faces of a boundary set (see ``Facets``).

        Raises
        ------
        InputError
            If no body has a set of that name, or none of its faces is on the outside.
        """
        found = [f for f in self.facets if f.name == surface.name and surface.body in (None, f.body)]
        if not found:
            names = sorted({f"{f.name} ({f.body})" for f in self.facets})
            raise InputError(f"surface {surface} does not exist; there are {', '.join(names) or 'none'}")
        keep = [f.outer if surface.body is None else np.ones(len(f.outer), dtype=bool) for f in found]
        if not any(k.any() for k in keep):
            raise InputError(
                f"surface {surface}: all its faces lie between two bodies; name the body to take it"
                " all the same"
            )
        parts = [(f.corners[k], f.sign[k], f.outer[k]) for f, k in zip(found, keep, strict=True)]
        corners, sign, outer = (np.concatenate(p) for p in zip(*parts, strict=True))
        return corners, sign, outer

    def vertices_at(self, where: Surface | Corners) -> np.ndarray:
        """Return the vertices of a boundary set, or of a region, in ascending order.

        Raises
        ------
        InputError
            As :meth:`faces_of`, or if no vertex lies in the region.
        """
        if isinstance(where, Surface):
            return np.unique(self.faces_of(where)[0])
        found = np.flatnonzero(np.asarray(where.region.contains(self.vertices), dtype=bool))
        if len(found) == 0:
            raise InputError("corners: no corner of any particle domain lies in the region; enlarge it")
        return found


@dataclass(frozen=True, eq=False)
class Held:
    """Conditions as a solve takes them; directions of one node are orthonormal.

    Attributes
    ----------
    index : ndarray of int64, shape (c,)
        Node records.
    normal : ndarray, shape (c, 3)
    before, after : ndarray, shape (c,)
        Velocities [m/s] along them at both ends of the step.
    """

    index: np.ndarray
    normal: np.ndarray
    before: np.ndarray
    after: np.ndarray


class Take(NamedTuple):
    """What particles take from the nodes, as kernels take it.

    Attributes
    ----------
    dt, flip
        The step [s], and FLIP's share of the velocity.
    move
        Velocity and next position.
    differentiate
        The velocity gradient.
    """

    dt: float
    flip: float
    move: bool
    differentiate: bool


class Mapping(ABC):
    """An interpolation bound to a grid and particles: transfers both ways.

    ``before`` is called once a step with the particles where they are; transfers may follow in any
    order; ``advance`` moves particles and domains to where ``to_particles(move=True)`` sent them.
    """

    nodes: Nodes
    particles: Particles
    team: Team
    position_next: np.ndarray
    #: Whether ``position_next`` is where particles are after ``advance``, to the last bit.
    foresees: ClassVar[bool] = True
    consistent: ClassVar[bool] = False  # True: the mass couples the nodes, and ``solve`` takes the conditions
    fallen: np.ndarray = np.zeros(0, dtype=np.int64)  # internal indices of domains that fell back to CPDI1

    @property
    def vertices(self) -> Vertices | None:
        """The corners of all domains, or None for the box family."""
        return None

    @property
    def corners(self) -> int:
        """The number of corners of all domains, 0 for the box family."""
        return 0 if self.vertices is None else len(self.vertices)

    @abstractmethod
    def before(self) -> None:
        """Find where everything is; raise ParticleError for what has left the grid."""

    @abstractmethod
    def to_nodes(self, body: np.ndarray, *, kinematic: bool, dynamic: bool) -> None:
        """Add mass and momentum (``kinematic``) and forces (``dynamic``) to the cleared nodes.

        ``body`` is the body force per mass [m/s^2], shape (n, 3) or (1, 3).
        """

    @abstractmethod
    def bring(self, start: int, stop: int, gradient: np.ndarray, take: Take) -> None:
        """Bring to particles start:stop what they take from the nodes.

        ``gradient`` (m, 3, 3) [1/s] receives their velocity gradients, from ``start`` on. Called on several
        threads at once.
        """

    def nodes_to_vertices(self, dt: float, *, move: bool) -> None:  # noqa: B027 (only one family has them)
        """Bring the nodes' velocities to the corners of domains, if it keeps any.

        If the grid's velocity carries them, take note of where they are after ``dt``, if they ``move``.
        """

    def to_particles(
        self,
        dt: float,
        flip: float,
        *,
        move: bool,
        deform: Deform | None = None,
        book: Book | None = None,
        carry: bool = True,
    ) -> int:
        """Bring velocity and next position (``move``) to the particles, and deform them.

        With them go the corners of their domains, if the grid carries them and ``carry`` is True.
        ``book`` must only be given if the mapping :attr:`foresees`.

        ``deform`` is handed velocity gradients of a block of particles as soon as they are known, while
        they are in the processor's cache; none are kept. Return the lowest particle that it refused, or -1.
        """
        self.nodes_to_vertices(dt, move=move and carry)
        take = Take(dt, flip, move, deform is not None)

        def piece(start: int, stop: int) -> int:
            gradient = self.team.scratch(min(BLOCK, len(self.particles)) if deform else 0, 3, 3)
            for a in range(start, stop, BLOCK):
                b = min(a + BLOCK, stop)
                self.bring(a, b, gradient, take)
                if book is not None:
                    book(a, b, self.particles.position[a:b], self.position_next[a:b])
                bad = -1 if deform is None else deform(a, b, gradient)
                if bad >= 0:
                    return bad
            return -1

        return lowest(self.team.blocks(len(self.particles), piece))

    @abstractmethod
    def advance(self, book: Book | None = None) -> None:
        """Take the next positions and bring the domains to the end of the step.

        ``book`` is told where it takes them, if the mapping does not foresee it.
        """

    def swap_positions(self) -> np.ndarray:
        """Let the next positions be the present ones; return those before, (n, 3) [m]."""
        p = self.particles
        p.position, self.position_next = self.position_next, p.position
        return self.position_next

    @abstractmethod
    def permute(self, order: np.ndarray) -> None:
        """Follow a new order of the particles."""

    @abstractmethod
    def state(self) -> dict[str, np.ndarray]:
        """Return the arrays, beside the particles', that a restart needs."""

    @abstractmethod
    def restore(self, arrays: dict[str, np.ndarray]) -> None:
        """Take up what ``state`` gave; the particles have been restored already."""

    @cached_property
    def _spare(self) -> Spare:
        return Spare(self.nodes, self.particles)

    def round_trip(self, velocity: np.ndarray) -> np.ndarray:
        """Return S+ S v: nodal velocities [m/s] brought to the particles and back, shape (records, 3).

        It holds for active nodes, until the next trip. Nodes, particles and where they are to go are left as
        they are.
        """
        nodes, spare = self.nodes, self._spare
        own, trip = nodes.flat, spare.nodes.reshape(-1)
        nodes.each(self.team, lambda *some: set_out(*some, own, velocity, trip))
        with spare.in_place_of_own(self):
            self.to_particles(0.0, 0.0, move=True, carry=False)
            self.velocities_to_nodes()
        nodes.each(
            self.team, lambda a, b, *block: solve(trip, a, b, *block, 0.0, 0.0, 0.0)
        )  # divides by mass
        return spare.nodes[:, :3]

    def velocities_to_nodes(self) -> None:
        """Put momenta of the particles' velocities on nodes that have the masses already."""
        self.nodes.clear(self.team)
        self.to_nodes(np.zeros((1, 3)), kinematic=True, dynamic=False)

    def solve(self, dt: float, rate: float, factor: float, held: Held) -> np.ndarray:
        """Solve with a mass that couples the nodes; return the impulses [N s] along the held directions."""
        raise TypeError("only a mapping with a consistent mass solves by itself")

    def points(self) -> np.ndarray:
        """Return the current positions [m] of all degrees of freedom, shape (records, 3)."""
        return self.nodes.positions()

    def constraint_points(self, index: np.ndarray, points: np.ndarray) -> np.ndarray:
        """Return the current positions [m] of some degrees of freedom, given their first ones."""
        return points

    def records_of(self, vertices: np.ndarray) -> np.ndarray:
        """Return the node records of vertices that are degrees of freedom."""
        raise TypeError("only a mapping with shared corners has degrees of freedom on them")

    def push(self, loads: Sequence[tuple[np.ndarray, np.ndarray]]) -> None:
        """Take forces on vertices for the next transfer: vertices (m,) and forces [N] (m, 3)."""
        raise TypeError("only a mapping with shared corners takes forces on them")

    def stored_energy(self) -> float:
        """Return the energy [J] that the mapping itself stores (hourglass control)."""
        return 0.0

    def spacing(self) -> np.ndarray:
        """Return the height [m] of each domain with an enriched vertex, inf for others, (n,).

        Shape (1,) if no domain has one.
        """
        return np.full(1, np.inf)


@dataclass(frozen=True)
class Interpolation(ABC):
    """Base of all interpolations.

    Class attributes
    ----------------
    dimensions
        The dimensions that it serves.
    uses_vertices
        True for the vertex family.
    shares_corners
        True if neighbouring domains share their corners, so that conditions and loads may act there.
    walls_only
        True if the field at a plane inside the grid is not one layer of nodes (B-splines):
        conditions on planes must then lie on the grid's faces.
    default_scheme
        Name of the scheme for a run that gives none.
    consistent
        True if its mass couples the nodes, so that XPIC and FMPM have nothing to improve.
    affine
        True if APIC's affine velocity can go with it.
    citation
        Keys of ``matpoint.citations``.
    """

    dimensions: ClassVar[tuple[int, ...]] = (1, 2, 3)
    uses_vertices: ClassVar[bool] = False
    shares_corners: ClassVar[bool] = False
    walls_only: ClassVar[bool] = False
    consistent: ClassVar[bool] = False
    citation: ClassVar[tuple[str, ...]] = ()
    #: Equations of stages that this method carries out in its own way, by the stage's name.
    equations: ClassVar[Mapping_[str, str]] = MappingProxyType({})

    @property
    def default_scheme(self) -> str:
        """Name of the scheme for a run that gives none."""
        return "usl"

    @property
    def affine(self) -> bool:
        """Whether APIC's affine velocity can go with it."""
        return not self.uses_vertices

    @property
    @abstractmethod
    def name(self) -> str:
        """The method's name in case files, tables and figures."""

    @abstractmethod
    def bind(self, setting: Setting) -> Mapping:
        """Return the mapping for one simulation."""


Call = Callable[[int, int], int]


def first_fault(team: Team, count: int, call: Call) -> int:
    """Run a checking kernel in pieces; return the lowest index that it found, or -1."""
    return lowest(team.split(count, call))

"""The engine: what the stages of a step do to the arrays.

It holds the run's particles, the bound interpolation, conditions and loads; the scheme decides
which of its methods run, and in which order.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property
from typing import Any, TypeVar

import numpy as np

from matpoint.boundary import Constraints
from matpoint.errors import MatpointError, NotFiniteError, RunError
from matpoint.face_loads import FaceLoads, book_pushes
from matpoint.interpolation.box import BoxMapping
from matpoint.interpolation.contract import Book, Held, Mapping, ParticleError
from matpoint.kernels import EVERY_POINT
from matpoint.kernels.ledger import sum_loads
from matpoint.kernels.nodes import constrain, solve
from matpoint.loads import Damping, Loads
from matpoint.materials import Material, stress_kernel
from matpoint.neumann import NeumannSeries
from matpoint.particles import Particles, Rows
from matpoint.threads import BLOCK, Team, lowest

T = TypeVar("T")

_INVERTED = (
    "det F is not positive or the stress is not finite: the material turned inside out; a shorter step,"
    " smaller loads, the MUSL scheme if it is not in use, or finer cells or another interpolation may help"
)


class Engine:
    """Arrays and passes of one run."""

    def __init__(
        self,
        particles: Particles,
        mapping: Mapping,
        materials: Sequence[Material],
        constraints: Constraints,
        loads: Loads,
        face_loads: FaceLoads | None,
        damping: Damping,
        team: Team,
        flip: float,
        terms: int = 1,
    ) -> None:
        self.particles, self.mapping, self.materials = particles, mapping, tuple(materials)
        self.constraints, self.loads, self.damping = constraints, loads, damping
        self.face_loads = face_loads
        self._pushes: list[tuple[np.ndarray, np.ndarray]] = []
        self.team, self.flip, self.terms = team, flip, terms
        self.time, self.step, self.dt = 0.0, 0, 0.0
        self.body = np.zeros((1, 3))
        self._books: Book | None = None  # what sums up the loads' work, if there are any
        self._work = np.zeros((-(-len(particles) // BLOCK), 7))  # of the loads, by blocks of particles
        # Impulse of all external forces (3) [N s], their work [J], impulse of their moments (3).
        self.external = np.zeros(7)
        self._laws: list[Callable[..., int]] = [stress_kernel(m) for m in self.materials]
        self.list_materials()

    # -- bookkeeping -------------------------------------------------------------------------

    def list_materials(self) -> None:
        """List the particles of each material; needed after any change of order."""
        material, count = self.particles.material, len(self.materials)
        self.groups = [np.flatnonzero(material == k).astype(np.int32) for k in range(count)]
        if count == 1:
            self.groups = [EVERY_POINT]

    def over_materials(self, call: Callable[[Material, Particles, Rows], T]) -> list[T]:
        """Call a function on blocks of the particles of each material; return the results in order.

        The blocks do not depend on the number of threads.
        """
        p, results = self.particles, []
        for material, index in zip(self.materials, self.groups, strict=True):
            whole = index is EVERY_POINT  # then a slice makes no copies

            def blocks(a: int, b: int, m=material, index=index, whole=whole) -> list[T]:
                edges = [(c, min(c + BLOCK, b)) for c in range(a, b, BLOCK)]
                return [call(m, p, slice(c, d) if whole else index[c:d]) for c, d in edges]

            for part in self.team.blocks(len(p) if whole else len(index), blocks):
                results += part
        return results

    def fail(self, particle: int, cause: str) -> RunError:
        """Return the error for a particle at an internal index."""
        p = self.particles
        where = p.position[particle]
        if not np.isfinite(where).all() or not np.isfinite(p.velocity[particle]).all():
            cause = "its position or velocity is not a finite number: the run is unstable (dt too long?)"
        return RunError(
            cause, step=self.step, time=self.time, particle=int(p.id[particle]), position=where.tolist()
        )

    # -- stages ------------------------------------------------------------------------------

    def locate(self) -> None:
        """Find every particle's cell, and evaluate the loads where the particles are."""
        try:
            self.mapping.before()
        except ParticleError as fault:
            raise self.fail(fault.particle, fault.cause) from None
        try:
            self.body = self.loads.evaluate(self.particles, self.time)
            if self.face_loads is not None and self.mapping.vertices is not None:
                self._pushes = self.face_loads.evaluate(self.mapping.vertices, self.time)
                self.mapping.push(self._pushes)
        except NotFiniteError as fault:
            if fault.particle is None:
                raise
            raise self.fail(fault.particle, str(fault)) from None
        self._books = self._book_loads if self.body.any() else None

    def clear(self) -> None:
        """Empty the node records."""
        self.mapping.nodes.clear(self.team)

    def gather(self) -> None:
        """Mass, momentum and forces to the nodes."""
        self._to_nodes(dynamic=True)

    def gather_momentum(self) -> None:
        """Mass and momentum to the nodes."""
        self._to_nodes(dynamic=False)

    def gather_affine(self) -> None:
        """APIC's affine momentum to the nodes."""
        self._box().affine_to_nodes()

    def solve(self) -> None:
        """Velocities at the end of the step, and increments."""
        self._solve(self.dt)

    def divide(self) -> None:
        """Velocities from momenta."""
        self._solve(0.0)

    def hold(self) -> None:
        """Conditions on the motion over the step; reactions are added to the ledger."""
        before = self.constraints.velocities(self.time)
        after = self.constraints.velocities(self.time + self.dt)
        self._constrain(before, after, self.external)

    def hold_start(self) -> None:
        """Conditions on the velocities at the start."""
        given = self.constraints.velocities(self.time)
        self._constrain(given, given, np.zeros(7))

    def hold_end(self) -> None:
        """Conditions on the velocities at the end."""
        given = self.constraints.velocities(self.time + self.dt)
        self._constrain(given, given, np.zeros(7))

    def scatter(self) -> None:
        """Velocity and position to the particles; velocity gradient, F and stress."""
        self._return(self.flip, move=True, deform=True)

    def move(self) -> None:
        """Velocity and position to the particles."""
        self._return(self.flip, move=True, deform=False)

    def deform(self) -> None:
        """Velocity gradient, F and stress."""
        self._return(self.flip, move=False, deform=True)

    def extend(self) -> None:
        """XPIC's velocity for the particles, in the place of the nodes' increments."""
        self._add_series(1.0, self.external)
        self._series.take(4)

    def invert_mass(self) -> None:
        """FMPM's velocities at the end of the step."""
        self._add_series(0.0, self.external)
        self._series.take(0)

    def invert_mass_only(self) -> None:
        """FMPM's velocities from momenta, for the gradient alone."""
        self._add_series(0.0, np.zeros(7))
        self._series.take(0)

    def scatter_extended(self) -> None:
        """XPIC's velocity and position to the particles; velocity gradient, F and stress."""
        self._take_extended(deform=True)

    def move_extended(self) -> None:
        """XPIC's velocity and position to the particles."""
        self._take_extended(deform=False)

    def scatter_affine(self) -> None:
        """APIC's moment of velocity to the particles."""
        self._box().nodes_to_affine()

    def advance(self) -> None:
        """Take the next positions, bring the domains along, and book the loads' work."""
        v = self.mapping.vertices if self._pushes else None
        corners_before = None if v is None else v.position
        try:
            self.mapping.advance(None if self.mapping.foresees else self._books)
        except ParticleError as fault:
            raise self.fail(fault.particle, fault.cause) from None
        if self._books is not None:
            dt = self.dt
            self.external += self._work.sum(axis=0) * np.array([dt, dt, dt, 1.0, dt, dt, dt])
        if v is not None and corners_before is not None:
            book_pushes(self._pushes, corners_before, v.position, self.dt, self.external)

    # -- helpers -----------------------------------------------------------------------------

    def _box(self) -> BoxMapping:
        assert isinstance(self.mapping, BoxMapping)  # refused for others when the run was set up
        return self.mapping

    def _book_loads(self, start: int, stop: int, before: np.ndarray, after: np.ndarray) -> None:
        some = slice(start, stop)
        body = self.body[some] if len(self.body) > 1 else self.body
        sum_loads(BLOCK, self.particles.mass[some], body, before, after, self._work[start // BLOCK :])

    def _return(self, flip: float, *, move: bool, deform: bool) -> None:
        mapping = self.mapping
        bad = mapping.to_particles(
            self.dt,
            flip,
            move=move,
            deform=self._deform if deform else None,
            book=self._books if move and mapping.foresees else None,
        )
        if bad >= 0:
            raise self.fail(bad, _INVERTED)

    def _deform(self, start: int, stop: int, gradient: np.ndarray) -> int:
        """Deform particles start:stop and evaluate their laws, one material after the other."""
        p = self.particles
        found = []
        for law, index in zip(self._laws, self.groups, strict=True):
            a, b = start, stop
            if index is not EVERY_POINT:
                a, b = np.searchsorted(index, np.array([start, stop], dtype=np.int32))
            found.append(
                law(
                    index, a, b, p.deformation_gradient, start, gradient, p.volume0, p.volume, p.state,
                    p.stress, self.dt,
                )
            )  # fmt: skip
        return lowest(found)

    def _take_extended(self, deform: bool) -> None:
        """Add what stands in the place of increments to nothing: that is the particles' new velocity."""
        self.particles.velocity[:] = 0.0
        self._return(1.0, move=True, deform=deform)

    @cached_property
    def _series(self) -> NeumannSeries:
        return NeumannSeries(self.mapping, self.constraints, self.terms)

    def _add_series(self, share: float, external: np.ndarray) -> None:
        """Add up the series' terms after the first, v - share dv; conditions on them are booked."""
        c, push = self.constraints, self._series.add_up(share)
        if len(c.index):
            before, after = c.velocities(self.time), c.velocities(self.time + self.dt)
            self._book(push, before, after, external)

    def _book(self, push: np.ndarray, before: np.ndarray, after: np.ndarray, external: np.ndarray) -> None:
        """Book impulses [N s] along the held directions, their work and their moment."""
        c = self.constraints
        vectors = push[:, None] * c.normal
        points = self.mapping.constraint_points(c.index, c.points)
        external[:3] += vectors.sum(axis=0)
        external[3] += float((push * 0.5 * (before + after)).sum())
        external[4:] += np.cross(points, vectors).sum(axis=0)

    def _to_nodes(self, *, dynamic: bool) -> None:
        try:
            self.mapping.to_nodes(self.body, kinematic=True, dynamic=dynamic)
        except ParticleError as fault:
            raise self.fail(fault.particle, fault.cause) from None

    def _solve_consistent(self, dt: float) -> None:
        """Solve with the conditions inside; the stage of conditions then finds nothing left to do."""
        c = self.constraints
        before, after = c.velocities(self.time), c.velocities(self.time + dt)
        held = Held(c.index, c.normal, before, after)
        try:
            push = self.mapping.solve(dt, self.damping.rate, self.damping.factor, held)
        except MatpointError as fault:
            raise RunError(str(fault), step=self.step, time=self.time) from None
        if dt > 0.0:
            self._book(push, before, after, self.external)

    def _solve(self, dt: float) -> None:
        if self.mapping.consistent:
            self._solve_consistent(dt)
            return
        n, damping = self.mapping.nodes, (self.damping.rate, self.damping.factor)
        n.each(self.team, lambda a, b, *block: solve(n.flat, a, b, *block, dt, *damping))

    def _constrain(self, before: np.ndarray, after: np.ndarray, external: np.ndarray) -> Any:
        c = self.constraints
        if len(c.index):
            points = self.mapping.constraint_points(c.index, c.points)
            constrain(
                self.mapping.nodes.records, c.index, points, c.normal, before, after, self.flip, external
            )

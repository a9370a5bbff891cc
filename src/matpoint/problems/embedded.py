"""What the problems of inclusions share: a stiff body in a plate whose far faces follow an exact solution."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from matpoint.problem import Announce, Problem, Result
from matpoint.problems.fields import Exact, Field, elements, fitted_order, make_field
from matpoint.problems.relaxation import Ramp, settle

if TYPE_CHECKING:
    from matpoint.boundary import Condition
    from matpoint.domains import Domains
    from matpoint.interpolation import Interpolation
    from matpoint.output.history import Probe
    from matpoint.scheme import Scheme
    from matpoint.simulation import Simulation
    from matpoint.timestep import TimeStep

RADIUS, SIZE = 1.0, 2.0  # of the disc or sphere, half-width of the plate [m]
SPEED = 40.0  # of waves in every material [m/s]: at rest density does not matter, so it is chosen for that
PASS = SIZE / SPEED  # a wave's way through the plate [s]
RISE = 4 * PASS
POISSON = 0.3
HOURGLASS = 0.1  # without it, modes of almost no stiffness take ten times as long to come to rest


@dataclass(frozen=True)
class Beyond:
    """The points whose largest coordinate is ``size`` [m] or more."""

    size: float

    def contains(self, points: np.ndarray) -> np.ndarray:
        """Return a flag for each of the points, shape (n, 3) [m]."""
        return points.max(axis=1) >= self.size * (1.0 - 1e-9)


class Embedded(Problem):
    """A problem of this kind; subclasses are frozen dataclasses with a field ``layers``."""

    dim: ClassVar[int]
    layers: int
    end: ClassVar[float] = RISE + 12 * PASS
    step: ClassVar[float] = 1e-4

    @property
    @abstractmethod
    def exact(self) -> Exact:
        """The reference solution."""

    @property
    @abstractmethod
    def moduli(self) -> dict[str, float]:
        """Name of each body -> its Young's modulus [Pa], from the inside."""

    @property
    @abstractmethod
    def ladder(self) -> tuple[int, ...]:
        """Divisions of an eighth of a circle, level by level."""

    @abstractmethod
    def parts(self, divisions: int) -> list[Domains]:
        """Return the domains of each material, from the inside."""

    @property
    def probes(self) -> tuple[Probe, ...]:
        """The stress at the centre, which holds everywhere inside."""
        from matpoint.output.history import Probe  # noqa: PLC0415 (keeps the import of a case light)

        return (Probe("centre", (0.01 * RADIUS,) * self.dim, "stress", "xx"),)

    def simulation(
        self,
        interpolation: Interpolation,
        *,
        scheme: Scheme | None = None,
        timestep: TimeStep | None = None,
        threads: int | None = None,
        divisions: int | None = None,
    ) -> Simulation:
        """Return the simulation of the finest level, or of the given divisions.

        Cells of the grid are equal squares or cubes, 1.25 for each division along the plate's half-width,
        so two domains each at the interface. Where domains have no shared corners, the grid's nodes from
        the far faces on are driven instead of the faces. The interpolation is taken as it is; see
        :meth:`widened` for what verification takes.
        """
        import matpoint as mp  # noqa: PLC0415 (keeps the import of a case light)

        finest = self.ladder[-1] if divisions is None else divisions
        cell = SIZE / max(1, round(1.25 * finest))
        # Parallelograms of CPDI1 stand out over the planes of symmetry by a little.
        beyond = cell if interpolation.uses_vertices and not interpolation.shares_corners else 0.0
        stiff = (1 - POISSON) / ((1 + POISSON) * (1 - 2 * POISSON)) / SPEED**2
        bodies = [
            mp.Body(part, mp.NeoHookean(E=young, nu=POISSON, density=stiff * young), name=name)
            for part, (name, young) in zip(self.parts(finest), self.moduli.items(), strict=True)
        ]
        planes = [mp.Symmetry(mp.Plane(axis, 0.0, "lower")) for axis in "xyz"[: self.dim]]
        return mp.Simulation(
            mp.Grid((-beyond,) * self.dim, (SIZE + cell,) * self.dim, cell),
            bodies,
            interpolation=interpolation,
            scheme=mp.USL(mp.FLIP(0.99)) if scheme is None else scheme,
            timestep=mp.CFL(0.8, every=1000) if timestep is None else timestep,
            boundaries=[*planes, self._driven(interpolation.shares_corners)],
            damping=mp.MassDamping(np.pi * SPEED / SIZE),
            threads=threads,
            sample_every=1000,
        )

    def _driven(self, faces: bool) -> Condition:
        import matpoint as mp  # noqa: PLC0415 (keeps the import of a case light)

        where = mp.Surface("outer") if faces else Beyond(SIZE)
        return mp.PrescribedVelocity(where, Ramp(self.exact.displacement, RISE).velocities(self.dim))

    def widened(self, interpolation: Interpolation) -> Interpolation:
        """Return a method as verification runs it: with the problem's layers, and hourglass control."""
        from matpoint.interpolation import EnrichedCPDI2  # noqa: PLC0415 (compiles)

        if not isinstance(interpolation, EnrichedCPDI2) or interpolation.where != "interfaces":
            return interpolation
        return replace(interpolation, layers=self.layers, hourglass=HOURGLASS)

    def at_rest(self, method: str, divisions: int, interpolation: Interpolation | None = None) -> Field:
        """Return the stresses of a method on the mesh of the given divisions.

        Parameters
        ----------
        method
            One of ``self.methods``.
        divisions
            Of an eighth of a circle.
        interpolation
            Something else than the method as verification runs it; taken as it is.
        """
        from matpoint.interpolation import METHODS  # noqa: PLC0415 (compiles)

        if method == "fem":
            return elements(self.parts(divisions), list(self.moduli.values()), POISSON, self.exact)
        chosen = self.widened(METHODS[method]) if interpolation is None else interpolation
        sim = self.simulation(chosen, divisions=divisions, threads=1 if self.dim == 2 else None)
        settle(sim, RISE, PASS, self.end)
        p, v = sim.particles, sim.vertices
        assert v is not None
        mesh = v.position0, v.connectivity
        return make_field(self.exact, p.stress.copy(), *mesh, p.body.copy(), p.volume0.copy(), p.position0)

    def verify(
        self,
        methods: Sequence[str] | None = None,
        out: Path | None = None,
        progress: Announce | None = None,
    ) -> Result:
        """Run methods on all levels; into ``out`` go ``convergence.csv`` and figures."""
        names = self.chosen(methods)
        fields: dict[str, list[Field]] = {}
        for number, name in enumerate(names):
            if progress is not None:
                progress(name, number, len(names))
            fields[name] = [self.at_rest(name, n) for n in self.ladder]
        if out is not None:
            from matpoint.problems.inclusion_figures import write_embedded  # noqa: PLC0415 (loads matplotlib)

            write_embedded(self, fields, out)
        return {name: self.norms_of([f.measure() for f in runs]) for name, runs in fields.items()}

    def norms_of(self, levels: Sequence[dict[str, float]]) -> dict[str, float]:
        """Return the norms of the finest level, and orders of convergence where ``self.norms`` has them."""
        found = dict(levels[-1])
        for norm in self.norms:
            if norm.endswith("_order"):
                errors = [level[norm.removesuffix("_order")] for level in levels]
                found[norm] = fitted_order(self.ladder, errors)
        return found

"""The base of the manufactured problems: exact start, body force, and errors against the exact fields."""

from __future__ import annotations

import time
from abc import abstractmethod
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar
from weakref import WeakKeyDictionary

import numpy as np

from matpoint.checks import instance, not_negative, positive, whole
from matpoint.errors import InputError, RunError, did_you_mean, naming
from matpoint.problem import Announce, Problem, Result
from matpoint.problems.errors_table import errors_table
from matpoint.problems.errors_track import FIELDS, ErrorTrack, sampling
from matpoint.problems.sampler import Sampler

if TYPE_CHECKING:
    from matpoint.boundary import Condition
    from matpoint.domains import Domains
    from matpoint.grid import Grid
    from matpoint.interpolation import Interpolation
    from matpoint.mms import Manufactured
    from matpoint.output.history import Probe
    from matpoint.scheme import Scheme
    from matpoint.simulation import Simulation
    from matpoint.timestep import TimeStep
    from matpoint.transfers import Transfer

# When det F is looked at: 48 equal parts of the run meet its halves, thirds and quarters, and hence the
# extremes of waves that are a half or a third of a period apart.
_TIMES = 49
_FEWER = 12  # of these parts for the other fields, which take longer
_PLACES = 2000  # about so many, where a problem has no lattice of its own
_CHECKED: WeakKeyDictionary[Manufactured, set[type]] = WeakKeyDictionary()


@dataclass(frozen=True)
class ManufacturedProblem(Problem):
    """A run whose exact solution is known everywhere.

    That the motion does not fold, det F > 0, is checked when the problem is made: at the places of
    ``lattice`` and at 49 equally spaced times from 0 to ``end``; that displacement, velocity, stress and body
    force are finite numbers, there and at every fourth of these times. Only a run finds what lies between.

    Parameters
    ----------
    cells
        Grid cells along an axis.
    per_cell
        Particles per cell and axis.
    amplitude
        Of the solution; its unit is the solution's.
    staggered
        Velocities live half a step before positions, at the start and where they are compared, as
        symplectic Euler keeps them: its error is then of second order in the step.
    dt
        Time step [s]; 0 takes the problem's own.
    scheme
        Order of a step's stages: "usl", "usf" or "musl"; "" takes USL, and MUSL for plain MPM: under USL it
        turns a particle inside out long before the end on 96 cells. So do ``mls``, ``imls`` and ``tls``
        where there are free surfaces; they then take MUSL too, which for ``imls`` is T 36.

    Raises
    ------
    InputError
        If one of them can't be, or the motion folds.
    """

    cells: int = 32
    per_cell: int = 2
    amplitude: float = 0.1
    staggered: bool = False
    dt: float = 0.0
    scheme: str = ""

    #: Those of these that are there are run unless others are asked for; any other method may be.
    methods: ClassVar[tuple[str, ...]] = (
        "mpm", "ugimp", "cpgimp", "cpdi1", "cpdi2", "bspline2", "bspline3", "mls", "imls", "spline-imls",
    )  # fmt: skip
    norms: ClassVar[dict[str, str]] = {
        f"{field}{part}": f"RMS error of {field} [{unit}] {when}"
        for part, when in (("", "at the end"), ("_quarter", "at a quarter of it"), ("_max", "at its largest"))
        for field, unit in FIELDS.items()
    }
    files: ClassVar[tuple[str, ...]] = ("figure-*.png", "errors.csv")
    #: Whether the body's outside lies inside the grid, where nodes see slivers of it.
    free_surfaces: ClassVar[bool] = False
    #: Cells of a convergence study.
    sizes: ClassVar[tuple[int, ...]] = (8, 16, 32, 64)
    #: The step [s] for up to ``coarse`` cells; its count up to the end is a multiple of 4.
    longest: ClassVar[float]
    coarse: ClassVar[int]

    def __post_init__(self) -> None:
        whole(f"{self.name}: cells", self.cells, 2)
        whole(f"{self.name}: per_cell", self.per_cell)
        positive(f"{self.name}: amplitude", self.amplitude)
        not_negative(f"{self.name}: dt", self.dt)
        if self.scheme not in ("", "usl", "usf", "musl"):
            raise InputError(f'{self.name}: scheme = {self.scheme!r}; "usl", "usf" and "musl" are allowed')
        if not isinstance(self.staggered, bool):
            raise InputError(f"{self.name}: staggered = {self.staggered!r} must be true or false")
        if abs(self.end / self.step / 4 - round(self.end / self.step / 4)) > 1e-6:
            raise InputError(f"{self.name}: dt = {self.dt:g} s must go into a quarter of {self.end:g} s")
        self._refuse_folds()

    # -- what a subclass gives ---------------------------------------------------------------

    @property
    @abstractmethod
    def solution(self) -> Manufactured:
        """The exact solution."""

    @abstractmethod
    def grid(self) -> Grid:
        """Return the grid."""

    @abstractmethod
    def mesh(self) -> Domains:
        """Return the domains of the particles in the reference configuration."""

    @abstractmethod
    def conditions(self) -> Sequence[Condition]:
        """Return the conditions at the walls."""

    def lattice(self) -> np.ndarray:
        """Return places all over the body, where det F is checked, (n, 3) [m]: some of its corners."""
        corners = self.mesh().vertices.reshape(-1, 3)
        return corners[:: max(1, len(corners) // _PLACES)]

    def _own_solution(self) -> Manufactured:
        from matpoint.mms import Manufactured  # noqa: PLC0415 (loads sympy)

        instance(f"{self.name}: solution", self.solution, Manufactured, "a matpoint.mms.Manufactured")
        return self.solution

    def _refuse_folds(self) -> None:
        """Refuse folds and fields that are no numbers; once for each solution and kind of problem."""
        exact = self._own_solution()
        seen = _CHECKED.setdefault(exact, set())
        if type(self) not in seen:
            with naming(self.name):
                places, times = self.lattice(), np.linspace(0.0, self.end, _TIMES)
                exact.refuse_folds(places, times)
                exact.refuse_infinite(places, times[:: _TIMES // _FEWER])
            seen.add(type(self))

    # -- the run -----------------------------------------------------------------------------

    @property
    def step(self) -> float:  # type: ignore[override]
        """The time step [s]."""
        return self.dt or self.longest / -(-self.cells // self.coarse)

    @property
    def probes(self) -> tuple[Probe, ...]:
        """No particle is singled out."""
        return ()

    def simulation(
        self,
        interpolation: Interpolation,
        *,
        scheme: Scheme | None = None,
        timestep: TimeStep | None = None,
        threads: int | None = None,
    ) -> Simulation:
        """Return the run on its exact start."""
        import matpoint as mp  # noqa: PLC0415 (keeps the import of a case light)
        from matpoint.timestep import FixedStep  # noqa: PLC0415

        rule, early = FixedStep(self.step) if timestep is None else timestep, 0.0
        if self.staggered:
            if not isinstance(rule, FixedStep):
                raise InputError(f"{self.name}: staggered velocities need a fixed step")
            early = 0.5 * rule.dt
        exact, grid = self.solution, self.grid()
        if exact.dim > grid.dim:
            raise InputError(
                f"{self.name}: the displacement has {exact.dim} components, the grid is {grid.dim}-D; give no"
                " more components than the grid has axes"
            )
        body = mp.Body(
            self.mesh(), exact.material, start=exact.start(), velocity=lambda X: exact.velocity(X, -early),
            name=self.name,
        )  # fmt: skip
        try:
            return mp.Simulation(
                grid, [body], interpolation=interpolation, timestep=rule,
                scheme=self.scheme_for(interpolation) if scheme is None else scheme,
                boundaries=list(self.conditions()), loads=[exact.load()], threads=threads,
            )  # fmt: skip
        except InputError as error:  # nobody can allow an unstable step of the problem's own
            over, _, cure = str(error).partition("; shorten it, or set allow_unstable")
            if timestep is None and cure:
                raise InputError(f"{over}; set a shorter problem.dt") from None
            raise

    def scheme_for(self, interpolation: Interpolation, transfer: Transfer | None = None) -> Scheme:
        """Return the order of stages that was asked for, or the one in which a method lives longest.

        Parameters
        ----------
        interpolation
            The method.
        transfer
            How velocities come back; None takes FLIP().
        """
        from matpoint.scheme import SCHEMES  # noqa: PLC0415 (keeps the import of a case light)
        from matpoint.transfers import FLIP  # noqa: PLC0415

        short_lived = ("mpm", "mls", "imls", "tls") if self.free_surfaces else ("mpm",)
        own = "musl" if interpolation.name in short_lived else interpolation.default_scheme
        return SCHEMES[self.scheme or own](FLIP() if transfer is None else transfer)

    def particle_count(self) -> float:
        """Return how many particles the mesh will have, for checks before a run."""
        return float(self.mesh().n)

    def errors(self, sim: Simulation) -> np.ndarray:
        """Return the RMS errors of displacement, velocity and stress as they are now (T 48), shape (3,)."""
        p, exact = sim.particles, self.solution
        X, now = p.position0, sim.time
        before = now - 0.5 * sim.dt if self.staggered else now
        gaps = (
            p.position - exact.position(X, now),
            p.velocity - exact.velocity(X, before),
            p.stress - exact.stress(X, now),
        )
        # A tensor's norm counts each shear twice.
        weight = np.array([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])
        squares = [(g**2).sum(axis=1) for g in gaps[:2]] + [(gaps[2] ** 2) @ weight]
        return np.sqrt([s.mean() for s in squares])

    def track(
        self, interpolation: Interpolation, threads: int | None = None, transfer: Transfer | None = None
    ) -> ErrorTrack:
        """Run a method to the end, or to where it fails, and return its errors over time.

        Parameters
        ----------
        interpolation
            The method.
        threads
            None takes all processors.
        transfer
            How velocities come back; None takes FLIP().
        """
        scheme = self.scheme_for(interpolation, transfer)
        sim = self.simulation(interpolation, scheme=scheme, threads=threads)
        sampler = Sampler(sampling(self.end, self.step), self.errors)
        failed, began = None, time.perf_counter()
        try:
            sim.run(self.end, writers=[sampler])
        except RunError as error:
            failed = str(error)
        except (ArithmeticError, ValueError, MemoryError) as error:  # of other methods the run goes on
            failed = f"step {sim.step}, t = {sim.time:.6g} s: {type(error).__name__}: {error}"
        wall = time.perf_counter() - began
        return ErrorTrack(
            sampler.times, sampler.values, self.end, failed, len(sim.particles) * sim.step, wall
        )

    def measure(self, track: ErrorTrack) -> dict[str, float]:
        """Return the norms of a run; those that it did not reach are NaN."""
        return track.norms()

    def chosen(self, methods: Sequence[str] | None) -> tuple[str, ...]:
        """Return the names to run; None takes those of ``methods`` that there are."""
        from matpoint.interpolation import METHODS  # noqa: PLC0415 (compiles)

        if methods is None:
            return tuple(name for name in self.methods if name in METHODS)
        for name in methods:
            if name not in METHODS:
                hint = did_you_mean(name, METHODS)
                raise InputError(f"{self.name}: method {name!r}{hint}; {', '.join(METHODS)} are allowed")
        if not methods:
            raise InputError(f"{self.name}: no method given; {', '.join(METHODS)} are allowed")
        return tuple(dict.fromkeys(methods))

    def refuse(self, interpolation: Interpolation, transfer: Transfer | None = None) -> None:
        """Refuse a method that can never run on this problem, whatever its size.

        Parameters
        ----------
        interpolation
            The method.
        transfer
            How velocities come back; None takes FLIP().

        Raises
        ------
        InputError
            With what would do instead.
        """
        from matpoint.combinations import refuse_combinations  # noqa: PLC0415 (compiles)

        scheme = self.scheme_for(interpolation, transfer)
        refuse_combinations(self.grid().dim, interpolation, scheme, list(self.conditions()), [])

    def refuse_methods(self, methods: Sequence[str]) -> None:
        """Refuse methods that can't run here: those that never can, and those whose start can't be made."""
        from matpoint.interpolation import METHODS  # noqa: PLC0415 (compiles)

        for name in methods:
            with _leaving_out(self.name, name):
                self.refuse(METHODS[name])
        for name in methods:
            with naming(f"{self.name}: {name}"):
                self.simulation(METHODS[name])

    def verify(
        self,
        methods: Sequence[str] | None = None,
        out: Path | None = None,
        progress: Announce | None = None,
    ) -> Result:
        """Run methods at the problem's own cells; into ``out`` go their errors over time.

        A method whose run ends early does not end the others: under ``failed`` stands where and why.
        """
        from matpoint.interpolation import METHODS  # noqa: PLC0415 (compiles)

        names, tracks = self.chosen(methods), {}
        for number, name in enumerate(names):
            if progress is not None:
                progress(name, number, len(names))
            tracks[name] = self.track(METHODS[name])
        if out is not None:
            from matpoint.problems.errors_figure import write_errors  # noqa: PLC0415 (loads matplotlib)

            write_errors(self.title, tracks, out)
        return {name: {**self.measure(track), "failed": track.failed} for name, track in tracks.items()}

    def table(self, result: Result) -> str:
        """Return the norms as aligned text, one line per method, and why runs ended early."""
        return errors_table(result, self.norms)


@contextmanager
def _leaving_out(problem: str, method: str) -> Iterator[None]:
    """Name the problem and the method in what is refused inside; without the method the others can run."""
    try:
        yield
    except InputError as error:
        text = str(error).removeprefix(f"{problem}: ")
        named = text if text.startswith(method) else f"{method}: {text}"
        raise InputError(f"{problem}: {named}; or leave {method} out of the methods") from None

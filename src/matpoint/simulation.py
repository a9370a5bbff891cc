"""The simulation: everything chosen, bound together, and run."""

from __future__ import annotations

import hashlib
import math
import warnings
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from matpoint.begin import begin
from matpoint.body import Body
from matpoint.boundary import Condition, Constraints
from matpoint.checks import number, positive, whole
from matpoint.combinations import check_arguments, refuse_combinations
from matpoint.engine import Engine
from matpoint.errors import InputError, naming
from matpoint.face_loads import FaceLoad, FaceLoads
from matpoint.fingerprint import identity
from matpoint.grid import Grid
from matpoint.interpolation.contract import Interpolation, ParticleError, Setting
from matpoint.ledger import Ledger, take_entry
from matpoint.loads import Damping, Load, Loads, NoDamping
from matpoint.materials import Material
from matpoint.memory import give_back
from matpoint.particles import Particles
from matpoint.places import Corners, Surface
from matpoint.quantities import QUANTITIES
from matpoint.run import Observer, run_steps
from matpoint.scheme import SCHEMES, Scheme
from matpoint.setup import make_setting
from matpoint.sorting import cell_order
from matpoint.start import check_start
from matpoint.threads import Team
from matpoint.timestep import FixedStep, TimeStep, stable_step
from matpoint.transfers import APIC

if TYPE_CHECKING:
    from matpoint.output.contract import Writer
    from matpoint.vertices import Vertices

_FEW = 5  # ids that a note names


class Simulation:
    """A run of one case by one method.

    Parameters
    ----------
    grid
        The background grid; it gives the dimension.
    bodies
        At least one.
    interpolation
        For instance ``CPDI2()``.
    timestep
        ``FixedStep(dt)`` or ``CFL(fraction)``.
    scheme
        ``USL``, ``USF`` or ``MUSL`` with a transfer; None takes the interpolation's own, mostly USL.
    boundaries, loads, damping
        Conditions on the nodes, gravity and body forces, damping.
    threads
        How many; None takes all processors. The result does not depend on it, to the last bit.
    sort_every
        Steps between two sorts of the particles by cell.
    sample_every
        Steps between two entries of the ledger.

    Raises
    ------
    InputError
        If anything can't work, before a step is made.
    """

    def __init__(
        self,
        grid: Grid,
        bodies: Sequence[Body],
        *,
        interpolation: Interpolation,
        timestep: TimeStep,
        scheme: Scheme | None = None,
        boundaries: Sequence[Condition] = (),
        loads: Sequence[Load | FaceLoad] = (),
        damping: Damping | None = None,
        threads: int | None = None,
        sort_every: int = 100,
        sample_every: int = 10,
    ) -> None:
        check_arguments(grid, bodies, interpolation, timestep, scheme, boundaries, loads, damping)
        self.grid, self.bodies, self.interpolation = grid, tuple(bodies), interpolation
        self.scheme = SCHEMES[interpolation.default_scheme]() if scheme is None else scheme
        self.timestep, self.boundaries, self.loads = timestep, tuple(boundaries), tuple(loads)
        for name, value in (("sort_every", sort_every), ("sample_every", sample_every)):
            whole(f"simulation: {name}", value)
        self.sort_every, self.sample_every = sort_every, sample_every
        refuse_combinations(self.dim, interpolation, self.scheme, boundaries, loads)
        self.notes: list[str] = []
        self._fallen = ""  # the note of domains that fell back, and when the first did
        self._fell = ""
        team = Team(threads)
        setting, materials = make_setting(grid, self.bodies, team)
        setting.held = self._held(setting, boundaries)
        face_loads = [load for load in loads if isinstance(load, FaceLoad)]
        for place, load in enumerate(loads):
            if isinstance(load, FaceLoad):
                with naming(f"load {place} ({type(load).__name__})"):
                    setting.faces_of(load.where)
        try:
            mapping = interpolation.bind(setting)
        except ParticleError as fault:
            raise InputError(
                f"{interpolation.name}: particle {int(setting.particles.id[fault.particle])}: {fault.cause}"
            ) from None
        deformed = begin(setting, mapping, self.bodies)
        constraints = Constraints(
            boundaries,
            grid,
            mapping.points(),
            interpolation.walls_only,
            lambda where: mapping.records_of(setting.vertices_at(where)),
        )
        if isinstance(self.scheme.transfer, APIC):
            setting.particles.add("affine_moment", np.zeros((len(setting.particles), 3, 3)))
        self.engine = Engine(
            setting.particles,
            mapping,
            materials,
            constraints,
            Loads([load for load in loads if not isinstance(load, FaceLoad)], grid.dim),
            FaceLoads(face_loads, setting) if face_loads else None,
            NoDamping() if damping is None else damping,
            team,
            self.scheme.transfer.share,
            self.scheme.transfer.terms,
        )
        if deformed:
            self.sort()
        check_start(self)
        self.notes += setting.notes
        self._note_fallen("at the start")
        with np.errstate(all="ignore"):  # what is too large is refused here and in so many words
            self.engine.dt = self._first_step()
            entry = take_entry(self.engine)
        if not entry.computable:
            raise InputError(
                "simulation: mass, momentum or energy at the start is too large for a number; are the units"
                " of densities, velocities and lengths right?"
            )
        self.ledger = Ledger(entry, entry)
        give_back()

    # -- what it is --------------------------------------------------------------------------

    @property
    def fallen(self) -> np.ndarray:
        """Ids of the particles whose domains fell back to CPDI1 (``on_inversion``), the first one first."""
        return self.particles.id[self.engine.mapping.fallen]

    @property
    def dim(self) -> int:
        """The dimension: 1, 2 or 3."""
        return self.grid.dim

    @property
    def particles(self) -> Particles:
        """The particles; read them, don't write to them."""
        return self.engine.particles

    @property
    def vertices(self) -> Vertices | None:
        """The vertices of the particle domains, or None for the box family."""
        return self.engine.mapping.vertices

    @property
    def materials(self) -> tuple[Material, ...]:
        """The materials; ``particles.material`` indexes them."""
        return self.engine.materials

    @property
    def time(self) -> float:
        """The time reached [s]."""
        return self.engine.time

    @property
    def step(self) -> int:
        """The number of steps made."""
        return self.engine.step

    @property
    def dt(self) -> float:
        """The length of the last step, or of the first before it is made [s]."""
        return self.engine.dt

    @property
    def threads(self) -> int:
        """The number of threads."""
        return self.engine.team.threads

    @property
    def citation(self) -> tuple[str, ...]:
        """Keys of ``matpoint.citations`` for exactly the methods in use."""
        parts = [self.interpolation.citation, self.scheme.citation, self.scheme.transfer.citation]
        parts += [m.citation for m in self.materials]
        return tuple(dict.fromkeys(key for part in parts for key in part))

    def vertex_spacing(self) -> np.ndarray:
        """Return the height [m] of each domain with an enriched vertex, inf for others, shape (n,)."""
        return self.engine.mapping.spacing()

    def quantity(self, name: str) -> float:
        """Return a named number (see ``matpoint.quantities``).

        Raises
        ------
        InputError
            If there is none of that name.
        """
        if name not in QUANTITIES:
            raise InputError(f"quantity {name!r} does not exist; there are {', '.join(QUANTITIES)}")
        return QUANTITIES[name].function(self)

    def explain(self) -> str:
        """Return the stages of a step as a table: stage, equation, arrays read and written."""
        lines = []
        for place, stage in enumerate(self.scheme.stages, 1):
            equation = self.interpolation.equations.get(stage.name, stage.equation)
            lines.append(f"{place:2d}. {stage.name}: {equation}")
            lines.append(f"      reads {', '.join(stage.reads) or '-'}; writes {', '.join(stage.writes)}")
        return "\n".join(lines)

    # -- running -----------------------------------------------------------------------------

    def run(self, until: float, writers: Sequence[Writer] = (), progress: Observer | None = None) -> None:
        """Step to a time.

        Parameters
        ----------
        until
            End time [s], after the present one.
        writers
            Asked at every step whether they are due.
        progress
            Told of every step.

        Raises
        ------
        InputError
            If the end lies before the start, or a writer can't write.
        RunError
            If a particle leaves the grid, turns over or is no longer a number, a load or condition is no
            longer one, or the disk is full.
        KeyboardInterrupt
            After Ctrl-C or SIGTERM (``Terminated``), once the step is finished and the files are closed.
        """
        for writer in writers:
            if not all(hasattr(writer, name) for name in ("trigger", "open", "write", "close")):
                raise InputError(f"run: {writer!r} is not a writer (History, VTKHDF, Recorder, ...)")
        if number("run: end time", until) <= self.time:
            raise InputError(f"run: end time {until!r} s must lie after the start, {self.time:g} s")
        run_steps(self, until, tuple(writers), progress)

    def advance(self, dt: float) -> None:
        """Make one step of length ``dt`` [s]."""
        engine = self.engine
        engine.dt = positive("advance: dt", dt)
        if engine.step % self.sort_every == 0 and engine.step > 0:
            self.sort()
        for stage in self.scheme.stages:
            stage.run(engine)
        engine.step += 1
        engine.time += dt
        self._note_fallen(f"in step {engine.step}")
        if engine.step % self.sample_every == 0:
            self.ledger.book(take_entry(engine))

    def book(self) -> None:
        """Take the present state into the ledger, if it is not there yet."""
        if self.ledger.latest.step != self.step:
            self.ledger.book(take_entry(self.engine))

    def sort(self) -> None:
        """Put the particles in order of cell; ids keep their meaning."""
        order = cell_order(self.engine.team, self.grid, self.particles.position)
        if order is None:
            return
        self.particles.permute(order, self.engine.team)
        self.engine.mapping.permute(order)
        self.engine.list_materials()

    @staticmethod
    def _held(setting: Setting, boundaries: Sequence[Condition]) -> np.ndarray:
        """The vertices that conditions make degrees of freedom."""
        held = []
        for place, condition in enumerate(boundaries):
            if isinstance(condition.where, Surface | Corners):
                with naming(f"boundary {place} ({type(condition).__name__})"):
                    held.append(setting.vertices_at(condition.where))
        return np.unique(np.concatenate(held)) if held else np.zeros(0, dtype=np.int64)

    def _note_fallen(self, when: str) -> None:
        """Keep one note of the domains that fell back so far; ``when`` is that of new ones."""
        fallen = self.fallen
        if len(fallen) == 0:
            return
        self._fell = self._fell or when
        ids = ", ".join(str(k) for k in fallen[:_FEW]) + (", ..." if len(fallen) > _FEW else "")
        what = "1 domain" if len(fallen) == 1 else f"{len(fallen)} domains"
        text = (
            f"on_inversion: {what} turned over and fell back to CPDI1, the first {self._fell}: particle {ids}"
        )
        if self._fallen in self.notes:
            self.notes.remove(self._fallen)
        self.notes.append(text)
        self._fallen = text

    def _first_step(self) -> float:
        limit = stable_step(self)
        if isinstance(self.timestep, FixedStep):
            dt = self.timestep.dt
            if dt > limit:
                text = f"time step: dt = {dt:.4g} s is over the stability limit of {limit:.4g} s"
                if not self.timestep.allow_unstable:
                    raise InputError(text + "; shorten it, or set allow_unstable = true to try")
                self.notes.append(text)
                warnings.warn(text, stacklevel=3)
            return dt
        dt = min(self.timestep.fraction * limit, self.timestep.largest)
        if dt == 0.0:
            raise InputError("time step: CFL finds no step above 0; velocities or wave speeds are too large")
        if not math.isfinite(dt):
            raise InputError("time step: CFL finds no limit (nothing has a wave speed or moves); give dt")
        return dt

    # -- restart -----------------------------------------------------------------------------

    def fingerprint(self) -> str:
        """Return a hash of what must agree between a checkpoint and the run that takes it up."""
        return hashlib.sha256(repr(identity(self)).encode()).hexdigest()

    def state_arrays(self) -> dict[str, np.ndarray]:
        """Return all arrays that a restart needs."""
        arrays = {f"particles.{name}": getattr(self.particles, name) for name in self.particles.fields}
        arrays |= {f"mapping.{name}": a for name, a in self.engine.mapping.state().items()}
        return arrays | {"external": self.engine.external}

    def state_scalars(self) -> dict[str, float]:
        """Return all numbers that a restart needs."""
        return {"time": self.time, "step": self.step, "dt": self.dt}

    def restore(self, arrays: dict[str, np.ndarray], scalars: dict[str, float]) -> None:
        """Take up a state that ``state_arrays`` and ``state_scalars`` gave.

        Raises
        ------
        InputError
            If an array is missing or has another shape.
        """
        for name, present in self.state_arrays().items():
            # Arrays of the mapping may have grown (domains that fell back).
            fits = name in arrays and (name.startswith("mapping.") or arrays[name].shape == present.shape)
            if not fits:
                raise InputError(f"restart: array {name} is missing or does not fit this case")
        for name in self.particles.fields:
            setattr(self.particles, name, np.array(arrays[f"particles.{name}"]))
        engine = self.engine
        engine.external[:] = arrays["external"]
        prefix = "mapping."
        engine.mapping.restore({k[len(prefix) :]: v for k, v in arrays.items() if k.startswith(prefix)})
        engine.list_materials()
        engine.time, engine.step, engine.dt = (
            float(scalars["time"]),
            int(scalars["step"]),
            float(scalars["dt"]),
        )
        self._fell = ""
        self._note_fallen(f"in or before step {engine.step}")
        entry = take_entry(engine)
        self.ledger = Ledger(entry, entry)

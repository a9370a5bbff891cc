"""The bi-material bar under its own weight (S, section 5.1, figures 2 to 5)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from matpoint.errors import InputError
from matpoint.problem import Announce, Problem, Result
from matpoint.problems.sampler import Sampler, relative
from matpoint.reference.bar import LayeredBar

if TYPE_CHECKING:
    from matpoint.interpolation import Interpolation
    from matpoint.output.history import Probe
    from matpoint.scheme import Scheme
    from matpoint.simulation import Simulation
    from matpoint.timestep import TimeStep

LENGTH, INTERFACE, CELL = 9.0, 4.5, 1.0  # [m]
PER_CELL = 2
STIFF, SOFT = 1e7, 5e6  # E1 = 2 E2 [Pa]
SAMPLE = 10  # steps between two samples of the histories


@dataclass(frozen=True, eq=False)
class Track:
    """What one run of the bar leaves, by a particle method or by finite elements.

    Attributes
    ----------
    times : ndarray, shape (t,)
        [s], from 0.
    tip : ndarray, shape (t,)
        Displacement of particle A [m].
    stress : ndarray, shape (t, n)
        Axial Cauchy stress [Pa] of all domains, from the free end up.
    centres : ndarray, shape (n,)
        Their initial positions [m].
    """

    times: np.ndarray
    tip: np.ndarray
    stress: np.ndarray
    centres: np.ndarray

    @property
    def sigma_b(self) -> np.ndarray:
        """Stress [Pa] of B, the lowest domain above the interface, shape (t,)."""
        return self.stress[:, len(self.centres) // 2]

    @property
    def sigma_c(self) -> np.ndarray:
        """Stress [Pa] of C, the highest domain below the interface, shape (t,)."""
        return self.stress[:, len(self.centres) // 2 - 1]

    def profile(self, time: float) -> np.ndarray:
        """Return the stresses [Pa] at the sample nearest to a time [s], shape (n,)."""
        return self.stress[int(np.argmin(np.abs(self.times - time)))]


@dataclass(frozen=True)
class BimaterialBar(Problem):
    """A bar of two materials, fixed at the top, that gravity pulls from t = 0 on.

    The paper does not give the cell size; it is 1 m here, 18 domains of half a cell, so that the
    interface lies in the middle of a cell. x points up, against gravity; the free end is x = 0.

    Parameters
    ----------
    stiff
        Where the stiff material is: ``"above"`` or ``"below"`` the interface.
    dim
        1, 2 or 3; in 2-D and 3-D the bar is one domain wide, between rollers.

    refine
        Cells per metre along the bar. Odd numbers keep the interface in the middle of a cell; even
        ones put it on a grid line, where every method sees it.

    Raises
    ------
    InputError
        If one of them is something else.
    """

    stiff: str = "above"
    dim: int = 1
    refine: int = 1

    name: ClassVar[str] = "bimaterial-bar"
    title: ClassVar[str] = "Vibration of a bi-material bar under its own weight"
    methods: ClassVar[tuple[str, ...]] = (
        "mpm", "ugimp", "cpgimp", "bspline2", "bspline3", "cpdi1", "cpdi2", "enriched-cpdi2", "fem",
    )  # fmt: skip
    norms: ClassVar[dict[str, str]] = {
        "tip": "displacement of the free end, A: L2 error over 0 <= t <= 0.5 s, relative to fem",
        "sigma_b": "stress above the interface, B: L2 error, relative to fem",
        "sigma_c": "stress below the interface, C: L2 error, relative to fem",
        "jump": "rms(sigma_B - sigma_C) over the largest |sigma_B| of fem",
    }
    end: ClassVar[float] = 0.5
    step: ClassVar[float] = 5e-5

    def __post_init__(self) -> None:
        if self.stiff not in ("above", "below"):
            raise InputError(f'{self.name}: stiff = {self.stiff!r}; "above" and "below" are allowed')
        if isinstance(self.dim, bool) or not isinstance(self.dim, int) or self.dim not in (1, 2, 3):
            raise InputError(f"{self.name}: dim = {self.dim!r}; 1, 2 and 3 are allowed")
        if isinstance(self.refine, bool) or not isinstance(self.refine, int) or self.refine < 1:
            raise InputError(f"{self.name}: refine = {self.refine!r} must be a whole number >= 1")

    @property
    def domains(self) -> int:
        """The number of particle domains along the bar."""
        return round(LENGTH / CELL) * PER_CELL * self.refine

    @property
    def bar(self) -> LayeredBar:
        """The data of the reference solutions."""
        lower, upper = (SOFT, STIFF) if self.stiff == "above" else (STIFF, SOFT)
        return LayeredBar(LENGTH, INTERFACE, lower, upper)

    @property
    def probes(self) -> tuple[Probe, ...]:
        """Particle A at the free end; B above and C below the interface."""
        from matpoint.output.history import Probe  # noqa: PLC0415 (keeps the import of a case light)

        half = 0.5 * LENGTH / self.domains
        across = (0.5,) * (self.dim - 1)
        return (
            Probe("A", (half, *across), "displacement", "x"),
            Probe("B", (INTERFACE + half, *across), "stress", "xx"),
            Probe("C", (INTERFACE - half, *across), "stress", "xx"),
        )

    def simulation(
        self,
        interpolation: Interpolation,
        *,
        scheme: Scheme | None = None,
        timestep: TimeStep | None = None,
        threads: int | None = None,
    ) -> Simulation:
        """Return the bar on its grid from x = -1 to 9 m, cells of 1 m / refine."""
        import matpoint as mp  # noqa: PLC0415 (keeps the import of a case light)

        bar, across = self.bar, self.dim - 1
        half = (self.domains // 2, *(1,) * across)
        low, high = (0.0,) * across, (1.0,) * across
        meshes = (
            mp.mesh_box((0.0, *low), (INTERFACE, *high), half),
            mp.mesh_box((INTERFACE, *low), (LENGTH, *high), half),
        )
        bodies = [
            mp.Body(mesh, mp.NeoHookean(E=young, nu=bar.poisson, density=bar.density), name=name)
            for mesh, young, name in zip(meshes, (bar.lower, bar.upper), ("lower", "upper"), strict=True)
        ]
        walls = [mp.Roller(mp.Plane(axis, at)) for axis in (1, 2)[:across] for at in (0.0, 1.0)]
        return mp.Simulation(
            mp.Grid((-CELL, *low), (LENGTH, *high), (CELL / self.refine, *high)),
            bodies,
            interpolation=interpolation,
            scheme=scheme,
            boundaries=[mp.Fixed(mp.Plane("x", LENGTH)), *walls],
            loads=[mp.Gravity((bar.gravity,))],
            timestep=mp.FixedStep(self.step) if timestep is None else timestep,
            threads=threads,
        )

    def track(self, interpolation: Interpolation, end: float | None = None, **choices: Any) -> Track:
        """Run a particle method and return its histories.

        Parameters
        ----------
        interpolation
            The method.
        end
            [s]; None takes the problem's own.
        choices
            For :meth:`simulation`; one thread unless told otherwise (few particles).
        """
        sim = self.simulation(interpolation, **{"threads": 1, **choices})
        centres = sim.particles.ordered("position0")[:, 0]
        free_end = int(np.argmin(centres))

        def sample(sim: Simulation) -> np.ndarray:
            tip = sim.particles.ordered("position")[free_end, 0] - centres[free_end]
            return np.array([tip, *sim.particles.ordered("stress")[:, 0]])

        sampler = Sampler(SAMPLE, sample)
        sim.run(self.end if end is None else end, writers=[sampler])
        values = sampler.values
        return Track(sampler.times, values[:, 0], values[:, 1:], centres)

    def reference(self, end: float | None = None) -> Track:
        """Run the finite elements: one for each domain, with the same time step."""
        from matpoint.reference.fem_bar import fem_bar  # noqa: PLC0415 (loads scikit-fem)

        end = self.end if end is None else end
        run = fem_bar(self.bar, end=end, step=self.step, elements=self.domains, every=SAMPLE)
        return Track(run.times, run.at(run.centres[0]), run.stress, run.centres)

    def verify(
        self,
        methods: Sequence[str] | None = None,
        out: Path | None = None,
        progress: Announce | None = None,
    ) -> Result:
        """Run methods and finite elements; into ``out`` go the paper's figures 3, 4, 5 and a CSV file."""
        from matpoint.interpolation import METHODS  # noqa: PLC0415 (compiles)

        names = self.chosen(methods)
        fem = self.reference()
        tracks: dict[str, Track] = {}
        for number, name in enumerate(names):
            if progress is not None:
                progress(name, number, len(names))
            tracks[name] = fem if name == "fem" else self.track(METHODS[name])
        if out is not None:
            from matpoint.problems.bar_figures import write_bar  # noqa: PLC0415 (loads matplotlib)

            write_bar(self, tracks, fem, out)
        return {name: measure(track, fem) for name, track in tracks.items()}


def measure(track: Track, fem: Track) -> dict[str, float]:
    """Return the norms ``tip``, ``sigma_b``, ``sigma_c``, ``jump`` of a run against finite elements."""
    rms = float(np.sqrt(np.mean((track.sigma_b - track.sigma_c) ** 2)))
    return {
        "tip": relative(track.tip, fem.tip),
        "sigma_b": relative(track.sigma_b, fem.sigma_b),
        "sigma_c": relative(track.sigma_c, fem.sigma_c),
        "jump": rms / float(np.abs(fem.sigma_b).max()),
    }

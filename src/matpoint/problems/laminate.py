"""A laminate of layers much thinner than a cell: effective moduli."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from matpoint.checks import number, positive
from matpoint.errors import InputError
from matpoint.problem import Announce, Problem, Result
from matpoint.reference.laminate import Layers

if TYPE_CHECKING:
    from matpoint.boundary import Condition
    from matpoint.interpolation import Interpolation
    from matpoint.output.history import Probe
    from matpoint.scheme import Scheme
    from matpoint.simulation import Simulation
    from matpoint.timestep import TimeStep

CELL, COUNT, WIDTH = 1.0, 10, 3.0  # cell [m], layers in its height, width of the laminate [m]
SOFT, POISSON, DENSITY = 1e6, 0.3, 1000.0
STRAIN, RAMP, DAMPING = 1e-4, 0.15, 175.0  # [-], [s], [1/s]: critical for the slowest mode, shear
#: Load -> component of the stress (xx, yy, zz, xy), and place of the strain in F.
COMPONENTS: dict[str, tuple[int, tuple[int, int]]] = {
    "normal": (1, (1, 1)),
    "shear": (3, (0, 1)),
    "in_plane": (0, (0, 0)),
}


@dataclass(frozen=True, eq=False)
class Strained:
    """What one method gives for one load, at rest.

    Attributes
    ----------
    modulus : float
        Mean stress over mean strain [Pa].
    height : ndarray, shape (n,)
        Middles of the domains over the lower face, in thicknesses of the laminate.
    stress, strain : ndarray, shape (n,)
        Of the domains: the component that the load drives [Pa], [-].
    """

    modulus: float
    height: np.ndarray
    stress: np.ndarray
    strain: np.ndarray


def ramp_velocity(change: float, time: float) -> float:
    """Return the velocity that makes a change smoothly over the ramp, and none afterwards."""
    return 0.0 if time >= RAMP else change / RAMP * (1.0 - np.cos(2 * np.pi * time / RAMP))


@dataclass(frozen=True)
class Laminate(Problem):
    """Ten bonded layers, soft and stiff in turn, that together are as thick as one cell.

    They are strained slowly, damped to rest, and compared with the exact averages of the layers: pulled
    across the layers between lateral rollers, sheared along them, and pulled along them with free faces.
    Lower and upper face follow no line of the grid.

    Parameters
    ----------
    load
        What a single run does: ``"normal"``, ``"shear"`` or ``"in_plane"``; ``verify`` does all three.
    contrast
        Young's modulus of the stiff layers over that of the soft ones, 1e6 Pa.
    offset
        Where in its cell the lower face lies, from 0 to 1.
    per_layer
        Domains across a layer. With more than one, ``verify`` enriches the vertices inside the layers too
        (``layers = per_layer // 2``). Without, two a layer still give moduli within 0.3 %, but stresses
        that differ by up to 12 % within a layer.

    Raises
    ------
    InputError
        If one of them is something else.
    """

    load: str = "normal"
    contrast: float = 100.0
    offset: float = 0.3
    per_layer: int = 1

    name: ClassVar[str] = "laminate"
    title: ClassVar[str] = "Effective moduli of a laminate with layers thinner than a cell"
    methods: ClassVar[tuple[str, ...]] = ("cpdi2", "enriched-cpdi2", "fem")
    norms: ClassVar[dict[str, str]] = {
        "normal": "modulus across the layers, sides held: relative error against 1/<1/M>",
        "shear": "shear modulus along the layers: relative error against 1/<1/G>",
        "in_plane": "modulus along the layers, faces free: relative error against <E/(1 - nu^2)>",
    }
    end: ClassVar[float] = 0.4
    step: ClassVar[float] = 1.5e-4

    def __post_init__(self) -> None:
        if self.load not in tuple(COMPONENTS):
            raise InputError(f"{self.name}: load = {self.load!r}; {', '.join(COMPONENTS)} are allowed")
        positive(f"{self.name}: contrast", self.contrast)
        if not 0 <= number(f"{self.name}: offset", self.offset) < 1:
            raise InputError(f"{self.name}: offset = {self.offset!r} must be from 0 to below 1")
        if isinstance(self.per_layer, bool) or not isinstance(self.per_layer, int) or self.per_layer < 1:
            raise InputError(f"{self.name}: per_layer = {self.per_layer!r} must be a whole number >= 1")

    @property
    def layers(self) -> Layers:
        """The data of the exact solution."""
        young = tuple(SOFT * (self.contrast if k % 2 else 1.0) for k in range(COUNT))
        return Layers((CELL / COUNT,) * COUNT, young, POISSON)

    @property
    def probes(self) -> tuple[Probe, ...]:
        """A soft and a stiff layer in the middle."""
        from matpoint.output.history import Probe  # noqa: PLC0415 (keeps the import of a case light)

        component = {"normal": "yy", "shear": "xy", "in_plane": "xx"}[self.load]
        low = self.offset * CELL
        places = (("soft", low + 0.45 * CELL), ("stiff", low + 0.55 * CELL))
        return tuple(Probe(name, (WIDTH / 2, y), "stress", component) for name, y in places)

    def simulation(
        self,
        interpolation: Interpolation,
        *,
        scheme: Scheme | None = None,
        timestep: TimeStep | None = None,
        threads: int | None = None,
    ) -> Simulation:
        """Return the laminate, three cells wide, under its load."""
        import matpoint as mp  # noqa: PLC0415 (keeps the import of a case light)

        low, layers = self.offset * CELL, self.layers
        edges = low + np.concatenate([[0.0], np.cumsum(layers.thickness)])
        wide = round(WIDTH * COUNT / CELL)
        bodies = [
            mp.Body(
                mp.mesh_box((0.0, edges[k]), (WIDTH, edges[k + 1]), (wide, self.per_layer)),
                mp.NeoHookean(E=layers.young[k], nu=POISSON, density=DENSITY),
                name=f"layer-{k}",
            )
            for k in range(COUNT)
        ]
        return mp.Simulation(
            mp.Grid((-CELL, -CELL), (WIDTH + CELL, 3 * CELL), CELL),
            bodies,
            interpolation=interpolation,
            scheme=scheme,
            timestep=mp.FixedStep(self.step / self.per_layer) if timestep is None else timestep,
            boundaries=self._conditions(),
            damping=mp.MassDamping(DAMPING),
            threads=threads,
        )

    def _conditions(self) -> list[Condition]:
        import matpoint as mp  # noqa: PLC0415 (keeps the import of a case light)

        ends = [mp.Plane("x", at, side) for at, side in ((0.0, "lower"), (WIDTH, "upper"))]
        below, above = mp.Surface("y-"), mp.Surface("y+")
        if self.load == "in_plane":

            def stretch(x: np.ndarray, time: float) -> np.ndarray:
                return np.full(len(x), ramp_velocity(STRAIN * WIDTH, time))

            drive = mp.PrescribedVelocity(ends[1], (stretch, None))
            return [mp.Roller(ends[0]), mp.Roller(below, (0.0, 1.0)), drive]

        def lift(x: np.ndarray, time: float) -> np.ndarray:
            return np.full(len(x), ramp_velocity(STRAIN * CELL, time))

        if self.load == "normal":
            return [*map(mp.Roller, ends), mp.Fixed(below), mp.PrescribedVelocity(above, (0.0, lift))]
        sides = [mp.Roller(end, (0.0, 1.0)) for end in ends]
        return [*sides, mp.Fixed(below), mp.PrescribedVelocity(above, (lift, 0.0))]

    def strained(self, interpolation: Interpolation) -> Strained:
        """Run a method to rest under this problem's load."""
        sim = self.simulation(interpolation, threads=1)
        sim.run(self.end)
        p, (component, place) = sim.particles, COMPONENTS[self.load]
        F = p.ordered("deformation_gradient")[(slice(None), *place)]
        height = p.ordered("position0")[:, 1] / CELL - self.offset
        stress = p.ordered("stress")[:, component]
        mean = float(np.average(stress, weights=p.ordered("volume")))
        return Strained(mean / STRAIN, height, stress, F - float(place[0] == place[1]))

    def verify(
        self,
        methods: Sequence[str] | None = None,
        out: Path | None = None,
        progress: Announce | None = None,
    ) -> Result:
        """Strain the laminate by each method in all three ways; ``out`` gets profiles and moduli."""
        from matpoint.interpolation import METHODS, EnrichedCPDI2  # noqa: PLC0415 (compiles)
        from matpoint.problems.laminate_fem import strained_fem  # noqa: PLC0415 (loads scikit-fem)

        names = self.chosen(methods)
        runs: dict[str, dict[str, Strained]] = {}
        for number_, name in enumerate(names):
            if progress is not None:
                progress(name, number_, len(names))
            cases = {load: replace(self, load=load) for load in COMPONENTS}
            if name == "fem":
                runs[name] = {load: strained_fem(case) for load, case in cases.items()}
                continue
            deep = name == "enriched-cpdi2"
            method = EnrichedCPDI2(layers=self.per_layer // 2) if deep else METHODS[name]
            runs[name] = {load: case.strained(method) for load, case in cases.items()}
        if out is not None:
            from matpoint.problems.laminate_figures import write_laminate  # noqa: PLC0415 (loads matplotlib)

            write_laminate(self, runs, out)
        exact = {load: self.layers.modulus(load) for load in COMPONENTS}
        return {
            name: {load: abs(run.modulus / exact[load] - 1.0) for load, run in loads.items()}
            for name, loads in runs.items()
        }

"""A block of two materials sheared to an angle of 45 degrees and turned by 90: large deformation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from matpoint.checks import positive
from matpoint.errors import InputError
from matpoint.problem import Announce, Problem, Result
from matpoint.problems.block_motion import FaceMotion

if TYPE_CHECKING:
    from matpoint.interpolation import Interpolation
    from matpoint.output.history import Probe
    from matpoint.scheme import Scheme
    from matpoint.simulation import Simulation
    from matpoint.timestep import TimeStep

SIZE, SOFT, POISSON, DENSITY = 1.0, 1e6, 0.3, 1000.0  # [m], [Pa], [-], [kg/m^3]
SAMPLE = 25  # steps between two samples of the histories
SHEARED, TURNED = 1.0, 2.0  # ends of shearing and of turning [s]


@dataclass(eq=False)
class BlockTrack:
    """What one run of the block leaves, by a particle method or by finite elements.

    Attributes
    ----------
    times : list of float
        [s], from 0.
    below, above : list of ndarray, shape (2,)
        Traction across the interface in axes that turn with the faces: along, normal [Pa]; means over the
        row of domains on either side.
    energy : float
        Largest drift of kinetic plus strain energy less external work, over the largest work.
    gap : float
        Largest distance between F by corner positions and F by rates.
    warp : float
        Largest distance of a corner from the affine image of its domain, over the shortest edge.
    shapes : list of tuple
        Corners of all domains (n, 4, 2) [m] at the end of shearing and of turning, and their shear stress
        in the turned axes (n,) [Pa].
    """

    times: list[float] = field(default_factory=list)
    below: list[np.ndarray] = field(default_factory=list)
    above: list[np.ndarray] = field(default_factory=list)
    energy: float = 0.0
    gap: float = 0.0
    warp: float = 0.0
    shapes: list[tuple[np.ndarray, np.ndarray]] = field(default_factory=list)

    @property
    def interface(self) -> np.ndarray:
        """Traction along and normal to the interface [Pa], mean of both sides, shape (t, 2)."""
        return 0.5 * (np.array(self.below) + np.array(self.above))


@dataclass(frozen=True)
class ShearedBlock(Problem):
    """A square block, the lower half soft, whose faces are driven.

    They shear it to an angle of 45 degrees in 1 s, and turn it by 90 in another second; the interface
    lies in the middle of a cell, also after the turn. No damping: the balance of energy is the run's own.
    With free sides the stress is singular in the corners, and domains there turn over: ``verify`` lets
    them fall back to CPDI1.

    Parameters
    ----------
    contrast
        Young's modulus of the upper half over that of the lower, 1e6 Pa.
    cells
        Cells along a side, an odd number; two domains a cell.
    sides
        ``"driven"``: left and right face follow the motion too; ``"free"``: only lower and upper face do.
    layers, hourglass
        Of enriched CPDI2 in ``verify``, as in ``EnrichedCPDI2``.

    Raises
    ------
    InputError
        If one of them is something else.
    """

    contrast: float = 10.0
    cells: int = 9
    sides: str = "driven"
    layers: int = 0
    hourglass: float = 0.0

    name: ClassVar[str] = "sheared-block"
    title: ClassVar[str] = "A bi-material block sheared by 45 degrees and turned by 90"
    methods: ClassVar[tuple[str, ...]] = ("cpdi2", "enriched-cpdi2", "fem")
    norms: ClassVar[dict[str, str]] = {
        "energy": "largest drift of kinetic + strain energy - external work, over the largest work",
        "sigma": "shear stress of the interface, in axes turned with the block: L2 error, relative to fem",
        "jump": "rms of the jump of the traction across the interface over the peak traction of fem",
        "gap": "largest |F by corner positions - F by rates|",
        "warp": "largest distance of a corner from its domain's affine image, over an edge: hourglassing",
    }
    end: ClassVar[float] = 2.0
    step: ClassVar[float] = 2e-4

    def __post_init__(self) -> None:
        from matpoint.interpolation import EnrichedCPDI2  # noqa: PLC0415 (compiles)

        positive(f"{self.name}: contrast", self.contrast)
        if isinstance(self.cells, bool) or not isinstance(self.cells, int) or self.cells < 1:
            raise InputError(f"{self.name}: cells = {self.cells!r} must be an odd whole number >= 1")
        if self.cells % 2 == 0:
            raise InputError(f"{self.name}: cells = {self.cells} is even: the interface would lie on a line")
        if self.sides not in ("driven", "free"):
            raise InputError(f'{self.name}: sides = {self.sides!r}; "driven" and "free" are allowed')
        EnrichedCPDI2(layers=self.layers, hourglass=self.hourglass)

    @property
    def motion(self) -> FaceMotion:
        """The motion of the driven faces."""
        middle = 0.5 * SIZE
        return FaceMotion((middle, middle), SIZE, self.contrast, 1.0, 0.5 * np.pi, SHEARED, TURNED)

    @property
    def faces(self) -> tuple[str, ...]:
        """Names of the boundary sets that are driven."""
        return ("y-", "y+", "x-", "x+") if self.sides == "driven" else ("y-", "y+")

    @property
    def probes(self) -> tuple[Probe, ...]:
        """The domains above and below the middle of the interface."""
        from matpoint.output.history import Probe  # noqa: PLC0415 (keeps the import of a case light)

        quarter = 0.25 * SIZE / self.cells
        places = (("above", quarter), ("below", -quarter))
        middle = 0.5 * SIZE
        return tuple(Probe(n, (middle + quarter, middle + d), "stress", "xy") for n, d in places)

    def simulation(
        self,
        interpolation: Interpolation,
        *,
        scheme: Scheme | None = None,
        timestep: TimeStep | None = None,
        threads: int | None = None,
    ) -> Simulation:
        """Return the block in a box that the sheared and turned block fits in."""
        import matpoint as mp  # noqa: PLC0415 (keeps the import of a case light)

        timestep = mp.FixedStep(self.step) if timestep is None else timestep
        step = getattr(timestep, "dt", self.step)  # CFL has none; its path is then exact to a step
        middle, cell = 0.5 * SIZE, SIZE / self.cells
        bodies = [
            mp.Body(
                mp.mesh_box((0.0, low), (SIZE, low + middle), (2 * self.cells, self.cells)),
                mp.NeoHookean(E=young, nu=POISSON, density=DENSITY),
                name=name,
            )
            for name, low, young in (("lower", 0.0, SOFT), ("upper", middle, SOFT * self.contrast))
        ]
        drive = (self.motion.velocity(0, step), self.motion.velocity(1, step))
        reach = (int(0.8 * self.cells) + 1) * cell  # whole cells: lines keep half a cell from the middle
        return mp.Simulation(
            mp.Grid((-reach, -reach), (SIZE + reach, SIZE + reach), cell),
            bodies,
            interpolation=interpolation,
            scheme=scheme,
            timestep=timestep,
            boundaries=[mp.PrescribedVelocity(mp.Surface(face), drive) for face in self.faces],
            threads=threads,
        )

    def verify(
        self,
        methods: Sequence[str] | None = None,
        out: Path | None = None,
        progress: Announce | None = None,
    ) -> Result:
        """Run methods and finite elements; ``out`` gets the block's shapes and the stress histories."""
        from matpoint.interpolation import CPDI2, EnrichedCPDI2  # noqa: PLC0415 (compiles)
        from matpoint.problems.block_runs import fem_track, track  # noqa: PLC0415 (loads scikit-fem)

        names = self.chosen(methods)
        fem = fem_track(self)
        policy = "stop" if self.sides == "driven" else "cpdi1"
        chosen = {
            "cpdi2": CPDI2(policy),
            "enriched-cpdi2": EnrichedCPDI2(self.layers, on_inversion=policy, hourglass=self.hourglass),
        }
        tracks: dict[str, BlockTrack] = {}
        for number, name in enumerate(names):
            if progress is not None:
                progress(name, number, len(names))
            tracks[name] = fem if name == "fem" else track(self, chosen[name])
        if out is not None:
            from matpoint.problems.block_figures import write_block  # noqa: PLC0415 (loads matplotlib)

            write_block(self, tracks, fem, out)
        return {name: measure(track, fem) for name, track in tracks.items()}


def measure(run: BlockTrack, fem: BlockTrack) -> dict[str, float]:
    """Return the norms of a run against finite elements, by their names."""
    shear, exact = run.interface[:, 0], fem.interface[:, 0]
    jump = np.linalg.norm(np.array(run.above) - np.array(run.below), axis=1)
    return {
        "energy": run.energy,
        "sigma": float(np.linalg.norm(shear - exact) / np.linalg.norm(exact)),
        "jump": float(np.sqrt(np.mean(jump**2)) / np.linalg.norm(fem.interface, axis=1).max()),
        "gap": run.gap,
        "warp": run.warp,
    }

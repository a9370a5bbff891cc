"""Each stage of a step, for an interpolation of each family, in three dimensions on one thread."""

from __future__ import annotations

from matpoint import USL, FixedStep, Simulation
from matpoint.bench.block import METHODS, block, cells_for

PARTICLES = 50_000
STAGES = tuple(stage.name for stage in USL().stages)
INTERPOLATIONS = ("linear", "bspline2", "cpgimp", "cpdi2", "imls-1-point")


def simulation(method: str, particles: int) -> Simulation:
    """Return the benchmark's block after two steps."""
    cells = cells_for(particles, 3)
    grid, body, gravity, dt = block(3, cells)
    made = Simulation(
        grid,
        [body],
        interpolation=METHODS[method](3, cells),
        timestep=FixedStep(dt),
        loads=[gravity],
        threads=1,
    )
    made.advance(dt)
    made.advance(dt)
    return made


class Stages:
    """A stage alone, again and again. What it reads is that of a whole step made just before."""

    params = (INTERPOLATIONS, STAGES)
    param_names = ("interpolation", "stage")
    particles = PARTICLES
    # Repeated on its own output a stage sees other numbers, but the same work; set up anew for each sample.
    number, repeat, timeout = 3, 5, 300.0

    def setup(self, interpolation: str, stage: str) -> None:
        self.simulation = simulation(interpolation, self.particles)
        self.stage = next(s for s in self.simulation.scheme.stages if s.name == stage)

    def time_stage(self, interpolation: str, stage: str) -> None:
        self.stage.run(self.simulation.engine)


class Steps:
    """Whole steps, sorting and ledger included."""

    params = (INTERPOLATIONS,)
    param_names = ("interpolation",)
    particles = PARTICLES
    number, repeat, timeout = 1, 5, 300.0

    def setup(self, interpolation: str) -> None:
        self.simulation = simulation(interpolation, self.particles)

    def time_ten_steps(self, interpolation: str) -> None:
        for _ in range(10):
            self.simulation.advance(self.simulation.dt)

    def peakmem_setup(self, interpolation: str) -> None:
        """Memory of the process with the block in it."""

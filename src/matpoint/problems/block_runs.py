"""Runs of the sheared block: by particle methods, and by finite elements on the same mesh."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from matpoint.meshes import mesh_box
from matpoint.output.triggers import EverySteps
from matpoint.problems.sheared_block import (
    DENSITY,
    POISSON,
    SAMPLE,
    SHEARED,
    SIZE,
    SOFT,
    TURNED,
    BlockTrack,
    ShearedBlock,
)
from matpoint.reference.explicit import run_explicit
from matpoint.reference.laminate import Layers
from matpoint.reference.prescribed import Prescribed
from matpoint.reference.solid import Solid

if TYPE_CHECKING:
    from matpoint.interpolation import Interpolation
    from matpoint.simulation import Simulation

_SHAPE_TIMES = (SHEARED, TURNED)


def tractions(stress: np.ndarray, axes: np.ndarray) -> np.ndarray:
    """Return tractions (n, 2) across the second of two axes (2, 2), of stresses (n, 6)."""
    sigma = stress[:, [[0, 3], [3, 1]]]
    return np.einsum("nab,ia,b->ni", sigma, axes, axes[1])


class _Watch:
    """Takes tractions, energies, hourglassing and, at two times, all domains."""

    def __init__(self, problem: ShearedBlock, rows: tuple[np.ndarray, np.ndarray]) -> None:
        self.trigger = EverySteps(SAMPLE)
        self._motion, self.rows, self.track = problem.motion, rows, BlockTrack()
        self._energies: list[tuple[float, float]] = []

    def open(self, sim: Simulation) -> None:
        """Nothing is needed before the first sample."""

    def write(self, sim: Simulation) -> None:
        """Take a sample."""
        t, stress = self.track, sim.particles.ordered("stress")
        across = tractions(stress, self._motion.axes(sim.time))
        t.times.append(sim.time)
        t.below.append(across[self.rows[0]].mean(axis=0))
        t.above.append(across[self.rows[1]].mean(axis=0))
        self._energies.append((sim.quantity("total_energy"), sim.quantity("external_work")))
        t.gap = max(t.gap, sim.quantity("domain_gap"))
        t.warp = max(t.warp, sim.quantity("largest_warp"))
        if any(abs(sim.time - at) < 0.5 * sim.dt for at in _SHAPE_TIMES) and sim.vertices is not None:
            order = np.argsort(sim.particles.id)
            corners = sim.vertices.position[sim.vertices.connectivity[order], :2]
            t.shapes.append((corners, across[:, 0]))

    def close(self, sim: Simulation, error: BaseException | None) -> None:
        """Put the energies together."""
        self.track.energy = _drift(*np.array(self._energies).T)


def _drift(total: np.ndarray, work: np.ndarray) -> float:
    return float(np.abs(total - total[0]).max() / np.abs(work).max())


def _rows(y: np.ndarray, problem: ShearedBlock) -> tuple[np.ndarray, np.ndarray]:
    """Return the domains in the rows below and above the interface, of their middles [m]."""
    quarter, middle = 0.25 * SIZE / problem.cells, 0.5 * SIZE
    below, above = (
        np.flatnonzero(np.abs(y - middle - side * quarter) < 0.5 * quarter) for side in (-1.0, 1.0)
    )
    return below, above


def track(problem: ShearedBlock, interpolation: Interpolation) -> BlockTrack:
    """Run a particle method and return its histories."""
    sim = problem.simulation(interpolation, threads=1)
    watch = _Watch(problem, _rows(sim.particles.ordered("position0")[:, 1], problem))
    sim.run(problem.end, writers=[watch])
    return watch.track


def fem_track(problem: ShearedBlock) -> BlockTrack:
    """Run the finite elements: one for each domain, the same driven faces and time step."""
    mesh = mesh_box((0.0, 0.0), (SIZE, SIZE), (2 * problem.cells, 2 * problem.cells))
    x = mesh.vertices
    middle = x[mesh.cells, 1].mean(axis=1)
    material = Layers((1.0, 1.0), (SOFT, SOFT * problem.contrast), POISSON)
    half = (middle > 0.5 * SIZE).astype(int)
    solid = Solid(x, mesh.cells, "quad", material.lame[half], material.rigidity[half], DENSITY)
    motion = problem.motion
    held = np.unique(np.concatenate([mesh.sets[face] for face in problem.faces]))
    run = run_explicit(
        solid,
        step=problem.step,
        steps=round(problem.end / problem.step),
        every=SAMPLE,
        prescribed=[Prescribed(held, axis, motion.velocity(axis, problem.step)) for axis in (0, 1)],
    )
    across = [tractions(s, motion.axes(t)) for s, t in zip(run.stress, run.times, strict=True)]
    below, above = _rows(middle, problem)
    shapes = []
    for at in _SHAPE_TIMES:
        n = int(np.argmin(np.abs(run.times - at)))
        shapes.append(((x[:, :2] + run.displacement[n])[mesh.cells], across[n][:, 0]))
    return BlockTrack(
        times=run.times.tolist(),
        below=[s[below].mean(axis=0) for s in across],
        above=[s[above].mean(axis=0) for s in across],
        energy=_drift(run.kinetic + run.strain - run.work, run.work),
        shapes=shapes,
    )

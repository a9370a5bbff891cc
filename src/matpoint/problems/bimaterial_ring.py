"""The bi-material ring under centrifugal force (S, section 5.2, figures 6 to 8)."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from matpoint.checks import positive
from matpoint.errors import InputError
from matpoint.problem import Announce, Problem, Result
from matpoint.problems.ring_track import RingTrack, inner_point, nearest, radial_stress
from matpoint.problems.sampler import Sampler, relative
from matpoint.reference.ring import LayeredRing

if TYPE_CHECKING:
    from matpoint.domains import Domains
    from matpoint.interpolation import Interpolation
    from matpoint.output.history import Probe
    from matpoint.reference.radial import RadialHistory
    from matpoint.scheme import Scheme
    from matpoint.simulation import Simulation
    from matpoint.timestep import TimeStep

INNER, INTERFACE, OUTER = 3.0, 3.1, 3.2  # [m]
STIFF, SOFT, POISSON, DENSITY, OMEGA = 1e9, 5e8, 0.3, 1000.0, 1.0
AROUND, AT_LAYERS = 193, 8  # the paper's 1544 domains
PER_CELL = 2
SAMPLES = 500  # of a history


@dataclass(frozen=True)
class BimaterialRing(Problem):
    """A quarter of a ring of two materials that begins to turn at t = 0, in its rotating frame.

    Radial stress is a hundredth of hoop stress, so that it is hard to get right. The paper gives neither
    the radius of the interface nor the cell size; here 3.1 m, and two domains per cell across the ring.

    Parameters
    ----------
    stiff
        Which part is stiff: ``"inner"`` or ``"outer"``.
    layers
        Domains across the ring, an even number; 8 are the paper's 1544 domains.
    dim
        2 (plane strain), or 3: one layer of hexahedra between rollers.
    dt
        Time step [s] where none is given; the paper's is 1e-6.

    Raises
    ------
    InputError
        If one of them is something else.
    """

    stiff: str = "inner"
    layers: int = 8
    dim: int = 2
    dt: float = 1e-6

    name: ClassVar[str] = "bimaterial-ring"
    title: ClassVar[str] = "Bi-material ring under centrifugal force"
    methods: ClassVar[tuple[str, ...]] = (
        "mpm", "ugimp", "cpgimp", "bspline2", "bspline3", "cpdi1", "cpdi2", "enriched-cpdi2", "fem",
    )  # fmt: skip
    norms: ClassVar[dict[str, str]] = {
        "displacement": "of the inner face at 45 degrees: L2 error over 0 <= t <= 0.02 s, relative",
        "sigma_b": "radial stress inside the interface, mean over 12 degrees: L2 error, relative",
        "sigma_c": "radial stress outside the interface, mean over 12 degrees: L2 error, relative",
        "jump": "rms(sigma_B - sigma_C) of the two domains at 45 degrees over the largest |sigma_r|",
        "scatter": "rms of sigma_B less its mean over the angle, over the largest |sigma_r|",
        "jump_all": "rms(sigma_B - sigma_C) over all pairs of the interface, over the largest |sigma_r|",
        "sigma_one": "larger of the relative L2 errors of the two single domains at 45 degrees",
    }
    end: ClassVar[float] = 0.02
    step: ClassVar[float] = 1e-6

    def __post_init__(self) -> None:
        positive(f"{self.name}: dt", self.dt)
        if self.stiff not in ("inner", "outer"):
            raise InputError(f'{self.name}: stiff = {self.stiff!r}; "inner" and "outer" are allowed')
        whole = isinstance(self.layers, int) and not isinstance(self.layers, bool)
        if not whole or self.layers < 2 or self.layers % 2:
            raise InputError(f"{self.name}: layers = {self.layers!r} must be an even number >= 2")
        if isinstance(self.dim, bool) or self.dim not in (2, 3) or not isinstance(self.dim, int):
            raise InputError(f"{self.name}: dim = {self.dim!r}; 2 and 3 are allowed")

    # -- what it is --------------------------------------------------------------------------

    @property
    def around(self) -> int:
        """Domains along the quarter of the circle."""
        return round(AROUND * self.layers / AT_LAYERS)

    @property
    def cell(self) -> float:
        """Cell size [m]."""
        return PER_CELL * (OUTER - INNER) / self.layers

    @property
    def ring(self) -> LayeredRing:
        """The data of the reference solutions."""
        youngs = (STIFF, SOFT) if self.stiff == "inner" else (SOFT, STIFF)
        return LayeredRing((INNER, INTERFACE, OUTER), youngs, (POISSON,) * 2, (DENSITY,) * 2, OMEGA)

    def meshes(self) -> list[Domains]:
        """Return the domains of the inner and of the outer part."""
        from matpoint.meshes import extrude, mesh_annulus  # noqa: PLC0415 (keeps the import of a case light)

        divisions = (self.layers // 2, self.around)
        parts = [mesh_annulus(a, b, divisions) for a, b in ((INNER, INTERFACE), (INTERFACE, OUTER))]
        return parts if self.dim == 2 else [extrude(part, (0.0, self.cell)) for part in parts]

    @property
    def probes(self) -> tuple[Probe, ...]:
        """Particle A at the inner face, B and C inside and outside the interface, all at 45 degrees."""
        from matpoint.output.history import Probe  # noqa: PLC0415 (keeps the import of a case light)

        half = 0.5 * (OUTER - INNER) / self.layers
        places = {"A": INNER + half, "B": INTERFACE - half, "C": INTERFACE + half}
        probes = []
        for name, r in places.items():
            at = (r * math.sqrt(0.5),) * 2 + (0.5 * self.cell,) * (self.dim - 2)
            field, parts = ("displacement", "xy") if name == "A" else ("stress", ("xx", "yy", "xy"))
            probes += [Probe(name, at, field, part) for part in parts]
        return tuple(probes)

    def simulation(
        self,
        interpolation: Interpolation,
        *,
        scheme: Scheme | None = None,
        timestep: TimeStep | None = None,
        threads: int | None = None,
    ) -> Simulation:
        """Return the ring on its grid from the origin to beyond 3.2 m."""
        import matpoint as mp  # noqa: PLC0415 (keeps the import of a case light)

        ring, thick = self.ring, (self.cell,) * (self.dim - 2)
        bodies = [
            mp.Body(mesh, mp.NeoHookean(E=young, nu=POISSON, density=DENSITY), name=name)
            for mesh, young, name in zip(self.meshes(), ring.youngs, ("inner", "outer"), strict=True)
        ]
        side = self.cell * math.ceil(OUTER / self.cell + 1)
        walls = [mp.Roller(mp.Plane("z", at)) for z in thick for at in (0.0, z)]
        in_plane = np.array([1.0, 1.0, 0.0]) * OMEGA**2
        return mp.Simulation(
            mp.Grid((0.0,) * self.dim, (side, side, *thick), self.cell),
            bodies,
            interpolation=interpolation,
            scheme=scheme,
            boundaries=[mp.Symmetry(mp.Plane("x", 0.0)), mp.Symmetry(mp.Plane("y", 0.0)), *walls],
            loads=[mp.BodyForce(lambda X, x, t: in_plane * x)],
            timestep=mp.FixedStep(self.dt) if timestep is None else timestep,
            threads=threads,
        )

    # -- runs --------------------------------------------------------------------------------

    def track(
        self,
        interpolation: Interpolation,
        *,
        step: float | None = None,
        end: float | None = None,
        **choices: Any,
    ) -> RingTrack:
        """Run a particle method and return its histories.

        Parameters
        ----------
        interpolation
            The method.
        step, end
            [s]; None takes the problem's own.
        choices
            For :meth:`simulation`.
        """
        from matpoint.timestep import FixedStep  # noqa: PLC0415 (keeps the import of a case light)

        step, end = step or self.dt, end or self.end
        sim = self.simulation(interpolation, timestep=FixedStep(step), **choices)
        place, radius = inner_point(sim, INNER)
        rows = self.rows
        x = sim.particles.ordered("position0")[rows]

        def sample(sim: Simulation) -> np.ndarray:
            return np.array([place(sim), *radial_stress(sim.particles.ordered("stress")[rows], x)])

        sampler = Sampler(_every(end, step), sample)
        sim.run(end, writers=[sampler])
        values = sampler.values
        b, c = np.split(values[:, 1:], 2, axis=1)
        return RingTrack(sampler.times, values[:, 0], radius, b, c)

    @property
    def rows(self) -> np.ndarray:
        """Numbers of the domains of the rows inside and outside the interface, in order of angle."""
        first = (self.layers // 2 - 1) * self.around
        return np.arange(first, first + 2 * self.around)

    def finite_elements(self, *, step: float | None = None, end: float | None = None) -> RingTrack:
        """Run finite elements, fully integrated and lumped, on the domains of the particles."""
        from matpoint.reference.explicit import run_explicit  # noqa: PLC0415 (loads scikit-fem)
        from matpoint.reference.prescribed import Prescribed  # noqa: PLC0415
        from matpoint.reference.solid import Solid  # noqa: PLC0415

        step, end = step or self.dt, end or self.end
        mesh = _whole(replace(self, dim=2).meshes())
        young = np.repeat(self.ring.youngs, mesh[1].shape[0] // 2)
        x, cells = mesh
        lame, shear = young * POISSON / ((1 + POISSON) * (1 - 2 * POISSON)), young / (2 * (1 + POISSON))
        solid = Solid(x, cells, "quad", lame, shear, DENSITY)
        held = [Prescribed(np.flatnonzero(x[:, k] == 0.0), k) for k in range(2)]
        node, axis = nearest(x, INNER)
        rows = self.rows
        run = run_explicit(
            solid, step=step, steps=round(end / step), every=_every(end, step), prescribed=held,
            body=lambda x, t: OMEGA**2 * x, nodes=np.array([node]), cells=rows,
        )  # fmt: skip
        sigma = radial_stress(run.stress, x[cells[rows]].mean(axis=1))
        b, c = np.split(sigma, 2, axis=1)
        return RingTrack(run.times, run.displacement[:, 0, :2] @ axis[:2], INNER, b, c)

    def reference(self, *, step: float | None = None, end: float | None = None) -> RadialHistory:
        """Run radial finite elements, 40 in each material; their error is a hundredth of all others'."""
        from matpoint.reference.radial import radial_fem  # noqa: PLC0415 (loads scikit-fem)

        end = end or self.end
        fine = min(1e-6, step or self.dt)
        return radial_fem(self.ring, end=end, step=fine, elements=40, every=_every(end, fine))

    def run_method(self, name: str, **times: Any) -> RingTrack:
        """Run a method, or ``fem``, by name."""
        from matpoint.interpolation import METHODS  # noqa: PLC0415 (compiles)

        return self.finite_elements(**times) if name == "fem" else self.track(METHODS[name], **times)

    def verify(
        self,
        methods: Sequence[str] | None = None,
        out: Path | None = None,
        progress: Announce | None = None,
    ) -> Result:
        """Run methods against radial finite elements; into ``out`` go the paper's figures 6, 7, 8."""
        names = self.chosen(methods)
        reference = self.reference()
        tracks: dict[str, RingTrack] = {}
        for number, name in enumerate(names):
            if progress is not None:
                progress(name, number, len(names))
            tracks[name] = self.run_method(name)
        if out is not None:
            from matpoint.problems.ring_figures import write_ring  # noqa: PLC0415 (loads matplotlib)

            write_ring(self, tracks, reference, out)
        return {name: self.measure(track, reference) for name, track in tracks.items()}

    def measure(self, track: RingTrack, reference: RadialHistory) -> dict[str, float]:
        """Return the norms of a run against the radial reference at the same times."""
        half = 0.5 * (OUTER - INNER) / self.layers
        peak = float(np.abs(reference.traction()).max())
        exact_b = reference.stress_at(INTERFACE - half)[:, 0, 0]
        exact_c = reference.stress_at(INTERFACE + half)[:, 0, 0]
        b, c, k = track.sigma_b, track.sigma_c, track.middle
        scatter = b - b.mean(axis=1, keepdims=True)
        return {
            "displacement": relative(track.inner, reference.displacement_at(track.inner_radius)[:, 0]),
            "sigma_b": relative(track.sector(b), exact_b),
            "sigma_c": relative(track.sector(c), exact_c),
            "jump": float(np.sqrt(np.mean((b[:, k] - c[:, k]) ** 2))) / peak,
            "scatter": float(np.sqrt(np.mean(scatter**2))) / peak,
            "jump_all": float(np.sqrt(np.mean((b - c) ** 2))) / peak,
            "sigma_one": max(relative(b[:, k], exact_b), relative(c[:, k], exact_c)),
        }

    def convergence(
        self, methods: Sequence[str], layers: Sequence[int] = (2, 4, 8, 16), step: float = 2e-6
    ) -> dict[str, list[Mapping[str, float]]]:
        """Return the norms of methods on finer and finer rings: method -> an entry for each of ``layers``."""
        found: dict[str, list[Mapping[str, float]]] = {name: [] for name in methods}
        for count in layers:
            ring = replace(self, layers=count)
            reference = ring.reference(step=step)
            for name in methods:
                norms = ring.measure(ring.run_method(name, step=step), reference)
                found[name].append({"layers": count, **norms})
        return found


def _every(end: float, step: float) -> int:
    return max(1, round(end / step / SAMPLES))


def _whole(parts: Sequence[Domains]) -> tuple[np.ndarray, np.ndarray]:
    """Vertices (nv, 3) [m] and cells of both parts as one mesh."""
    from matpoint.assembly import merge  # noqa: PLC0415 (keeps the import of a case light)

    joined = merge(parts, ("inner", "outer"))
    return joined.vertices, joined.cells

"""Pictures: one style for all, and particles as they lie."""

from __future__ import annotations

import glob
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from matpoint.domains import Kind
from matpoint.errors import InputError
from matpoint.faces import FACES
from matpoint.output.folder import claim
from matpoint.output.triggers import AtTimes, Trigger

if TYPE_CHECKING:
    from matpoint.simulation import Simulation

# Okabe and Ito's palette, safe for colour-blind readers; a method keeps its colour everywhere.
_STYLES: dict[str, tuple[str, str, str]] = {
    "fem": ("#000000", "-", ""),
    "mpm": ("#999999", "--", "s"),
    "ugimp": ("#E69F00", "--", "^"),
    "cpgimp": ("#F0C242", ":", "v"),
    "bspline2": ("#56B4E9", "-.", "P"),
    "bspline3": ("#0F4C81", "-.", "X"),
    "cpdi1": ("#CC79A7", "--", "D"),
    "cpdi2": ("#D55E00", "-", "o"),
    "enriched-cpdi2": ("#009E73", "-", "*"),
    "mls": ("#7A5195", ":", "<"),
    "imls": ("#7A5195", "-", ">"),
    "tls": ("#7A5195", "--", "p"),
    "spline-imls": ("#C2185B", "-", "h"),
}


def method_style(name: str) -> dict[str, Any]:
    """Return colour, line style and marker of a method, as matplotlib's keywords."""
    colour, line, marker = _STYLES.get(name, ("#444444", "-", "."))
    return {"color": colour, "linestyle": line, "marker": marker}


def new_figure(
    width: float = 7.0, height: float = 4.3, rows: int = 1, columns: int = 1, *, share_y: bool = True
) -> tuple[Any, Any]:
    """Return a figure [inches] and its axes, an array if there are several."""
    from matplotlib.figure import Figure  # noqa: PLC0415 (slow to import)

    figure = Figure(figsize=(width, height), layout="constrained")
    axes = figure.subplots(rows, columns, sharex=True, sharey=share_y)
    for axis in np.atleast_1d(axes).ravel():
        axis.grid(True, color="#dddddd", linewidth=0.6)
        axis.spines[["top", "right"]].set_visible(False)
    return figure, axes


def save(figure: Any, path: Path) -> Path:
    """Write a PNG."""
    figure.savefig(claim(path), dpi=150, bbox_inches="tight")
    return path


def von_mises(stress: np.ndarray) -> np.ndarray:
    """Return von Mises' equivalent stress [Pa] of stresses (n, 6)."""
    mean = stress[:, :3].mean(axis=1)[:, None]
    s, t = stress[:, :3] - mean, stress[:, 3:]
    return np.sqrt(1.5 * ((s**2).sum(axis=1) + 2 * (t**2).sum(axis=1)))


_COLOURS = {
    "von_mises": ("von Mises stress [Pa]", lambda p: von_mises(p.stress)),
    "stress_xx": ("stress xx [Pa]", lambda p: p.stress[:, 0]),
    "stress_yy": ("stress yy [Pa]", lambda p: p.stress[:, 1]),
    "stress_zz": ("stress zz [Pa]", lambda p: p.stress[:, 2]),
    "speed": ("speed [m/s]", lambda p: np.sqrt((p.velocity**2).sum(axis=1))),
    "displacement": ("displacement [m]", lambda p: np.sqrt(((p.position - p.position0) ** 2).sum(axis=1))),
    "material": ("material", lambda p: p.material.astype(float)),
}
COLOURS = tuple(_COLOURS)


def _outer_faces(sim: Simulation) -> tuple[list[np.ndarray], np.ndarray]:
    """Corners of the faces that one domain alone has, and the domain of each."""
    v = sim.vertices
    assert v is not None
    seen: dict[tuple[int, ...], tuple[np.ndarray, int]] = {}
    for p, (row, kind) in enumerate(zip(v.connectivity, v.kind, strict=True)):
        for face in FACES[Kind(kind)]:
            corners = row[list(face)]
            key = tuple(sorted(corners.tolist()))
            if key in seen:
                del seen[key]
            else:
                seen[key] = corners, p
    return [v.position[corners] for corners, _ in seen.values()], np.array([p for _, p in seen.values()])


def _draw_3d(axes: Any, sim: Simulation, values: np.ndarray) -> Any:
    """Outer faces of domains, or points; returns what the colour bar belongs to."""
    p = sim.particles
    low, high = p.position.min(axis=0), p.position.max(axis=0)
    if sim.vertices is None:
        drawn = axes.scatter(*p.position.T, c=values, s=6)
    else:
        from mpl_toolkits.mplot3d.art3d import Poly3DCollection  # noqa: PLC0415 (slow to import)

        faces, owner = _outer_faces(sim)
        drawn = Poly3DCollection(faces, array=values[owner], edgecolor="#33333355", linewidth=0.2)
        axes.add_collection3d(drawn)
        low, high = sim.vertices.position.min(axis=0), sim.vertices.position.max(axis=0)
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]), zlabel="z [m]")
    for axis in (axes.xaxis, axes.yaxis, axes.zaxis):
        axis.set_major_locator(_few_ticks())
    return drawn


def _few_ticks() -> Any:
    from matplotlib.ticker import MaxNLocator  # noqa: PLC0415 (slow to import)

    return MaxNLocator(3)


def draw_particles(sim: Simulation, path: Path, colour: str = "von_mises") -> Path:
    """Draw the particles where they are, coloured by a field.

    Domains of the vertex family are drawn as they are (in 3-D their outer faces), others as points.

    Raises
    ------
    InputError
        If there is no such colour.
    """
    if colour not in _COLOURS:
        raise InputError(f"figure: colour = {colour!r}; {', '.join(COLOURS)} are allowed")
    label, function = _COLOURS[colour]
    p, values = sim.particles, function(sim.particles)
    from matplotlib.figure import Figure  # noqa: PLC0415 (slow to import)

    figure = Figure(figsize=(7.0, 5.2))
    axes: Any = figure.add_subplot(projection="3d" if sim.dim == 3 else None)
    if sim.dim == 3:
        drawn: Any = _draw_3d(axes, sim, values)
    elif sim.dim == 2 and sim.vertices is not None:
        from matplotlib.collections import PolyCollection  # noqa: PLC0415 (slow to import)

        v = sim.vertices
        corners = [v.position[row[:n], :2] for row, n in zip(v.connectivity, v.count, strict=True)]
        drawn = PolyCollection(corners, array=values, edgecolor="face", linewidth=0.2)
        axes.add_collection(drawn)
        axes.autoscale()
    else:
        size = float(np.clip(4000.0 / len(p), 1.0, 40.0))
        drawn = axes.scatter(p.position[:, 0], p.position[:, 1], c=values, s=size, linewidths=0)
    axes.set_aspect("equal" if sim.dim > 1 else "auto")
    axes.set(xlabel="x [m]", ylabel="y [m]", title=f"{sim.interpolation.name}, t = {sim.time:.4g} s")
    figure.colorbar(drawn, ax=axes, label=label, shrink=0.7, pad=0.12 if sim.dim == 3 else 0.03)
    return save(figure, path)


class ParticleFigure:
    """Pictures of the particles at some times and at the end, or at the end only.

    Parameters
    ----------
    folder, stem
        Files are ``<stem>-<number>.png``, the end the last of them; without a trigger, the end alone is
        drawn, to ``<stem>.png``.
    colour
        One of ``COLOURS``.
    trigger
        When a picture is drawn besides the end.

    Raises
    ------
    InputError
        If there is no such colour, or the stem is no plain name.
    """

    def __init__(
        self, folder: Path, stem: str = "particles", colour: str = "von_mises", trigger: Trigger | None = None
    ) -> None:
        if colour not in _COLOURS:
            raise InputError(f"figure: colour = {colour!r}; {', '.join(COLOURS)} are allowed")
        if not stem.strip() or not stem.isprintable() or any(c in stem for c in "/\\"):
            raise InputError(f"figure: name = {stem!r} must be a plain file name, without its ending")
        self.folder, self.stem, self.colour = folder, stem, colour
        self._numbered = trigger is not None
        self.trigger: Trigger = trigger if trigger is not None else AtTimes((0.0,))
        self.files = (glob.escape(stem) + ("-[0-9]*.png" if self._numbered else ".png"),)
        self._count, self._drawn = 0, -1

    def open(self, sim: Simulation) -> None:
        """Nothing is needed before the first picture."""

    def write(self, sim: Simulation) -> None:
        """Draw a numbered picture."""
        if self._numbered:
            draw_particles(sim, self.folder / f"{self.stem}-{self._count:03d}.png", self.colour)
            self._count, self._drawn = self._count + 1, sim.step

    def close(self, sim: Simulation, error: BaseException | None) -> None:
        """Draw the end, unless the run failed or the last picture shows it."""
        if error is not None:
            return
        if not self._numbered:
            draw_particles(sim, self.folder / f"{self.stem}.png", self.colour)
        elif self._drawn != sim.step:
            self.write(sim)

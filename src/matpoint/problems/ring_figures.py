"""Figures 6, 7 and 8 of the bi-material ring (S, section 5.2), and its histories as a table."""

from __future__ import annotations

import csv
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from matpoint.output.figures import method_style, new_figure, save
from matpoint.problems.bimaterial_ring import INNER, INTERFACE, OUTER

if TYPE_CHECKING:
    from matpoint.problems.bimaterial_ring import BimaterialRing
    from matpoint.problems.ring_track import RingTrack
    from matpoint.reference.radial import RadialHistory

_SHADES = {"inner": "#0072B2", "outer": "#E69F00"}
_LEFT_OUT = ("layers", "scatter")  # of the figure of convergence


def write_ring(
    problem: BimaterialRing, tracks: Mapping[str, RingTrack], reference: RadialHistory, out: Path
) -> list[Path]:
    """Write the three figures and ``histories.csv``; return their paths.

    Parameters
    ----------
    problem
        The ring that was run.
    tracks, reference
        Histories of the methods, and of the radial finite elements.
    out
        A folder that exists.
    """
    return [
        save(draw_meshes(problem), out / "figure-6-meshes.png"),
        save(_displacements(problem, tracks, reference), out / "figure-7-displacement.png"),
        save(_stresses(problem, tracks, reference), out / "figure-8-stress-histories.png"),
        _table(tracks, reference, out / "histories.csv"),
    ]


def draw_meshes(problem: BimaterialRing, layers: tuple[int, ...] = (2, 4, 8, 16)) -> Any:
    """Return the paper's figure 6: the domains of several resolutions, near 45 degrees, on their grids."""
    from matplotlib.figure import Figure  # noqa: PLC0415 (slow to import)

    figure = Figure(figsize=(10.5, 3.2), layout="constrained")
    low, high = 2.08, 2.32
    for axis, count in zip(figure.subplots(1, len(layers)), layers, strict=True):
        ring = replace(problem, layers=count, dim=2)
        for mesh, (part, colour) in zip(ring.meshes(), _SHADES.items(), strict=True):
            corners = mesh.vertices[mesh.cells][:, [0, 1, 2, 3, 0], :2]
            near = ((corners > low - 0.1) & (corners < high + 0.1)).all(axis=(1, 2))
            drawn = axis.plot(*corners[near].transpose(2, 1, 0), color=colour, linewidth=0.7)
            drawn[0].set_label(f"{part} material")
        angle = np.linspace(0.0, 0.5 * np.pi, 500)
        x, y = INTERFACE * np.cos(angle), INTERFACE * np.sin(angle)
        axis.plot(x, y, color="#000000", linewidth=1.1, label="interface")
        lines = np.arange(np.ceil(low / ring.cell), np.floor(high / ring.cell) + 1) * ring.cell
        axis.set(xticks=lines, yticks=lines)
        axis.set(xlim=(low, high), ylim=(low, high), aspect="equal")
        axis.grid(True, color="#999999", linewidth=0.5)
        axis.tick_params(labelbottom=False, labelleft=False, length=0)
        axis.set_title(f"{count} layers, {count * ring.around} domains", fontsize=9)
    figure.suptitle("Domains at 45 degrees, inner and outer material, and the grid", fontsize=11)
    handles = figure.axes[0].get_legend_handles_labels()
    figure.legend(*handles, loc="outside lower center", ncols=3, frameon=False)
    return figure


def _displacements(problem: BimaterialRing, tracks: Mapping[str, RingTrack], reference: RadialHistory) -> Any:
    """The paper's figure 7, and below it how the curves differ."""
    from matplotlib.figure import Figure  # noqa: PLC0415 (slow to import)

    figure = Figure(figsize=(8.0, 6.6), layout="constrained")
    above, below = figure.subplots(2, 1, sharex=True)
    for axis in (above, below):
        axis.grid(True, color="#dddddd", linewidth=0.6)
        axis.spines[["top", "right"]].set_visible(False)
    exact = 1e6 * reference.displacement_at(INNER)[:, 0]
    above.plot(1e3 * reference.times, exact, color="#bbbbbb", linewidth=4.0, label="radial reference")
    for shift, (name, track) in enumerate(tracks.items()):
        style = method_style(name) | {"linewidth": 1.2, "markersize": 4.5, "markevery": (11 * shift, 100)}
        there = 1e6 * reference.displacement_at(track.inner_radius)[:, 0]
        above.plot(1e3 * track.times, 1e6 * track.inner, label=name, **style)
        below.plot(1e3 * track.times, 1e6 * track.inner - there, label=name, **style)
    above.set(ylabel="radial displacement of A [µm]", title=f"Inner face, stiff {problem.stiff} part")
    below.set(xlabel="time [ms]", ylabel="difference [µm]", xlim=(0.0, 1e3 * reference.times[-1]))
    # The worst curves would hide the others: the scale is that of the better half.
    gaps = [np.abs(t.inner - reference.displacement_at(t.inner_radius)[:, 0]).max() for t in tracks.values()]
    reach = 3e6 * float(np.median(gaps)) + 1e-9
    below.set_ylim(-reach, reach)
    figure.legend(*above.get_legend_handles_labels(), loc="outside lower center", ncols=5, frameon=False)
    return figure


def _stresses(problem: BimaterialRing, tracks: Mapping[str, RingTrack], reference: RadialHistory) -> Any:
    """The paper's figure 8: radial stresses at B and C, at 45 degrees, one panel for each method."""
    names = list(tracks)
    columns = min(3, len(names))
    rows = -(-len(names) // columns)
    figure, axes = new_figure(3.4 * columns + 0.6, 2.4 * rows + 1.0, rows, columns)
    flat = list(np.atleast_1d(axes).ravel())
    for spare in flat[len(names) :]:
        spare.set_visible(False)
    half = 0.5 * (OUTER - INNER) / problem.layers
    exact = [reference.stress_at(INTERFACE + gap)[:, 0, 0] for gap in (-half, half)]
    for number, (axis, name) in enumerate(zip(flat, names, strict=False)):
        track = tracks[name]
        for label, row, colour in (
            ("B, inside the interface", track.sigma_b, "#D55E00"),
            ("C, outside", track.sigma_c, "#0072B2"),
        ):
            axis.plot(1e3 * track.times, row[:, track.middle], color=colour, linewidth=1.0, label=label)
        # Thin and on top, so that both are seen: they lie close to each other.
        for label, values, colour in zip("BC", exact, ("#000000", "#777777"), strict=True):
            style = {"color": colour, "linewidth": 0.8, "dashes": (4, 3)}
            axis.plot(1e3 * reference.times, values, label=f"reference at {label}", **style)
        axis.set_title(name, fontsize=10)
        if number % columns == 0:
            axis.set_ylabel("radial stress [Pa]")
        if number + columns >= len(names):
            axis.set_xlabel("time [ms]")
            axis.tick_params(labelbottom=True)
    low, high = float(np.min(exact)), float(np.max(exact))
    flat[0].set(ylim=(low - 0.6 * (high - low), high + 0.6 * (high - low)))
    figure.suptitle(
        f"Radial stress on both sides of r = {INTERFACE} m, single domains at 45 degrees,"
        f" stiff {problem.stiff} part",
        fontsize=12,
    )
    handles = flat[0].get_legend_handles_labels()
    figure.legend(*handles, loc="outside lower center", ncols=4, frameon=False)
    return figure


def draw_convergence(found: Mapping[str, list[Mapping[str, float]]], title: str) -> Any:
    """Return error against the size of a domain, a panel for each norm, with lines of orders 1 and 2."""
    entries = next(iter(found.values()))
    norms = [n for n in entries[0] if n not in _LEFT_OUT]
    sizes = np.array([(OUTER - INNER) / entry["layers"] for entry in entries])
    rows = -(-len(norms) // 3)
    figure, axes = new_figure(10.0, 3.0 * rows + 1.0, rows, 3, share_y=False)
    flat = np.atleast_1d(axes).ravel()
    for spare in flat[len(norms) :]:
        spare.set_visible(False)
    for axis, norm in zip(flat, norms, strict=False):
        values = {name: np.array([entry[norm] for entry in runs]) for name, runs in found.items()}
        for name, errors in values.items():
            axis.loglog(sizes, errors, label=name, **method_style(name))
        low = min(errors[-1] for errors in values.values())
        for order, dashes in ((1, (5, 3)), (2, (2, 2))):
            line = 0.6 * low * (sizes / sizes[-1]) ** order
            axis.loglog(sizes, line, color="#999999", linewidth=0.9, dashes=dashes, label=f"order {order}")
        axis.set_xticks(sizes, [f"{size:g}" for size in sizes], fontsize=8)
        axis.set_xticks([], minor=True)
        axis.tick_params(labelbottom=True)
        axis.set(title=norm, ylabel="relative error", xlabel="domain [m]")
    figure.suptitle(title, fontsize=12)
    handles = flat[0].get_legend_handles_labels()
    figure.legend(*handles, loc="outside lower center", ncols=6, frameon=False)
    return figure


def _table(tracks: Mapping[str, RingTrack], reference: RadialHistory, path: Path) -> Path:
    """Write displacement and both stresses at 45 degrees of every method."""
    columns = {
        "time [s]": reference.times,
        "reference u(r_i) [m]": reference.displacement_at(INNER)[:, 0],
        "reference sigma_r [Pa]": reference.traction(),
    }
    for name, track in tracks.items():
        columns[f"{name} u_A [m]"] = track.inner
        columns[f"{name} sigma_B [Pa]"] = track.sigma_b[:, track.middle]
        columns[f"{name} sigma_C [Pa]"] = track.sigma_c[:, track.middle]
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(columns)
        writer.writerows(zip(*(column.tolist() for column in columns.values()), strict=True))
    return path

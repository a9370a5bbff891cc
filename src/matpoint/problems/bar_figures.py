"""Figures 3, 4 and 5 of the bi-material bar (S, section 5.1), and its histories as a table."""

from __future__ import annotations

import csv
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from matpoint.output.figures import method_style, new_figure, save
from matpoint.output.folder import claim
from matpoint.reference.modal import ModalBar

if TYPE_CHECKING:
    from matpoint.problems.bimaterial_bar import BimaterialBar, Track

PROFILE_TIME = 0.14  # [s], the paper's figure 5


def write_bar(problem: BimaterialBar, tracks: Mapping[str, Track], fem: Track, out: Path) -> list[Path]:
    """Write the three figures and ``histories.csv``; return their paths.

    Parameters
    ----------
    problem
        The bar that was run.
    tracks, fem
        Histories of the methods and of the reference.
    out
        A folder that exists.
    """
    note = f"stiff material {problem.stiff} the interface"
    return [
        save(_tip(problem, tracks, fem, note), out / "figure-3-tip.png"),
        save(_histories(tracks, fem, note), out / "figure-4-stress-histories.png"),
        save(_profiles(problem, tracks, fem, note), out / "figure-5-stress-profile.png"),
        _table({**tracks, "fem": fem}, out / "histories.csv"),
    ]


def _line(name: str, every: int | None = None, **changes: Any) -> dict[str, Any]:
    style = method_style(name) | {"label": name, "linewidth": 1.3, "markersize": 4.5}
    if every is None:
        style["marker"] = ""
    else:
        style["markevery"] = every
    return style | changes


def _tip(problem: BimaterialBar, tracks: Mapping[str, Track], fem: Track, note: str) -> Any:
    """The paper's figure 3: the curves lie on each other, so the lower panel shows how they differ."""
    from matplotlib.figure import Figure  # noqa: PLC0415 (slow to import)

    figure = Figure(figsize=(8.0, 6.6), layout="constrained")
    above, below = figure.subplots(2, 1, sharex=True)
    for axis in (above, below):
        axis.grid(True, color="#dddddd", linewidth=0.6)
        axis.spines[["top", "right"]].set_visible(False)
    modal = ModalBar(problem.bar)
    above.plot(
        fem.times, 1e3 * modal.displacement(fem.centres[:1], fem.times)[:, 0],
        color="#bbbbbb", linewidth=4.0, label="modal, small strain",
    )  # fmt: skip
    above.plot(fem.times, 1e3 * fem.tip, **_line("fem"))
    for shift, (name, track) in enumerate(tracks.items()):
        if name != "fem":
            style = _line(name, 100)
            style["markevery"] = (11 * shift, 100)
            above.plot(track.times, 1e3 * track.tip, **style)
            below.plot(track.times, 1e3 * (track.tip - fem.tip), **style)
    below.axhline(0.0, color="black", linewidth=1.3)
    above.set(ylabel="displacement of A [mm]", title=f"Displacement of the free end, {note}")
    below.set(xlabel="time [s]", ylabel="difference from fem [mm]", xlim=(0.0, fem.times[-1]))
    figure.legend(*above.get_legend_handles_labels(), loc="outside lower center", ncols=5, frameon=False)
    return figure


def _panels(tracks: Mapping[str, Track], below: str) -> tuple[Any, list[tuple[str, Any]]]:
    """One panel for each particle method; ``below`` is the label of the lower axes."""
    names = [name for name in tracks if name != "fem"] or ["fem"]
    columns = min(len(names), 4)
    rows = -(-len(names) // columns)
    figure, axes = new_figure(max(2.7 * columns + 0.6, 6.0), 2.3 * rows + 1.0, rows, columns)
    flat = list(np.atleast_1d(axes).ravel())
    for spare in flat[len(names) :]:
        spare.set_visible(False)
    for number, (axis, name) in enumerate(zip(flat, names, strict=False)):
        axis.set_title(name, fontsize=10)
        if number % columns == 0:
            axis.set_ylabel("axial stress [kPa]")
        if number + columns >= len(names):
            axis.set_xlabel(below)
            axis.tick_params(labelbottom=True)
    return figure, list(zip(names, flat, strict=False))


def _histories(tracks: Mapping[str, Track], fem: Track, note: str) -> Any:
    """The paper's figure 4: stresses on both sides of the interface, one panel for each method."""
    figure, panels = _panels(tracks, "time [s]")
    mean = 0.5e-3 * (fem.sigma_b + fem.sigma_c)
    for name, axis in panels:
        track = tracks[name]
        axis.plot(fem.times, mean, color="black", linewidth=1.0, label="fem, mean of B and C", zorder=3)
        axis.plot(track.times, 1e-3 * track.sigma_b, color="#D55E00", linewidth=1.2, label="B, above")
        axis.plot(track.times, 1e-3 * track.sigma_c, color="#0072B2", linewidth=1.2, label="C, below")
        axis.set_xlim(0.0, fem.times[-1])
    figure.suptitle(f"Stress at the interface, {note}", fontsize=12)
    handles = panels[0][1].get_legend_handles_labels()
    figure.legend(*handles, loc="outside lower center", ncols=4, frameon=False)
    return figure


def _profiles(problem: BimaterialBar, tracks: Mapping[str, Track], fem: Track, note: str) -> Any:
    """The paper's figure 5: stress along the bar, one panel for each method."""
    figure, panels = _panels(tracks, "distance from the free end [m]")
    modal = ModalBar(problem.bar)
    x = np.linspace(0.0, problem.bar.length, 300)
    exact = 1e-3 * modal.stress(x, np.array([PROFILE_TIME]))[0]
    for name, axis in panels:
        axis.axvline(problem.bar.interface, color="#999999", linewidth=0.8, linestyle=":", label="interface")
        axis.plot(x, exact, color="#bbbbbb", linewidth=3.0, label="modal, small strain")
        axis.plot(fem.centres, 1e-3 * fem.profile(PROFILE_TIME), color="black", linewidth=1.0, label="fem")
        track = tracks[name]
        axis.plot(
            track.centres, 1e-3 * track.profile(PROFILE_TIME),
            color="#D55E00", linewidth=1.0, marker="o", markersize=3.5, label="particles",
        )  # fmt: skip
        axis.set_xlim(0.0, problem.bar.length)
    figure.suptitle(f"Stress along the bar at t = {PROFILE_TIME} s, {note}", fontsize=12)
    handles = panels[0][1].get_legend_handles_labels()
    figure.legend(*handles, loc="outside lower center", ncols=4, frameon=False)
    return figure


def _table(tracks: Mapping[str, Track], path: Path) -> Path:
    """Write time, tip displacement and both stresses of every method."""
    columns = {"time [s]": next(iter(tracks.values())).times}
    for name, track in tracks.items():
        columns[f"{name} tip [m]"] = track.tip
        columns[f"{name} sigma_B [Pa]"] = track.sigma_b
        columns[f"{name} sigma_C [Pa]"] = track.sigma_c
    with claim(path).open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(columns)
        writer.writerows(zip(*(column.tolist() for column in columns.values()), strict=True))
    return path

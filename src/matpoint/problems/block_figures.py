"""Figures of the sheared block: its shapes, and the traction across its interface."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from matpoint.output.figures import new_figure, save

if TYPE_CHECKING:
    from matpoint.problems.sheared_block import BlockTrack, ShearedBlock


def write_block(
    problem: ShearedBlock, tracks: Mapping[str, BlockTrack], fem: BlockTrack, out: Path
) -> list[Path]:
    """Write ``figure-shapes.png`` and ``figure-traction.png``; return their paths.

    Parameters
    ----------
    problem
        The block that was run.
    tracks, fem
        Histories of the methods and of the reference.
    out
        A folder that exists.
    """
    return [
        save(_shapes(problem, tracks), out / "figure-shapes.png"),
        save(_tractions(problem, tracks, fem), out / "figure-traction.png"),
    ]


def _shapes(problem: ShearedBlock, tracks: Mapping[str, BlockTrack]) -> Any:
    """Domains after shearing (above) and after turning (below), coloured by shear stress in turned axes."""
    from matplotlib.collections import PolyCollection  # noqa: PLC0415 (slow to import)

    count = len(tracks)
    figure, axes = new_figure(2.9 * count + 1.2, 6.0, 2, count)
    grid = np.array(axes).reshape(2, count)
    values = [stress for run in tracks.values() for _, stress in run.shapes]
    low, high = np.percentile(np.concatenate(values), (1, 99)) / 1e3
    drawn: Any = None
    for column, (name, run) in enumerate(tracks.items()):
        for axis, (corners, stress) in zip(grid[:, column], run.shapes, strict=False):
            drawn = PolyCollection(list(corners), array=stress / 1e3, edgecolor="#33333366", linewidth=0.3)
            drawn.set_clim(low, high)
            axis.add_collection(drawn)
            axis.set_axisbelow(True)
            axis.set(aspect="equal", xlim=(-0.6, 1.6), ylim=(-0.6, 1.6))
        grid[0, column].set_title(name)
        grid[1, column].set_xlabel("x [m]")
    for axis, what in zip(grid[:, 0], ("sheared", "turned"), strict=True):
        axis.set_ylabel(f"{what}: y [m]")
    figure.colorbar(drawn, ax=grid, label="shear stress in axes turned with the block [kPa]", shrink=0.7)
    figure.suptitle(f"Stiffness 1:{problem.contrast:g}, sides {problem.sides}", fontsize=12)
    return figure


def _tractions(problem: ShearedBlock, tracks: Mapping[str, BlockTrack], fem: BlockTrack) -> Any:
    """Traction along and across the interface, of the rows of domains on either side."""
    count = len(tracks)
    figure, axes = new_figure(2.9 * count + 1.0, 5.4, 2, count, share_y=False)
    grid = np.array(axes).reshape(2, count)
    for column, (name, run) in enumerate(tracks.items()):
        for row, what in enumerate(("along", "normal")):
            axis = grid[row, column]
            axis.plot(fem.times, fem.interface[:, row] / 1e3, color="#bbbbbb", linewidth=4.0, label="fem")
            sides = (("below", run.below, "-", "#0072B2"), ("above", run.above, "--", "#D55E00"))
            for side, values, line, colour in sides:
                traction = np.array(values)[:, row] / 1e3
                axis.plot(run.times, traction, label=side, linestyle=line, color=colour)
            axis.set_ylabel(f"{what} [kPa]" if column == 0 else "")
        grid[0, column].set_title(name)
        grid[1, column].set_xlabel("time [s]")
    figure.suptitle(f"Traction across the interface, stiffness 1:{problem.contrast:g}", fontsize=12)
    handles = grid[0, 0].get_legend_handles_labels()
    figure.legend(*handles, loc="outside lower center", ncols=3, frameon=False)
    return figure

"""Errors of several methods over time: a picture and a table."""

from __future__ import annotations

import csv
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from matpoint.output.figures import method_style, new_figure, save
from matpoint.problems.errors_track import FIELDS, ErrorTrack


def write_errors(title: str, tracks: Mapping[str, ErrorTrack], out: Path) -> list[Path]:
    """Write ``figure-errors.png`` and ``errors.csv``; return their paths.

    Parameters
    ----------
    title
        Of the figure.
    tracks
        Method -> its errors.
    out
        A folder that exists.
    """
    figure, axes = new_figure(12.0, 4.0, 1, 3, share_y=False)
    for k, (axis, (field, unit)) in enumerate(zip(axes, FIELDS.items(), strict=True)):
        for shift, (name, track) in enumerate(tracks.items()):
            style = method_style(name) | {"linewidth": 1.2, "markersize": 4.5, "markevery": (2 * shift, 20)}
            values = np.where(track.values[:, k] > 0, track.values[:, k], np.nan)
            axis.semilogy(track.times, values, label=name, **style)
        axis.set(title=f"{field} [{unit}]", xlabel="time [s]")
    figure.suptitle(f"{title}: RMS errors")
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=5, frameon=False)
    path = out / "errors.csv"
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(["method", "time [s]", *(f"{field} [{unit}]" for field, unit in FIELDS.items())])
        for name, track in tracks.items():
            rows = np.column_stack([track.times, track.values]).tolist()
            writer.writerows([name, *row] for row in rows)
    return [save(figure, out / "figure-errors.png"), path]

"""Orders of convergence: between neighbours, and fitted; and their tables."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from matpoint.problems.errors_track import NORMS

Entries = Sequence[Mapping[str, Any]]
_EXACT = 1e-14  # an error below this is rounding, without an order


def _good(entries: Entries, norm: str) -> list[tuple[int, float]]:
    """Cells and errors of the runs that reached their end."""
    done = [(e["cells"], e[norm]) for e in entries if e["failed"] is None and e[norm] is not None]
    return [(cells, error) for cells, error in done if error > _EXACT]


def fitted(entries: Entries, norm: str) -> float | None:
    """Return the slope of log(error) over log(cell size) by least squares; None below two sizes."""
    good = _good(entries, norm)
    if len({cells for cells, _ in good}) < 2:
        return None
    cells, errors = np.array(good).T
    return float(-np.polyfit(np.log(cells), np.log(errors), 1)[0])


def neighbours(entries: Entries, norm: str) -> list[float | None]:
    """Return the order between each size and the one before; None where one of them is missing."""
    known = dict(_good(entries, norm))
    sizes = [e["cells"] for e in entries]
    found: list[float | None] = [None] if sizes else []
    for coarse, fine in pairwise(sizes):
        both = coarse in known and fine in known and coarse != fine
        found.append(math.log(known[coarse] / known[fine]) / math.log(fine / coarse) if both else None)
    return found


def orders(found: Mapping[str, Entries]) -> dict[str, dict[str, float | None]]:
    """Return the fitted slopes: method -> norm -> slope."""
    return {method: {norm: fitted(entries, norm) for norm in NORMS} for method, entries in found.items()}


def _cell(error: float | None, order: float | None) -> str:
    text = "-" if error is None else f"{error:.3g}"
    return f"{text:>10}" + (f" ({order:5.2f})" if order is not None else " " * 8)


def tables(found: Mapping[str, Entries], norms: Sequence[str] = NORMS) -> str:
    """Return aligned text: for each norm a line per method, errors with orders between neighbours.

    Parameters
    ----------
    found
        Method -> entries, in order of cells.
    norms
        Those to show.
    """
    sizes = sorted({e["cells"] for entries in found.values() for e in entries})
    width = max(len("velocity_quarter"), *(len(m) for m in found)) + 2
    lines = []
    for norm in norms:
        lines.append(norm.ljust(width) + "".join(f"{n:>10}        " for n in sizes) + "    fitted")
        for method, entries in found.items():
            cells = {
                e["cells"]: (e[norm], o) for e, o in zip(entries, neighbours(entries, norm), strict=True)
            }
            slope = fitted(entries, norm)
            row = "".join(_cell(*cells.get(n, (None, None))) for n in sizes)
            lines.append(method.ljust(width) + row + ("         -" if slope is None else f"{slope:10.2f}"))
        lines.append("")
    lines.append(
        "particle-steps".ljust(width) + "".join(f"{n:>10}        " for n in sizes) + " seconds in all"
    )
    for method, entries in found.items():
        work = {e["cells"]: e["particle_steps"] for e in entries}
        row = "".join(f"{work.get(n, 0):10.3g}        " for n in sizes)
        lines.append(method.ljust(width) + row + f"{sum(e['wall_s'] for e in entries):10.2f}")
    lines += ["", *(f"{m} with {e['cells']} cells failed: {e['failed']}"
                    for m, entries in found.items() for e in entries if e["failed"])]  # fmt: skip
    return "\n".join(lines).rstrip()

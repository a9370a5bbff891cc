"""The summary of a run: what it was, how long it took, what it kept."""

from __future__ import annotations

import json
import math
import os
import platform
import time
from collections.abc import Mapping
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from matpoint._version import __version__
from matpoint.errors import InputError, RunError, Terminated
from matpoint.fingerprint import spelled
from matpoint.ledger import LedgerEntry
from matpoint.output.folder import claim
from matpoint.output.triggers import EverySteps

if TYPE_CHECKING:
    from matpoint.simulation import Simulation


def plain(value: Any) -> Any:
    """Return a value that JSON can hold: arrays as lists, NaN and infinities as null."""
    if isinstance(value, Mapping):
        return {str(k): plain(v) for k, v in value.items()}
    if isinstance(value, list | tuple | np.ndarray):
        return [plain(v) for v in value]
    if isinstance(value, np.generic):
        return plain(value.item())
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    return value if isinstance(value, str | int | bool) or value is None else str(value)


def write_json(path: Path, content: Mapping[str, Any]) -> None:
    """Write a JSON file in one go: a reader never sees half of it."""
    part = claim(path).with_name(path.name + ".tmp")
    try:
        part.write_text(json.dumps(plain(content), indent=2, allow_nan=False) + "\n", encoding="utf-8")
        os.replace(part, path)
    except OSError:
        part.unlink(missing_ok=True)
        raise


def _versions() -> dict[str, str]:
    found = {"matpoint": __version__, "python": platform.python_version()}
    for name in ("numpy", "numba", "h5py"):
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            found[name] = "not installed"
    return found


def _entry(entry: LedgerEntry) -> dict[str, Any]:
    names = ("time", "mass", "momentum", "angular_momentum", "kinetic", "strain", "external_work", "total")
    return {name: getattr(entry, name) for name in names}


def _cause(error: BaseException) -> str:
    if isinstance(error, Terminated):
        return "terminated by a signal (SIGTERM)"
    if isinstance(error, KeyboardInterrupt):
        return "interrupted by the user"
    return str(error) or type(error).__name__


class Summary:
    """``summary.json``, written when the run begins and again when it ends.

    Parameters
    ----------
    path
        The file.
    case
        Name of the case and whatever else identifies the run.
    norms
        Error norms of a problem, if it has any.
    """

    trigger = EverySteps(1)

    def __init__(
        self, path: Path, case: Mapping[str, Any] | None = None, norms: Mapping[str, Any] | None = None
    ) -> None:
        self.path, self.case, self.norms = path, dict(case or {}), dict(norms or {})
        self.files = (path.name,)
        self._range = (math.inf, 0.0)

    def open(self, sim: Simulation) -> None:
        """Note the start."""
        self._begin, self._first = time.perf_counter(), sim.step
        try:
            write_json(self.path, self._content(sim, "running", None))
        except OSError as error:
            raise InputError(f"summary: {self.path} can't be written ({error.strerror or error})") from None

    def write(self, sim: Simulation) -> None:
        """Keep the shortest and longest step."""
        if sim.step > self._first:
            self._range = min(self._range[0], sim.dt), max(self._range[1], sim.dt)

    def close(self, sim: Simulation, error: BaseException | None) -> None:
        """Write the file, with how the run ended."""
        status = "finished"
        if error is not None:
            status = "interrupted" if isinstance(error, KeyboardInterrupt) else "failed"
        write_json(self.path, self._content(sim, status, error))

    def _content(self, sim: Simulation, status: str, error: BaseException | None) -> dict[str, Any]:
        wall, steps = time.perf_counter() - self._begin, sim.step - self._first
        ledger = sim.ledger
        content: dict[str, Any] = {
            "case": self.case,
            "status": status,
            "method": sim.interpolation.name,
            "interpolation": repr(sim.interpolation),
            "scheme": sim.scheme.name,
            "transfer": repr(sim.scheme.transfer),
            "dim": sim.dim,
            "particles": len(sim.particles),
            "vertices": sim.engine.mapping.corners,
            "enriched_vertices": sim.engine.mapping.nodes.extra,
            "fallen_domains": len(sim.fallen),
            "nodes": len(sim.engine.mapping.nodes.records),
            "materials": [spelled(m) for m in sim.materials],
            "time": sim.time,
            "steps": sim.step,
            "dt": {"smallest": self._range[0], "largest": self._range[1]},
            "wall_s": wall,
            "particle_steps_per_s": steps * len(sim.particles) / wall if wall > 0 else None,
            "threads": sim.threads,
            "versions": _versions(),
            "notes": sim.notes,
            "ledger": {
                "start": _entry(ledger.start),
                "end": _entry(ledger.latest),
                "worst_drift": ledger.worst,
            },
        }
        if self.norms:
            content["norms"] = self.norms
        if isinstance(error, RunError):
            content["error"] = {
                "cause": error.cause, "step": error.step, "time": error.time,
                "particle": error.particle, "position": error.position,
            }  # fmt: skip
        elif error is not None:
            content["error"] = {"cause": _cause(error)}
        return content

"""Histories: named quantities and particles followed over time."""

from __future__ import annotations

import csv
import errno
import io
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import IO, TYPE_CHECKING

import numpy as np

from matpoint.errors import InputError
from matpoint.output.folder import claim
from matpoint.output.triggers import Trigger
from matpoint.quantities import QUANTITIES

if TYPE_CHECKING:
    from matpoint.simulation import Simulation

_VECTOR = {"x": 0, "y": 1, "z": 2}
_TENSOR = {"xx": 0, "yy": 1, "zz": 2, "xy": 3, "yz": 4, "xz": 5}
FIELDS = {
    "position": ("m", _VECTOR),
    "displacement": ("m", _VECTOR),
    "velocity": ("m/s", _VECTOR),
    "stress": ("Pa", _TENSOR),
}


_FAR = 1.5  # domain sizes from a particle, beyond which a probe does not mean it


def _domain_size(sim: Simulation, index: int) -> float:
    """The longest side of a particle's domain at the start [m]."""
    if sim.vertices is not None:
        v = sim.vertices
        corners = v.position0[v.connectivity[index, : v.count[index]]]
        return float((corners.max(axis=0) - corners.min(axis=0)).max())
    cell = sim.grid.cell
    mean = float(np.prod(cell)) ** (1.0 / sim.dim)
    return float(sim.particles.volume0[index]) ** (1.0 / sim.dim) * max(cell) / mean


@dataclass(frozen=True)
class Probe:
    """A particle followed in one component of one field.

    Parameters
    ----------
    name
        Label in the output.
    at
        Initial position [m]; the particle nearest to it is followed.
    field
        ``position``, ``displacement``, ``velocity`` or ``stress``.
    component
        ``x``, ``y``, ``z``, or for stress ``xx``, ``yy``, ``zz``, ``xy``, ``yz``, ``xz``.
    """

    name: str
    at: tuple[float, ...]
    field: str = "displacement"
    component: str = "x"

    def __post_init__(self) -> None:
        if self.field not in FIELDS:
            raise InputError(f"probe {self.name!r}: field = {self.field!r}; {', '.join(FIELDS)} are allowed")
        allowed = FIELDS[self.field][1]
        if self.component not in allowed:
            raise InputError(
                f"probe {self.name!r}: component = {self.component!r}; {', '.join(allowed)} are allowed"
            )
        if not 1 <= len(self.at) <= 3 or not np.isfinite(self.at).all():
            raise InputError(f"probe {self.name!r}: at = {list(self.at)} must be 1 to 3 finite numbers")

    @property
    def column(self) -> str:
        """The column's name."""
        return f"{self.name}.{self.field}.{self.component}"

    def find(self, sim: Simulation) -> int:
        """Return the id of the particle that it follows.

        Raises
        ------
        InputError
            If the nearest particle is farther than 1.5 times the size of its domain.
        """
        p, at = sim.particles, np.zeros(3)
        at[: len(self.at)] = self.at
        gap = ((p.position0 - at) ** 2).sum(axis=1)
        nearest = gap <= gap.min() * (1 + 1e-9) + 1e-30
        found = int(np.flatnonzero(nearest)[p.id[nearest].argmin()])
        distance, size = float(np.sqrt(gap[found])), _domain_size(sim, found)
        if distance > _FAR * size:
            where = p.position0[found, : sim.dim].tolist()
            raise InputError(
                f"probe {self.name!r}: at = {list(self.at)} is outside every body; the nearest particle,"
                f" at {where}, is {distance:.4g} m away, its domain {size:.4g} m long"
            )
        return int(p.id[found])

    def read(self, sim: Simulation, index: int) -> float:
        """Return the value at the particle with an internal index."""
        p, k = sim.particles, FIELDS[self.field][1][self.component]
        if self.field == "displacement":
            return float(p.position[index, k] - p.position0[index, k])
        return float(getattr(p, self.field)[index, k])


class Recorder:
    """Histories in memory.

    Parameters
    ----------
    trigger
        When a row is taken.
    quantities
        Names from ``matpoint.QUANTITIES``.
    probes
        Particles to follow.

    Raises
    ------
    InputError
        If a quantity does not exist or two columns have one name.
    """

    def __init__(
        self, trigger: Trigger, quantities: Sequence[str] = (), probes: Sequence[Probe] = ()
    ) -> None:
        self.trigger = trigger
        self.quantities, self.probes = tuple(quantities), tuple(probes)
        for name in self.quantities:
            if name not in QUANTITIES:
                raise InputError(
                    f"history: quantity {name!r} does not exist; there are {', '.join(QUANTITIES)}"
                )
        self.columns = ("step", "time", *self.quantities, *(p.column for p in self.probes))
        units = [QUANTITIES[q].unit for q in self.quantities] + [FIELDS[p.field][0] for p in self.probes]
        self.units = dict(zip(self.columns, ("-", "s", *units), strict=True))
        if len(set(self.columns)) < len(self.columns):
            raise InputError("history: two columns have one name; give each probe a name of its own")
        self.rows: list[tuple[float, ...]] = []
        self._ids: np.ndarray = np.zeros(0, dtype=np.int64)

    def open(self, sim: Simulation) -> None:
        """Find the particles to follow."""
        self._ids = np.array([probe.find(sim) for probe in self.probes], dtype=np.int64)

    def write(self, sim: Simulation) -> None:
        """Take a row."""
        where = np.empty(len(sim.particles), dtype=np.int64) if len(self._ids) else self._ids
        if len(self._ids):
            where[sim.particles.id] = np.arange(len(where))
        values = [sim.quantity(name) for name in self.quantities]
        values += [probe.read(sim, int(where[i])) for probe, i in zip(self.probes, self._ids, strict=True)]
        self.rows.append((sim.step, sim.time, *values))

    def close(self, sim: Simulation, error: BaseException | None) -> None:
        """Nothing is left to do."""

    def array(self, column: str) -> np.ndarray:
        """Return one column, for instance ``"time"`` or ``"A.stress.xx"``, shape (rows,)."""
        if column not in self.columns:
            raise InputError(f"history: no column {column!r}; there are {', '.join(self.columns)}")
        k = self.columns.index(column)
        return np.array([row[k] for row in self.rows])


class History(Recorder):
    """Histories in a CSV file, flushed row by row, with units in the header.

    Parameters
    ----------
    path
        The file.
    trigger, quantities, probes
        As for :class:`Recorder`.
    """

    def __init__(
        self, path: Path, trigger: Trigger, quantities: Sequence[str] = (), probes: Sequence[Probe] = ()
    ) -> None:
        super().__init__(trigger, quantities, probes)
        self.path, self.files = path, (path.name,)
        self._file: IO[bytes] | None = None

    def open(self, sim: Simulation) -> None:
        """Write the header."""
        super().open(sim)
        try:
            self._file = claim(self.path).open("wb", buffering=0)
        except OSError as error:
            raise InputError(f"history: {self.path} can't be written ({error.strerror or error})") from None
        self._put([f"{column} [{unit}]" for column, unit in self.units.items()])

    def write(self, sim: Simulation) -> None:
        """Take a row and put it on disk."""
        super().write(sim)
        self._put([repr(v) if isinstance(v, float) else v for v in self.rows[-1]])

    def close(self, sim: Simulation, error: BaseException | None) -> None:
        """Close the file."""
        if self._file is not None:
            self._file.close()

    def _put(self, row: Sequence[object]) -> None:
        """Write a row, or nothing of it: on a full disk the file ends with a whole row."""
        assert self._file is not None
        text = io.StringIO()
        csv.writer(text).writerow(row)
        line, start = text.getvalue().encode(), self._file.tell()
        try:
            if self._file.write(line) < len(line):
                raise OSError(errno.ENOSPC, "no space left for a row")
        except OSError as error:
            self._file.truncate(start)
            raise OSError(error.errno, error.strerror, str(self.path)) from None

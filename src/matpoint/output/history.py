"""Histories: named quantities and particles followed over time."""

from __future__ import annotations

import csv
import errno
import io
from collections.abc import Sequence
from pathlib import Path
from typing import IO, TYPE_CHECKING

import numpy as np

from matpoint.errors import InputError
from matpoint.output.folder import claim
from matpoint.output.probes import FIELDS, Probe
from matpoint.output.triggers import Trigger
from matpoint.quantities import QUANTITIES

if TYPE_CHECKING:
    from matpoint.simulation import Simulation


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
            twice = next(name for name in self.columns if self.columns.count(name) > 1)
            raise InputError(
                f"history: two columns are named {twice!r}; give each quantity once, and each probe a name of"
                " its own"
            )
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

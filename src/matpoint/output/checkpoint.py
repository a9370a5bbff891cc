"""Checkpoints: all that a run needs to go on, in one HDF5 file."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from matpoint.errors import InputError
from matpoint.fingerprint import identity
from matpoint.output.folder import claim
from matpoint.output.staged import staged_hdf5
from matpoint.output.triggers import Trigger

if TYPE_CHECKING:
    from matpoint.simulation import Simulation

_FORMAT = "matpoint checkpoint 2"


class Checkpoint:
    """The latest state, replaced as a whole each time.

    Parameters
    ----------
    path
        The file.
    trigger
        When it is written; an interrupted run writes one more.
    """

    def __init__(self, path: Path, trigger: Trigger) -> None:
        self.path, self.trigger, self.files = path, trigger, (path.name,)

    def open(self, sim: Simulation) -> None:
        """Refuse a place that can't be written before the run begins."""
        if not self.path.parent.is_dir() or not os.access(self.path.parent, os.W_OK):
            raise InputError(f"checkpoint: {self.path.parent} can't be written to")

    def write(self, sim: Simulation) -> None:
        """Write beside the old file, then put the new one in its place."""
        part = self.path.with_name(self.path.name + ".tmp")
        claim(self.path)
        try:
            with staged_hdf5(part, "w") as file:
                file.attrs["format"] = _FORMAT
                file.attrs["identity"] = json.dumps(identity(sim))
                for name, value in sim.state_scalars().items():
                    file.attrs[f"scalar.{name}"] = value
                for name, values in sim.state_arrays().items():
                    file.create_dataset(name, data=values)
            os.replace(part, self.path)
        except OSError:
            part.unlink(missing_ok=True)
            raise

    def close(self, sim: Simulation, error: BaseException | None) -> None:
        """Keep the state of a run that was interrupted between two steps."""
        if isinstance(error, KeyboardInterrupt):
            self.write(sim)

    def buffer(self, sim: Simulation) -> int:
        """Return the bytes that writing takes: the file, held until it is whole."""
        return sum(a.nbytes for a in sim.state_arrays().values())


def resume(sim: Simulation, path: Path | str) -> None:
    """Take up a checkpoint in a simulation made from the same case.

    Raises
    ------
    InputError
        If the file is no checkpoint, is damaged, or belongs to another case.
    """
    import h5py  # noqa: PLC0415 (slow to import)

    if not Path(path).is_file():
        raise InputError(f"restart: {path} can't be read: it is not a file; name a run's checkpoint.h5")
    try:
        with h5py.File(path, "r") as file:
            if file.attrs.get("format") != _FORMAT:
                raise InputError(f"restart: {path} is not a matpoint checkpoint of this version")
            held = dict(json.loads(str(file.attrs["identity"])))
            prefix = "scalar."
            scalars = {k[len(prefix) :]: float(v) for k, v in file.attrs.items() if k.startswith(prefix)}
            arrays = {name: np.asarray(data) for name, data in file.items()}
    except (OSError, KeyError, ValueError, TypeError) as error:
        raise InputError(f"restart: {path} can't be read ({' '.join(str(error).split())})") from None
    for name, values in arrays.items():
        if values.dtype.kind == "f" and np.isnan(values).any():
            raise InputError(f"restart: {path} is damaged: {name} holds what is no number; take another one")
    other = [name for name, value in identity(sim).items() if held.get(name) != value]
    if other:
        raise InputError(
            f"restart: {path} belongs to another case: {', '.join(other)} differ; loads, time step, end time"
            " and output may be changed"
        )
    sim.restore(arrays, scalars)

"""The same step as plain C++ loops: found, built with the compiler that there is, and run."""

from __future__ import annotations

import json
import os
import shlex
import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path
from statistics import median
from typing import Any

FLAGS = ("-O3", "-march=native", "-ffast-math", "-std=c++17")
_COMPILERS = ("g++", "clang++", "c++")
_PATIENCE = 600  # seconds


class NativeError(Exception):
    """The native program can't be had here; the message says why, in one line."""


def source_path() -> Path:
    """Return ``step.cpp``: beside this module in an installed package, else in the repository.

    Raises
    ------
    NativeError
        If it is in neither place.
    """
    here = Path(__file__).resolve()
    for path in (here.parent / "native" / "step.cpp", here.parents[3] / "benchmarks" / "native" / "step.cpp"):
        if path.is_file():
            return path
    raise NativeError("step.cpp is not there")


def compiler() -> list[str]:
    """Return the command of a C++ compiler: ``CXX``, or the first of g++, clang++, c++.

    Raises
    ------
    NativeError
        If there is none.
    """
    chosen = shlex.split(os.environ.get("CXX", ""))
    if chosen:
        if shutil.which(chosen[0]) is None:
            raise NativeError(f"CXX = {os.environ['CXX']!r} is not there")
        return chosen
    for name in _COMPILERS:
        if shutil.which(name):
            return [name]
    raise NativeError("no C++ compiler (CXX, g++, clang++ or c++)")


def _output(command: Sequence[str], what: str) -> str:
    try:
        done = subprocess.run(command, check=False, capture_output=True, text=True, timeout=_PATIENCE)
    except (OSError, subprocess.TimeoutExpired) as error:
        raise NativeError(f"{what}: {error}") from None
    if done.returncode != 0:
        lines = (done.stderr or done.stdout).strip().splitlines()
        found = next((line for line in lines if "error" in line), lines[0] if lines else "")
        raise NativeError(f"{what} ended with code {done.returncode}: {found.strip()}")
    return done.stdout


class Native:
    """The program, built.

    Parameters
    ----------
    folder
        Where to build it; it must exist.

    Raises
    ------
    NativeError
        If source or compiler is missing, or it does not compile.
    """

    def __init__(self, folder: Path) -> None:
        self._program = folder / "matpoint-step"
        self.command = [*compiler(), *FLAGS]
        self.version = _output([*compiler(), "--version"], "the C++ compiler").splitlines()[0]
        _output([*self.command, str(source_path()), "-o", str(self._program)], "the C++ compiler")
        self.clear()

    def clear(self) -> None:
        """Forget what has been measured."""
        self.rounds: list[float] = []
        self._stages: dict[str, float] = {}
        self.particles = 0

    def run(self, cells: int, steps: int, rounds: int = 1, dump: Path | None = None) -> dict[str, Any]:
        """Run the block; return what the program prints.

        Parameters
        ----------
        cells
            Along the block's side.
        steps, rounds
            Steps of a round, and how many rounds follow each other.
        dump
            A file for x [m] and v [m/s] of all particles, (n, 6) float64 in order of the lattice.

        Raises
        ------
        NativeError
            If it fails.
        """
        more = [] if dump is None else [str(dump)]
        return parse(_output([str(self._program), str(cells), str(steps), str(rounds), *more], "step"))

    def measure(self, cells: int, steps: int) -> None:
        """Make one round of steps; a first one, not counted, touches all memory."""
        found = self.run(cells, steps, 2)
        self.particles = found["particles"]
        self.rounds.append(1e9 * found["seconds"][-1] / steps / self.particles)
        for name, seconds in found["stages"].items():
            self._stages[name] = self._stages.get(name, 0.0) + seconds

    def result(self) -> dict[str, Any]:
        """Return particle-steps a second [millions], their spread, the stages, and how it was built."""
        ns, whole = median(self.rounds), sum(self._stages.values())
        return {
            "particles": self.particles, "mps": 1e3 / ns, "mps_min": 1e3 / max(self.rounds),
            "mps_max": 1e3 / min(self.rounds), "ns": ns,
            "stages": {name: {"share": s / whole, "ns": ns * s / whole} for name, s in self._stages.items()},
            "compiler": self.version, "command": shlex.join(self.command),
        }  # fmt: skip


def parse(text: str) -> dict[str, Any]:
    """Return what the program printed.

    Raises
    ------
    NativeError
        If it is not the JSON object that it should be.
    """
    try:
        found = json.loads(text)
        whole = all(isinstance(found[key], dict) for key in ("stages", "sum"))
        whole = whole and found["particles"] > 0 and all(s > 0 for s in found["seconds"])
    except (ValueError, KeyError, TypeError):
        whole, found = False, None
    if not whole or found is None:
        raise NativeError(f"step printed {text.strip()[:60]!r}")
    return found

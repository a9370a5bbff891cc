"""Import, and the cold and warm start of a small run, each in a process of its own."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path

CASE = "bimaterial-bar"
SETTINGS = ("--set", "time.end=0.001", "--quiet", "--threads", "1")


def python(*arguments: str, cache: str, folder: str) -> None:
    """Run this interpreter with a cache of compiled code; raise CalledProcessError if it fails."""
    environment = os.environ | {"MATPOINT_CACHE": cache}
    environment.pop("NUMBA_CACHE_DIR", None)  # it would take the cache's place
    subprocess.run([sys.executable, *arguments], check=True, env=environment, cwd=folder, capture_output=True)


class _InFolder:
    """A temporary folder for each benchmark."""

    timeout = 600.0
    number, repeat = 1, 3

    def setup(self) -> None:
        self._temporary = tempfile.TemporaryDirectory(prefix="matpoint-asv-")
        self.folder = self._temporary.name
        self.cache = str(Path(self.folder) / "cache")

    def teardown(self) -> None:
        self._temporary.cleanup()

    def run(self) -> None:
        """Run the case."""
        arguments = ("run", CASE, *SETTINGS, "--out", "out", "--force")
        python("-m", "matpoint", *arguments, cache=self.cache, folder=self.folder)


class Import(_InFolder):
    """``import matpoint``, less nothing: the interpreter's own start is in it."""

    def time_python_alone(self) -> None:
        python("-c", "pass", cache=self.cache, folder=self.folder)

    def time_import(self) -> None:
        python("-c", "import matpoint", cache=self.cache, folder=self.folder)

    def time_import_simulation(self) -> None:
        python("-c", "from matpoint import Simulation", cache=self.cache, folder=self.folder)


class Cold(_InFolder):
    """A run whose kernels must all be compiled: the cache is empty."""

    repeat = 1

    def time_run(self) -> None:
        self.run()


class Warm(_InFolder):
    """The same run with everything compiled."""

    def setup(self) -> None:
        super().setup()
        self.run()

    def time_run(self) -> None:
        self.run()

"""Results of runs, kept by what they depend on."""

from __future__ import annotations

import hashlib
import json
import os
import platform
import warnings
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any

from matpoint.jit import cache_folder, source_hash


def key(given: dict[str, Any]) -> str:
    """Return a hash of a task: problem, settings, method, options, transfer; of sources and versions."""
    parts = {
        **given,
        "sources": source_hash(),
        "versions": [version(name) for name in ("numpy", "numba", "scipy", "sympy")],
        "python": platform.python_version(),
        "machine": platform.machine(),
    }
    return hashlib.sha256(json.dumps(parts, sort_keys=True).encode()).hexdigest()[:32]


def folder() -> Path:
    """Return where results are kept: beside the compiled kernels."""
    return cache_folder().parent / "studies"


def recall(name: str) -> dict[str, Any] | None:
    """Return a result that was kept, or None."""
    try:
        found = json.loads((folder() / f"{name}.json").read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    return found if isinstance(found, dict) and "cells" in found else None


def keep(name: str, result: dict[str, Any]) -> None:
    """Keep a result; where the folder can't be written nothing is kept, which is said once."""
    try:
        folder().mkdir(parents=True, exist_ok=True)
        part = folder() / f"{name}.{os.getpid()}.tmp"
        part.write_text(json.dumps(result), encoding="utf-8")
        part.replace(folder() / f"{name}.json")
    except OSError as error:
        _say_once(str(folder()), error.strerror or str(error))


@cache
def _say_once(where: str, why: str) -> None:
    warnings.warn(
        f"results of studies are not kept, and will be run again: {where} can't be written ({why});"
        " MATPOINT_CACHE names another folder",
        stacklevel=3,
    )

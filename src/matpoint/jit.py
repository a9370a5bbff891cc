"""The one door to Numba: where compiled code is cached, and with which flags it is compiled.

Numba keys its cache by a file's own time stamp and does not see edits in the files that it
calls, so the cache folder is named after a hash of all sources of the package: an edit
anywhere starts a new cache, and two versions of matpoint never share one.
"""

from __future__ import annotations

import hashlib
import os
import re
import tempfile
import time
import warnings
from collections.abc import Callable
from contextlib import suppress
from functools import lru_cache
from pathlib import Path
from typing import Any
from uuid import uuid4

import numba
import platformdirs
from numba import extending
from numba.core import config, event
from numba.core.caching import IndexDataCacheFile
from numba.cpython.unsafe import tuple as _tuples

# Every fast-math freedom but "nnan" and "ninf": a NaN must stay a NaN, so that it is found.
FAST_MATH = {"contract", "reassoc", "nsz", "arcp"}


@lru_cache(maxsize=1)
def source_hash() -> str:
    """Return the first 16 hexadecimal digits of a SHA-256 over the package's sources."""
    digest = hashlib.sha256(numba.__version__.encode())
    root = Path(__file__).parent
    for path in sorted(root.rglob("*.py")):
        digest.update(path.relative_to(root).as_posix().encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


def cache_folder() -> Path:
    """Return the folder of the compiled kernels; ``MATPOINT_CACHE`` moves its parent."""
    parent = os.environ.get("MATPOINT_CACHE") or platformdirs.user_cache_dir("matpoint", appauthor=False)
    return Path(parent) / source_hash()


_OURS = "NUMBA_CACHE_DIR" not in os.environ  # else the user keeps compiled code in a place of their own


def _usable_cache() -> bool:
    """Whether compiled code can be kept; if not, it is said once, and Numba finds no place of its own.

    Numba would fall back to a folder beside the sources, where edits of files that a kernel calls go unseen.
    """
    if not _OURS:
        return True  # Numba's business
    folder = cache_folder()
    config.CACHE_DIR = str(folder)  # type: ignore[attr-defined]
    try:
        folder.mkdir(parents=True, exist_ok=True)
        os.utime(folder)  # its time says when it was used last
        tempfile.TemporaryFile(dir=folder).close()
    except OSError as error:
        warnings.warn(
            f"compiled code is not kept, every process compiles anew: {folder.parent} can't be written"
            f" ({error.strerror or error}); MATPOINT_CACHE names another folder",
            stacklevel=2,
        )
        return False
    return True


class _CacheFile(IndexDataCacheFile):
    """Numba's file of compiled code, safe when several processes fill it at once.

    Numba numbers the code of one kernel's signatures 1, 2, ...; two processes that add different
    signatures at once would take the same number, and one would load the other's code. Names that no
    other process can choose leave nothing worse than a file too many.
    """

    def _data_name(self, number: int) -> str:
        return super()._data_name(uuid4().int)


_USABLE = _usable_cache()


def kernel(function: Callable[..., Any]) -> Any:
    """Make a kernel: a loop over plain arrays, compiled once, cached, run without the GIL."""
    return _compiled(function, FAST_MATH)


def summing_kernel(function: Callable[..., Any]) -> Any:
    """Make a kernel whose sums are taken in the order of its loop.

    Free to reorder them, LLVM gathers lanes from strided arrays, which takes three times as long.
    """
    return _compiled(function, FAST_MATH - {"reassoc"})


def _compiled(function: Callable[..., Any], fast_math: set[str]) -> Any:
    compiled: Any = numba.njit(
        cache=_USABLE, nogil=True, fastmath=fast_math, error_model="numpy"
    )(function)  # fmt: skip
    file = getattr(getattr(compiled, "_cache", None), "_cache_file", None)
    if isinstance(file, IndexDataCacheFile):
        file.__class__ = _CacheFile
    return compiled


class _FirstCompilation(event.Listener):
    """Calls a function when Numba begins to compile something that no cache holds, once."""

    def __init__(self, call: Callable[[], None]) -> None:
        self._call: Callable[[], None] | None = call

    def on_start(self, event: Any) -> None:
        call, self._call = self._call, None
        if call is not None:
            call()

    def on_end(self, event: Any) -> None:
        """Nothing is said at the end."""


def on_first_compilation(call: Callable[[], None]) -> None:
    """Let a function be called when a kernel must be compiled; not if all come from the cache."""
    event.register("numba:compile", _FirstCompilation(call))


def prune_caches(days: float = 30.0) -> None:
    """Remove the caches of other versions of the sources that have not been used for some days.

    Only folders named as ours, in which there is nothing but what Numba puts there.
    """
    if not _OURS:
        return
    present, oldest = cache_folder(), time.time() - 86400.0 * days
    with suppress(OSError):
        for folder in present.parent.iterdir():
            ours = re.fullmatch("[0-9a-f]{16}", folder.name) and folder != present
            if ours and not folder.is_symlink() and folder.stat().st_mtime < oldest:
                _remove_cache(folder)


def _remove_cache(folder: Path) -> None:
    files = [path for path in folder.rglob("*") if path.is_symlink() or not path.is_dir()]
    if not all(re.search(r"\.nb[ic](\.tmp\.\w+)?$", path.name) for path in files):
        return
    for path in files:
        path.unlink(missing_ok=True)
    for path in sorted(folder.rglob("*"), reverse=True):
        path.rmdir()
    folder.rmdir()


#: Decorator of a small function used inside kernels; it stays callable from plain Python. Always inlined:
#: a copy of its own could be taken from another kernel, where it was optimised otherwise, so that the
#: process that compiles would differ in the last bit from those that load from the cache.
device: Callable[..., Any] = extending.register_jitable(
    fastmath=FAST_MATH, error_model="numpy", forceinline=True
)

#: ``set_item(t, i, v)`` is the tuple ``t`` with entry i replaced; in compiled code only.
set_item: Callable[..., Any] = _tuples.tuple_setitem

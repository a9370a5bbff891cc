"""The one door to Numba: where compiled code is cached, and with which flags it is compiled.

Numba keys its cache by a file's own time stamp and does not see edits in the files that it
calls, so the cache folder is named after a hash of all sources of the package: an edit
anywhere starts a new cache, and two versions of matpoint never share one.
"""

from __future__ import annotations

import hashlib
import os
import tempfile
import warnings
from collections.abc import Callable
from functools import lru_cache, partial
from pathlib import Path
from typing import Any

import numba
import platformdirs
from numba import extending
from numba.core import config
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


def _usable_cache() -> bool:
    """Whether compiled code can be kept; if not, it is said once, and Numba finds no place of its own.

    Numba would fall back to a folder beside the sources, where edits of files that a kernel calls go unseen.
    """
    if "NUMBA_CACHE_DIR" in os.environ:
        return True  # the user's own choice, and Numba's business
    folder = cache_folder()
    config.CACHE_DIR = str(folder)  # type: ignore[attr-defined]
    try:
        folder.mkdir(parents=True, exist_ok=True)
        tempfile.TemporaryFile(dir=folder).close()
    except OSError as error:
        warnings.warn(
            f"compiled code is not kept, every process compiles anew: {folder.parent} can't be written"
            f" ({error.strerror or error}); MATPOINT_CACHE names another folder",
            stacklevel=2,
        )
        return False
    return True


#: Decorator of a kernel: a loop over plain arrays, compiled once, cached, run without the GIL.
kernel: Callable[..., Any] = partial(
    numba.njit, cache=_usable_cache(), nogil=True, fastmath=FAST_MATH, error_model="numpy"
)

#: Decorator of a small function used inside kernels; it stays callable from plain Python.
device: Callable[..., Any] = extending.register_jitable(fastmath=FAST_MATH, error_model="numpy")

#: ``set_item(t, i, v)`` is the tuple ``t`` with entry i replaced; in compiled code only.
set_item: Callable[..., Any] = _tuples.tuple_setitem

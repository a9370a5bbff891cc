"""Changes to a file that are held in memory, then written by Python: a full disk raises, and spoils nothing.

HDF5 can't give up a file that it failed to write to: it tries again when its objects are freed, and the
process dies. So it works on one of these instead, which never fails, and the disk is touched afterwards.
"""

from __future__ import annotations

import io
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

_PAGE = 1 << 12  # bytes of the old part that are held together


class StagedFile(io.RawIOBase):
    """A file whose changes stay in memory until ``commit``.

    Parameters
    ----------
    path
        A file that exists.
    """

    def __init__(self, path: Path) -> None:
        self._base = path.open("r+b", buffering=0)
        self._old = os.fstat(self._base.fileno()).st_size
        self._pages: dict[int, bytearray] = {}  # changed pages of the old part
        self._tail = bytearray()  # what lies beyond it
        self._length, self._at = self._old, 0

    def readable(self) -> bool:
        return True

    def writable(self) -> bool:
        return True

    def seekable(self) -> bool:
        return True

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        start = {os.SEEK_SET: 0, os.SEEK_CUR: self._at, os.SEEK_END: self._length}[whence]
        self._at = start + offset
        return self._at

    def truncate(self, size: int | None = None) -> int:
        self._length = self._at if size is None else size
        self._grow(self._length)
        return self._length

    def readinto(self, buffer: Any) -> int:
        """Read from the pages held, the file and the tail."""
        view = memoryview(buffer).cast("B")
        count = max(0, min(len(view), self._length - self._at))
        for start, end in self._cuts(self._at, self._at + count):
            part = view[start - self._at : end - self._at]
            if start >= self._old:
                part[:] = memoryview(self._tail)[start - self._old : end - self._old]
            elif start // _PAGE in self._pages:
                first = start % _PAGE
                part[:] = memoryview(self._pages[start // _PAGE])[first : first + len(part)]
            else:
                part[:] = self._from_disk(start, len(part))
        self._at += count
        return count

    def write(self, data: Any) -> int:
        """Take note of a change."""
        view = memoryview(data).cast("B")
        begin, end = self._at, self._at + len(view)
        self._grow(end)
        for start, stop in self._cuts(begin, end):
            part = view[start - begin : stop - begin]
            if start >= self._old:
                self._tail[start - self._old : stop - self._old] = part
            else:
                page = self._page(start // _PAGE)
                page[start % _PAGE : start % _PAGE + len(part)] = part
        self._at = end
        self._length = max(self._length, end)
        return len(view)

    def commit(self) -> None:
        """Write what is new, then what has changed; if the disk is full, leave the file as it was.

        Raises
        ------
        OSError
            From the system.
        """
        try:
            self._put(self._old, self._tail)
        except OSError:
            os.ftruncate(self._base.fileno(), self._old)
            raise
        for number, page in sorted(self._pages.items()):
            start = number * _PAGE
            self._put(start, page[: self._old - start])
        os.ftruncate(self._base.fileno(), self._length)

    def close(self) -> None:
        """Close the file; changes that were not committed are forgotten."""
        self._base.close()
        super().close()

    # -- helpers -----------------------------------------------------------------------------

    def _cuts(self, begin: int, end: int) -> Iterator[tuple[int, int]]:
        """Cut a range at pages of the old part, and where the tail begins."""
        while begin < end:
            stop = end if begin >= self._old else min(end, (begin // _PAGE + 1) * _PAGE, self._old)
            yield begin, stop
            begin = stop

    def _grow(self, end: int) -> None:
        missing = end - self._old - len(self._tail)
        if missing > 0:
            self._tail.extend(bytes(missing))

    def _from_disk(self, start: int, count: int) -> bytes:
        data = os.pread(self._base.fileno(), count, start)
        return data + bytes(count - len(data))

    def _page(self, number: int) -> bytearray:
        if number not in self._pages:
            self._pages[number] = bytearray(self._from_disk(number * _PAGE, _PAGE))
        return self._pages[number]

    def _put(self, start: int, data: bytearray) -> None:
        self._base.seek(start)
        rest = memoryview(data)
        while rest:
            rest = rest[self._base.write(rest) :]


@contextmanager
def staged_hdf5(path: Path, mode: str) -> Iterator[Any]:
    """Open an HDF5 file; what is written reaches the disk at the end of the block, or not at all.

    Parameters
    ----------
    path
        The file.
    mode
        ``"r+"`` changes it, ``"w"`` begins anew.

    Raises
    ------
    OSError
        If the disk is full or the file can't be opened; then the file is what it was before.
    """
    import h5py  # noqa: PLC0415 (slow to import)

    if mode == "w":
        path.write_bytes(b"")
    try:
        with StagedFile(path) as staged:
            with h5py.File(staged, mode) as file:
                yield file
            staged.commit()
    except OSError as error:
        if error.errno is not None and error.filename is None:
            error.filename = str(path)
        raise

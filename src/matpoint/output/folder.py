"""The output folder: what may be written where, and what of it may be removed again."""

from __future__ import annotations

import os
import stat
from collections.abc import Sequence
from fnmatch import fnmatchcase
from pathlib import Path

from matpoint.errors import InputError

# The list of files that runs created in a folder. Only these may be removed, and only with these endings.
_LIST = ".matpoint-files"
_HEAD = "# Files that matpoint wrote here; --force removes these and no others."
_ENDINGS = (".vtkhdf", ".csv", ".json", ".png", ".h5", "table.md", "table.txt")
_LONGEST = 10_000_000  # bytes of a list


def prepare_folder(path: Path | str, force: bool = False, files: Sequence[str] = ()) -> Path:
    """Create an output folder, or take an old one.

    Parameters
    ----------
    path
        The folder.
    force
        Take a folder that holds something, and remove the files that earlier runs listed as theirs in
        ``.matpoint-files``; everything else is left alone.
    files
        Names, or patterns such as ``"beam-*.png"``, of what will be written.

    Raises
    ------
    InputError
        If it can't be created or written, is a file, holds something and ``force`` is not given, or holds
        a file of another origin that would be overwritten.
    """
    folder = Path(path)
    try:
        if folder.exists() and not folder.is_dir():
            raise InputError(f"output: {folder} is a file; a folder is needed")
        held = sorted(p.name for p in folder.iterdir() if p.name != _LIST) if folder.exists() else []
        if held and not force:
            raise InputError(
                f"output: {folder} holds {len(held)} entries ({held[0]}, ...); use --force to write there,"
                " or --out for another folder"
            )
        own = _own(folder, held)
        _refuse_overwriting(folder, [name for name in held if name not in own], files)
        folder.mkdir(parents=True, exist_ok=True)
        if not os.access(folder, os.W_OK | os.X_OK):
            raise InputError(f"output: {folder} can't be written to; check its permissions")
        for name in own:
            (folder / name).unlink()  # of a link, this removes the link only
        (folder / _LIST).unlink(missing_ok=True)
        with (folder / _LIST).open("x", encoding="utf-8") as file:
            file.write(_HEAD + "\n")
    except OSError as error:
        raise InputError(f"output: {folder} can't be used ({error.strerror or error})") from None
    return folder


def wrote(path: Path, names: Sequence[str]) -> bool:
    """Return whether runs listed all of some names as theirs, and these are plain files."""
    listed = _listed(path)
    return all(n in listed and (path / n).is_file() and not (path / n).is_symlink() for n in names)


def extend_folder(path: Path, files: Sequence[str]) -> Path:
    """Take a folder as it is, to write files of earlier runs again; nothing is removed.

    Parameters
    ----------
    path
        A folder that runs wrote in.
    files
        Names, or patterns, of what will be written.

    Raises
    ------
    InputError
        If it can't be written, or holds a file of another origin, or a link, that would be overwritten.
    """
    try:
        held = sorted(p.name for p in path.iterdir())
        own = [name for name in _own(path, held) if not (path / name).is_symlink()]
    except OSError as error:
        raise InputError(f"output: {path} can't be used ({error.strerror or error})") from None
    _refuse_overwriting(path, [name for name in held if name not in own], files)
    if not os.access(path, os.W_OK | os.X_OK):
        raise InputError(f"output: {path} can't be written to; check its permissions")
    return path


def _refuse_overwriting(folder: Path, others: Sequence[str], files: Sequence[str]) -> None:
    for name in others:
        if any(fnmatchcase(name, pattern) for pattern in files):
            raise InputError(
                f"output: {folder} holds {name}, which no run is known to have written there, and this one"
                " would overwrite it; move it away, or choose another folder with --out"
            )


def _own(folder: Path, held: Sequence[str]) -> list[str]:
    """Names of plain files and links in the folder that earlier runs listed as theirs."""
    listed = set(_listed(folder))
    own = [name for name in held if name.removesuffix(".tmp") in listed]
    return [name for name in own if (folder / name).is_symlink() or (folder / name).is_file()]


def _listed(folder: Path) -> list[str]:
    """The list as it stands, less whatever is not a plain name of a file that matpoint writes."""
    path = folder / _LIST
    try:
        found = path.lstat()  # a link is not followed
        if not stat.S_ISREG(found.st_mode) or found.st_size > _LONGEST:
            return []
        head, *names = path.read_text(encoding="utf-8").splitlines()
    except (OSError, ValueError):
        return []
    plain = [n for n in names if n == os.path.basename(n) and "\\" not in n and "\0" not in n]
    return [n for n in plain if n.endswith(_ENDINGS)] if head == _HEAD else []


def claim(path: Path) -> Path:
    """Add a file that is about to be written to the list of its folder, if that was prepared.

    Returns
    -------
    Path
        The same path.
    """
    folder = path.parent
    if (folder / _LIST).exists() and path.name not in _listed(folder):
        flags = os.O_WRONLY | os.O_APPEND | getattr(os, "O_NOFOLLOW", 0)
        with open(os.open(folder / _LIST, flags), "a", encoding="utf-8") as file:
            file.write(path.name + "\n")
    return path


def inside(folder: Path, name: str) -> Path:
    """Return the path of a file in a folder; refuse names that lead out of it.

    Raises
    ------
    InputError
        If the name is absolute, climbs out, or runs through a link that leads out.
    """
    target = folder / name
    if not name or Path(name).is_absolute() or not target.resolve().is_relative_to(folder.resolve()):
        raise InputError(f"output: {name!r} leads out of the output folder; give a plain file name")
    return target

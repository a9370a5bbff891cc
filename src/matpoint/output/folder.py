"""The output folder: what may be written where."""

from __future__ import annotations

import os
from pathlib import Path

from matpoint.errors import InputError

# What matpoint itself writes: the only files that --force may remove.
_OWN_SUFFIXES = (".vtkhdf", ".csv", ".json", ".png", ".h5", ".bib", ".toml", ".tmp")


def prepare_folder(path: Path | str, force: bool = False) -> Path:
    """Create an output folder, or clear an old one.

    Parameters
    ----------
    path
        The folder.
    force
        Take a folder that holds something, and remove the files in it that matpoint writes (by their
        endings); others are left alone.

    Raises
    ------
    InputError
        If it can't be created or written, is a file, or holds something and ``force`` is not given.
    """
    folder = Path(path)
    try:
        if folder.exists() and not folder.is_dir():
            raise InputError(f"output: {folder} is a file; a folder is needed")
        held = sorted(p.name for p in folder.iterdir()) if folder.exists() else []
        if held and not force:
            raise InputError(
                f"output: {folder} holds {len(held)} entries ({held[0]}, ...); use --force to write there,"
                " or --out for another folder"
            )
        folder.mkdir(parents=True, exist_ok=True)
        if not os.access(folder, os.W_OK | os.X_OK):
            raise InputError(f"output: {folder} can't be written to; check its permissions")
        for name in held:
            old = folder / name
            if old.suffix in _OWN_SUFFIXES and (old.is_symlink() or old.is_file()):
                old.unlink()  # of a link, this removes the link only
    except OSError as error:
        raise InputError(f"output: {folder} can't be used ({error.strerror or error})") from None
    return folder


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

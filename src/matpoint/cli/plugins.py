"""Python files that the user names on the command line."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path

from matpoint.errors import InputError, MatpointError


def load_plugin(path: Path) -> None:
    """Run a Python file, which may register materials. A case file alone can't ask for this.

    Raises
    ------
    InputError
        If the file is not there, is not Python, or fails.
    """
    if not path.is_file():
        raise InputError(f"--plugin {path}: there is no such file")
    name = f"matpoint_plugin_{path.stem}"
    spec = importlib.util.spec_from_file_location(name, path)
    if spec is None or spec.loader is None:
        raise InputError(f"--plugin {path}: not a Python file (its name must end in .py)")
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    try:
        spec.loader.exec_module(module)
    except MatpointError as error:
        raise InputError(f"--plugin {path}: {error}") from None
    except (Exception, SystemExit) as error:
        raise InputError(f"--plugin {path}: {type(error).__name__}: {error}") from None

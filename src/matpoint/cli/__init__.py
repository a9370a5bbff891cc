"""The command line: ``matpoint run``, ``verify``, ``explain`` and the others."""

from __future__ import annotations

import sys


def main(arguments: list[str] | None = None) -> None:
    """Run a command and exit: 0 well, 2 bad input, 3 a run that failed, 130 interrupted, 143 terminated."""
    try:
        from matpoint.cli.commands import app  # noqa: PLC0415 (keeps `import matpoint.cli` light)
        from matpoint.cli.exits import exit_code  # noqa: PLC0415
    except KeyboardInterrupt:
        sys.exit(130)
    sys.exit(exit_code(app, sys.argv[1:] if arguments is None else arguments))

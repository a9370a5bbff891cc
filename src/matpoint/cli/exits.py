"""How errors become one line and an exit code."""

from __future__ import annotations

import os
import sys
import warnings
from typing import Any

from cyclopts import App, CycloptsError, MissingArgumentError

from matpoint.errors import InputError, MatpointError, Terminated


def _say(text: str) -> None:
    print(text, file=sys.stderr)


def _warning(message: Warning | str, *_: Any, **__: Any) -> None:
    _say(f"warning: {message}")


def _command_line(error: CycloptsError) -> str:
    """What is wrong with the command line, in one line."""
    if isinstance(error, MissingArgumentError) and error.argument is not None:
        return f"{' '.join(error.command_chain or ())}: {error.argument.names[0]} is missing"
    return str(error).replace("\n", " ").strip()


def exit_code(app: App, arguments: list[str]) -> int:
    """Run a command; return its exit code, and say in one line what went wrong."""
    warnings.showwarning = _warning
    try:
        app(arguments, exit_on_error=False, print_error=False)
    except MatpointError as error:
        _say(f"error: {error}")
        return error.exit_code
    except CycloptsError as error:
        _say(f"error: {_command_line(error)}")
        _say("see matpoint --help")
        return InputError.exit_code
    except KeyboardInterrupt as error:
        terminated = isinstance(error, Terminated)
        word = "terminated" if terminated else "interrupted"
        _say(f"{word}: what was written so far is complete and readable")
        return 143 if terminated else 130
    except BrokenPipeError:
        # Whoever read our output has gone; say nothing more to a closed pipe.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except OSError as error:
        _say(f"error: {error.filename or 'file'}: {error.strerror or error}")
        return InputError.exit_code
    except MemoryError:
        _say("error: not enough memory for this case; use fewer particles or larger cells")
        return InputError.exit_code
    return 0

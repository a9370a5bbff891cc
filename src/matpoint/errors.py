"""What matpoint raises when a user or a run goes wrong.

:class:`InputError` before anything has been computed or written, :class:`RunError` when a run cannot go on,
:class:`StudyError` when none of many could. The command line turns them into exit codes 2, 3 and 3.
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager


class MatpointError(Exception):
    """Base of every error that matpoint raises on purpose."""

    exit_code = 1


class InputError(MatpointError):
    """The input can't be used: the message says what, where, and what is allowed."""

    exit_code = 2


class NotFiniteError(InputError):
    """A load or a condition is not a finite number.

    Parameters
    ----------
    message
        What, and at what time.
    particle
        Internal index of the first particle concerned, or None.
    """

    def __init__(self, message: str, particle: int | None = None) -> None:
        super().__init__(message)
        self.particle = particle


def did_you_mean(word: str, known: Iterable[str]) -> str:
    """Return " (did you mean ...?)" or nothing."""
    near = difflib.get_close_matches(word, list(known), n=1)
    return f" (did you mean {near[0]!r}?)" if near else ""


@contextmanager
def naming(where: str) -> Iterator[None]:
    """Put a table and key before the message of what is refused inside, if they do not stand there yet."""
    try:
        yield
    except InputError as error:
        text = str(error)
        raise (error if text.startswith(where) else InputError(f"{where}: {text}")) from None


class Terminated(KeyboardInterrupt):
    """SIGTERM asked a run to end; it does so as after Ctrl-C, once its step is finished."""


class RunError(MatpointError):
    """A run failed after it had begun.

    Parameters
    ----------
    cause
        What went wrong and its likely reason, one sentence or two.
    step, time
        The step at which it failed and the time [s] at its start.
    particle
        The id of the first particle concerned, or None.
    position
        Its position [m], three components, or None.
    """

    exit_code = 3

    def __init__(
        self,
        cause: str,
        *,
        step: int,
        time: float,
        particle: int | None = None,
        position: Sequence[float] | None = None,
    ) -> None:
        self.cause, self.step, self.time = cause, step, time
        self.particle, self.position = particle, position
        where = f"step {step}, t = {time:.6g} s"
        if particle is not None:
            where += f", particle {particle}"
        if position is not None:
            where += " at (" + ", ".join(f"{x:.6g}" for x in position) + ") m"
        super().__init__(f"{where}: {cause}")


class StudyError(MatpointError):
    """No run of a study reached its end: the message says how many there were, and why the first failed."""

    exit_code = 3

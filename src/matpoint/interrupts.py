"""Ctrl-C and SIGTERM, held back while a step is made."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from matpoint.errors import Terminated


class Interrupt:
    """Ctrl-C or SIGTERM once: remembered until the step is done. Twice: at once."""

    def __init__(self) -> None:
        self.asked: KeyboardInterrupt | None = None

    def __call__(self, signum: int, frame: Any) -> None:
        if self.asked is not None:
            raise self.asked
        self.asked = Terminated() if signum == signal.SIGTERM else KeyboardInterrupt()


@contextmanager
def interruptible() -> Iterator[Interrupt]:
    """Hold back Ctrl-C and SIGTERM between the ends of steps, so that no file is cut in the middle."""
    interrupt = Interrupt()
    if threading.current_thread() is not threading.main_thread():
        yield interrupt
        return
    previous: dict[int, Any] = {signal.SIGINT: signal.signal(signal.SIGINT, interrupt)}
    if signal.getsignal(signal.SIGTERM) is signal.SIG_DFL:  # else the application has its own way
        previous[signal.SIGTERM] = signal.signal(signal.SIGTERM, interrupt)
    try:
        yield interrupt
    finally:
        for number, handler in previous.items():
            signal.signal(number, signal.SIG_DFL if handler is None else handler)

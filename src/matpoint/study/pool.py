"""Worker processes: fresh interpreters, one thread each; one that dies takes only its own run with it."""

from __future__ import annotations

import json
import os
import queue
import subprocess
import sys
import threading
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

_THREADS = ("NUMBA_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")


class _Worker:
    """A process, started when it is first needed and again after it has died."""

    def __init__(self) -> None:
        self._process: subprocess.Popen[str] | None = None

    def ask(self, given: dict[str, Any]) -> dict[str, Any] | str:
        """Return the answer to a task, or what became of the process."""
        if self._process is None:
            self._process = _start()
        process = self._process
        assert process.stdin is not None
        assert process.stdout is not None
        try:
            process.stdin.write(json.dumps(given) + "\n")
            process.stdin.flush()
            line = process.stdout.readline()
        except OSError:
            line = ""
        if line:
            return dict(json.loads(line))
        code, self._process = process.wait(), None
        return f"its process ended with code {code}" + (" (out of memory?)" if code == -9 else "")

    def stop(self) -> None:
        """End the process."""
        if self._process is not None:
            self._process.kill()
            self._process.wait()


def _start() -> subprocess.Popen[str]:
    root = str(Path(__file__).resolve().parents[2])
    paths = [root, *filter(None, [os.environ.get("PYTHONPATH")])]
    environment = os.environ | dict.fromkeys(_THREADS, "1") | {"PYTHONPATH": os.pathsep.join(paths)}
    return subprocess.Popen(
        [sys.executable, "-W", "ignore", "-c", "from matpoint.study.worker import main; main()"],
        stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, encoding="utf-8", env=environment,
        start_new_session=True,  # Ctrl-C is for the study, which ends them
    )  # fmt: skip


def answers(tasks: Sequence[dict[str, Any]], processes: int) -> Iterator[tuple[int, dict[str, Any] | str]]:
    """Yield the number of each task and its answer, in the order in which they are done.

    Parameters
    ----------
    tasks
        What workers are asked, the longest first.
    processes
        How many work side by side.
    """
    waiting: queue.SimpleQueue[int] = queue.SimpleQueue()
    for number in range(len(tasks)):
        waiting.put(number)
    done: queue.SimpleQueue[tuple[int, dict[str, Any] | str]] = queue.SimpleQueue()
    workers = [_Worker() for _ in range(min(processes, len(tasks)))]
    stopped = threading.Event()

    def serve(worker: _Worker) -> None:
        while not stopped.is_set():
            try:
                number = waiting.get_nowait()
            except queue.Empty:
                return
            answer = worker.ask(tasks[number])
            done.put((number, answer))

    threads = [threading.Thread(target=serve, args=(worker,), daemon=True) for worker in workers]
    for thread in threads:
        thread.start()
    try:
        for _ in tasks:
            yield done.get()
    finally:
        stopped.set()
        for worker in workers:
            worker.stop()

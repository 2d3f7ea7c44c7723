"""Tasks in processes of this machine."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from pathlib import Path

from .engine import Engine, Outcomes, Work
from .one_log import Outcome
from .settings import Settings


@contextmanager
def local_engine(work: Work, settings: Settings, workers: int | None) -> Iterator[Engine]:
    """Each log has a process of its own, so that one that is killed takes no other along."""
    yield partial(_run, work, settings, workers or _cores())


def _run(work: Work, settings: Settings, most: int, logs: Sequence[Path]) -> Outcomes:
    # Not "fork": a process with threads, as pyarrow and the core have, cannot be forked safely.
    context = multiprocessing.get_context("spawn")
    waiting = list(reversed(logs))
    running: dict[Connection, tuple[Path, BaseProcess]] = {}
    try:
        while waiting or running:
            while waiting and len(running) < most:
                log = waiting.pop()
                ours, theirs = context.Pipe(duplex=False)
                arguments = (theirs, work, settings, log)
                process: BaseProcess = context.Process(target=_worker, args=arguments, daemon=True)
                process.start()
                theirs.close()  # so that the end of the process ends the pipe
                running[ours] = log, process
            for connection in wait(list(running)):
                assert isinstance(connection, Connection)
                log, process = running.pop(connection)
                yield log, _outcome(connection, process)
    finally:
        for _, process in running.values():
            process.kill()
            process.join()


def _outcome(connection: Connection, process: BaseProcess) -> Outcome:
    with connection:
        try:
            outcome = connection.recv()
        except EOFError:
            process.join()
            return Outcome(failure=f"its process ended with exit code {process.exitcode}")
    process.join()
    assert isinstance(outcome, Outcome)
    return outcome


def _worker(connection: Connection, work: Work, settings: Settings, log: Path) -> None:
    # Ctrl-C reaches all processes of a terminal; the first one ends this one.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with_parent, daemon=True).start()
    connection.send(work(settings, log))


def _end_with_parent() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


def _cores() -> int:
    """Cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1

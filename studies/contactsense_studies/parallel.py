"""Trials on as many processes as wanted."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Callable, Generator, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import closing, contextmanager
from multiprocessing import active_children, get_context
from multiprocessing.process import BaseProcess
from typing import TypeVar

from .harness import Report, silent

Item = TypeVar("Item")
Result = TypeVar("Result")


def run_trials(
    function: Callable[[Item], Result],
    items: Sequence[Item],
    stage: str,
    processes: int | None = None,
    progress: Report = silent,
    weight: Callable[[Item], int] = lambda item: 1,
) -> tuple[list[Result], bool]:
    """`function` of each item, in the items' order, and whether these are all: Ctrl-C ends it early.

    Args:
        function: known by name, and depends on its item alone.
        items: what it is called with.
        stage: what `progress` is told after each item, with the weights of those done and of all.
        processes: default one a core; the results do not depend on it.
        progress: called after each item.
        weight: how much of the work an item is.
    """
    total, finished = sum(map(weight, items)), 0

    def done(item: Item) -> None:
        nonlocal finished
        finished += weight(item)
        progress(stage, finished, total)

    results: list[Result] = []
    with closing(_each(function, items, processes, done)) as found:
        try:
            results.extend(found)
        except KeyboardInterrupt:
            return results, False
    return results, True


def _each(
    function: Callable[[Item], Result],
    items: Sequence[Item],
    processes: int | None,
    done: Callable[[Item], None],
) -> Generator[Result, None, None]:
    count = min(processes or os.cpu_count() or 1, max(len(items), 1))
    if count == 1:
        for item in items:
            result = function(item)
            done(item)
            yield result
        return
    others, workers = set(active_children()), set[BaseProcess]()
    pool = ProcessPoolExecutor(count, mp_context=get_context("spawn"))
    try:
        with _ignoring_interrupts():
            found = pool.map(function, items)
            workers = set(active_children()) - others
        for item, result in zip(items, found, strict=True):
            done(item)
            yield result
        pool.shutdown()
    except BaseException:
        # An item may take many seconds, so whoever still works is not waited for.
        pool.shutdown(wait=False, cancel_futures=True)
        for worker in workers:
            worker.terminate()
        raise


@contextmanager
def _ignoring_interrupts() -> Iterator[None]:
    """Processes that start here leave Ctrl-C to this one, which stops them."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)

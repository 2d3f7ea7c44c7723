"""A function over many items, on as many processes as wanted."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from typing import TypeVar

Item = TypeVar("Item")
Result = TypeVar("Result")


def each(
    function: Callable[[Item], Result],
    items: Sequence[Item],
    processes: int | None,
    done: Callable[[Item], None],
) -> Iterator[Result]:
    """`function` of each item, in the items' order; `done` is told each that is finished.

    `processes`: default one a core. The function must be known by name, and depend on its item alone.
    """
    count = min(processes or os.cpu_count() or 1, max(len(items), 1))
    if count == 1:
        for item in items:
            yield function(item)
            done(item)
        return
    with ProcessPoolExecutor(count, mp_context=get_context("spawn")) as pool:
        for item, result in zip(items, pool.map(function, items), strict=True):
            done(item)
            yield result

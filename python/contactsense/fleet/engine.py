"""What runs the tasks of a fleet."""

from __future__ import annotations

from collections.abc import Callable, Generator, Sequence
from contextlib import AbstractContextManager
from pathlib import Path

from .one_log import Outcome
from .settings import Settings

Work = Callable[[Settings, Path], Outcome]
# As they come, in any order.
Outcomes = Generator[tuple[Path, Outcome], None, None]
Run = Callable[[Sequence[Path]], Outcomes]


def open_engine(
    name: str, work: Work, settings: Settings, workers: int | None, address: str | None
) -> AbstractContextManager[Run]:
    """The engine of a name; it runs until the context ends."""
    if name == "ray":
        from .on_ray import ray_engine

        return ray_engine(work, settings, workers, address)
    from .local import local_engine

    return local_engine(work, settings, workers)

"""Tasks of Ray, on this machine or on a cluster."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from itertools import islice
from pathlib import Path
from typing import Any

from .._extras import require
from ..errors import InputError
from .engine import Engine, Outcomes, Work
from .one_log import Outcome
from .settings import Settings

# Tasks that are submitted for each core: enough that no core waits for the next, and that a cluster that
# grows with its load sees some.
_AHEAD = 4


@contextmanager
def ray_engine(work: Work, settings: Settings, workers: int | None, address: str | None) -> Iterator[Engine]:
    """Uses a Ray that this process is connected to; if there is none, it starts or joins one."""
    require("fleet", "ray")
    import ray

    started = not ray.is_initialized()
    if started:
        _start(ray, workers, address)
    try:
        # Failed logs are retried by the caller, after all others.
        task = ray.remote(max_retries=0)(work)
        yield partial(_run, ray, partial(task.remote, ray.put(settings)))
    finally:
        if started:
            ray.shutdown()


def _run(ray: Any, submit: Any, logs: Sequence[Path]) -> Outcomes:
    ahead = _AHEAD * max(1, int(ray.cluster_resources().get("CPU", 1)))
    waiting = iter(logs)
    running: dict[Any, Path] = {}
    try:
        while True:
            for log in islice(waiting, ahead - len(running)):
                running[submit(log)] = log
            if not running:
                return
            (done,), _ = ray.wait(list(running))
            log = running.pop(done)
            try:
                outcome = ray.get(done)
            except ray.exceptions.RayError as error:
                outcome = Outcome(failure=str(error).strip().splitlines()[0])
            yield log, outcome
    finally:
        for reference in running:
            ray.cancel(reference, force=True)


def _start(ray: Any, workers: int | None, address: str | None) -> None:
    # Logs are the user's: nothing about work on them goes to Ray's makers unless the user asks for it.
    os.environ.setdefault("RAY_USAGE_STATS_ENABLED", "0")
    own: dict[str, Any] = {} if address else {"num_cpus": workers, "include_dashboard": False}
    try:
        ray.init(address=address, logging_level="error", log_to_driver=False, **own)
    except ConnectionError as error:
        raise InputError(f"address: no Ray cluster answers at {address!r}: {error}") from error

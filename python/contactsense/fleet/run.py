"""One run over the logs of a robot: which are wanted, and what became of them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager, closing
from pathlib import Path

from ..errors import InputError
from .dataset import Part, clear_unfinished
from .engine import Engine
from .local import local_engine
from .on_ray import ray_engine
from .one_log import Outcome, replay_log
from .result import FleetReplay
from .settings import Settings

# A log that fails may have found its machine short of memory, or a disk away.
_TRIES = 2


class Run:
    """What is known of each log so far."""

    def __init__(
        self, settings: Settings, logs: Sequence[Path], on_progress: Callable[[int, int], None] | None
    ) -> None:
        self._settings, self._logs, self._on_progress = settings, logs, on_progress
        self._outcomes: dict[Path, Outcome] = {}
        damages = {log: _damage_known(settings, log) for log in logs}
        self._unchanged = {log: damage for log, damage in damages.items() if damage is not None}

    def all(self, engine: str, workers: int | None, address: str | None) -> None:
        """Replays all logs that are wanted, and those that fail once more after all others."""
        settings = self._settings
        try:
            settings.folder.mkdir(parents=True, exist_ok=True)
        except OSError as cause:
            raise InputError(f"folder: cannot write to '{settings.folder}': {cause.strerror}") from cause
        clear_unfinished(settings.folder, settings.name)
        self._tell()
        try:
            if not self._wanted():
                return
            with _open(engine, settings, workers, address) as run:
                for _ in range(_TRIES):
                    with closing(run(self._wanted())) as outcomes:
                        for log, outcome in outcomes:
                            self._outcomes[log] = outcome
                            self._tell()
            for log in self._wanted():
                if log.exists():  # what is there of it is of another state or other settings
                    Part(settings.folder, settings.name, log).remove()
        finally:
            clear_unfinished(settings.folder, settings.name)

    def _wanted(self) -> list[Path]:
        """Logs that are not in the data set."""
        done = {log for log, outcome in self._outcomes.items() if not outcome.failure}
        return [log for log in self._logs if log not in self._unchanged and log not in done]

    def _tell(self) -> None:
        if self._on_progress is not None:
            self._on_progress(len(self._unchanged) + len(self._outcomes), len(self._logs))

    def result(self, interrupted: bool) -> FleetReplay:
        """What became of each log."""
        outcomes = {log: self._outcomes[log] for log in self._logs if log in self._outcomes}
        damages = {**self._unchanged, **{log: outcome.damage for log, outcome in outcomes.items()}}
        return FleetReplay(
            self._settings.folder,
            replayed=tuple(log for log, outcome in outcomes.items() if not outcome.failure),
            unchanged=tuple(self._unchanged),
            failed={log: outcome.failure for log, outcome in outcomes.items() if outcome.failure},
            damaged={log: damages[log] for log in self._logs if damages.get(log)},
            interrupted=interrupted,
        )


def _open(
    engine: str, settings: Settings, workers: int | None, address: str | None
) -> AbstractContextManager[Engine]:
    if engine == "ray":
        return ray_engine(replay_log, settings, workers, address)
    return local_engine(replay_log, settings, workers)


def _damage_known(settings: Settings, log: Path) -> str | None:
    """Of a log that the data set has with these settings; else None."""
    try:
        made_from = settings.input_of(log)
    except OSError:  # that it cannot be read is said by its task
        return None
    return Part(settings.folder, settings.name, log).damage(made_from)

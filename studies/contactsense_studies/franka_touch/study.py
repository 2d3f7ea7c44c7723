"""The study: all logs, the library's external torque beside the vendor's."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass

from contactsense import InputError, Robot

from ..example_robots import panda
from .logs import TouchLog, read_logs
from .replay import Replay, replay
from .settings import MEASURED, TUNING_FILES, VENDOR, Settings
from .summary import Summary, summarise
from .touches import LogResult, judge
from .tuning import choose_settings


@dataclass(frozen=True)
class Evaluation:
    """All logs with one source of the external torque."""

    settings: Settings
    replays: tuple[Replay, ...]
    logs: tuple[LogResult, ...]

    @property
    def overall(self) -> Summary:
        """All files."""
        return summarise(self.logs)

    @property
    def held_out(self) -> Summary:
        """The files on which nothing was chosen."""
        return summarise([log for log in self.logs if not log.tuning])


@dataclass(frozen=True)
class Study:
    """Both evaluations of the same logs."""

    logs: tuple[TouchLog, ...]
    measured: Evaluation
    vendor: Evaluation


def evaluate(robot: Robot, logs: Sequence[TouchLog], settings: Settings) -> Evaluation:
    """Runs the monitor over the logs and judges every touch."""
    replays = tuple(replay(robot, log, settings) for log in logs)
    judged = tuple(
        judge(robot, log, told, settings, log.name in TUNING_FILES)
        for log, told in zip(logs, replays, strict=True)
    )
    return Evaluation(settings, replays, judged)


def run(data: str | os.PathLike[str], *, tune: bool = False, plot_log: str | None = None) -> Study:
    """The study on a folder of logs; `tune` chooses the settings anew instead of taking the stored ones.

    Raises:
        InputError: the folder or a log cannot be used, or `plot_log` is none of the logs.
        MissingExtraError: example-robot-data is not installed.
    """
    logs = read_logs(data)
    names = [log.name for log in logs]
    if plot_log is not None and plot_log not in names:
        raise InputError(f"plot_log: there is no log '{plot_log}'; there are {', '.join(names)}")
    robot = panda()
    measured, vendor = MEASURED, VENDOR
    if tune:
        measured, vendor = (choose_settings(robot, logs, source) for source in ("measured", "vendor"))
    return Study(tuple(logs), evaluate(robot, logs, measured), evaluate(robot, logs, vendor))

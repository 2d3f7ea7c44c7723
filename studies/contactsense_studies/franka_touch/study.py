"""The study: all logs, the library's external torque beside the vendor's, as it comes and calibrated."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass

from contactsense import Calibration, InputError, Replay, Robot

from ..example_robots import panda
from .calibrated import calibrations_by_others, replay_calibrated
from .logs import TouchLog, log_files, read_log
from .replay import replay
from .settings import CALIBRATED, MEASURED, TUNING_FILES, VENDOR, Settings
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
    """All evaluations of the same logs.

    `calibrations` has one for each log, from the others; there are none, and `calibrated` is None, if a
    calibration needs more logs.
    """

    logs: tuple[TouchLog, ...]
    calibrations: tuple[Calibration, ...]
    measured: Evaluation
    vendor: Evaluation
    calibrated: Evaluation | None

    @property
    def evaluations(self) -> tuple[Evaluation, ...]:
        """Those there are."""
        return tuple(it for it in (self.measured, self.vendor, self.calibrated) if it is not None)


def evaluate(robot: Robot, logs: Sequence[TouchLog], settings: Settings) -> Evaluation:
    """Runs the monitor over the logs and judges every touch."""
    replays = [replay(robot, log, settings) for log in logs]
    return _judged(robot, logs, settings, [(told, settings) for told in replays])


def evaluate_calibrated(
    robot: Robot, logs: Sequence[TouchLog], calibrations: Sequence[Calibration]
) -> Evaluation:
    """Runs the monitor over each log with its calibration."""
    pairs = zip(logs, calibrations, strict=True)
    replays = [replay_calibrated(robot, log, calibration) for log, calibration in pairs]
    return _judged(robot, logs, CALIBRATED, replays)


def _judged(
    robot: Robot,
    logs: Sequence[TouchLog],
    settings: Settings,
    replays: Sequence[tuple[Replay, Settings]],
) -> Evaluation:
    results = [
        judge(robot, log, told, own, log.name in TUNING_FILES)
        for log, (told, own) in zip(logs, replays, strict=True)
    ]
    return Evaluation(settings, tuple(told for told, _ in replays), tuple(results))


def run(data: str | os.PathLike[str], *, tune: bool = False, plot_log: str | None = None) -> Study:
    """The study on a folder of logs; `tune` chooses the settings anew instead of taking the stored ones.

    Raises:
        InputError: the folder or a log cannot be used, or `plot_log` is none of the logs.
        MissingExtraError: example-robot-data is not installed.
    """
    files = log_files(data)
    robot = panda()
    logs = [read_log(file, robot) for file in files]
    names = [log.name for log in logs]
    if plot_log is not None and plot_log not in names:
        raise InputError(f"plot_log: there is no log '{plot_log}'; there are {', '.join(names)}")
    measured, vendor = MEASURED, VENDOR
    if tune:
        measured, vendor = (choose_settings(robot, logs, source) for source in ("measured", "vendor"))
    calibrations = calibrations_by_others(robot, logs)
    return Study(
        tuple(logs),
        calibrations,
        evaluate(robot, logs, measured),
        evaluate(robot, logs, vendor),
        evaluate_calibrated(robot, logs, calibrations) if calibrations else None,
    )

"""The vendor's torque with noise and levels from the untouched stretches of other logs.

Each log is judged with a calibration of the external torque that the other logs show while nobody touches the
arm: no setting of detection is chosen, and nothing of the log itself is known beforehand.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

import contactsense
from contactsense import Calibration, ContactMonitor, InputError, Log, Replay, Robot, calibrate

from .logs import BoolArray, TouchLog
from .settings import CALIBRATED, Settings
from .touches import EARLY

# Between the logs of a calibration, which thereby sees that they do not belong together [s].
PAUSE = 1.0


def untouched(log: TouchLog) -> BoolArray:
    """Rows `(n,)` outside the labels, and outside the time before them that counts as theirs."""
    free = ~log.label
    for first, last in log.touches:
        free &= (log.time < log.time[first] - EARLY) | (log.time > log.time[last])
    return free


def calibration_of(robot: Robot, logs: Sequence[TouchLog]) -> Calibration:
    """What the untouched stretches of logs show of the vendor's torque.

    Raises:
        InputError: there is no log, or they are too short in sum.
    """
    if not logs:
        raise InputError("data: a calibration takes the untouched stretches of other logs; there are none")
    times, rows = [], []
    start = 0.0
    for log in logs:
        free, vendor = untouched(log), log.vendor
        assert vendor.external_torque is not None  # it was read for it
        times.append(log.time[free] + start)
        rows.append(np.hstack([vendor.q, vendor.v, vendor.external_torque])[free])
        start = times[-1][-1] + PAUSE
    q, v, external = np.split(np.concatenate(rows), 3, axis=1)
    return calibrate(robot, Log(np.concatenate(times), q, v, external_torque=external))


def replay_calibrated(robot: Robot, log: TouchLog, calibration: Calibration) -> tuple[Replay, Settings]:
    """Runs the monitor over the vendor's torque of a log; the settings are those of its calibration."""
    monitor = ContactMonitor(robot, dt=log.dt, calibration=calibration)
    told = contactsense.replay(log.vendor, monitor)
    return told, replace(CALIBRATED, noise=tuple(monitor.torque_threshold))


def calibrations_by_others(robot: Robot, logs: Sequence[TouchLog]) -> tuple[Calibration, ...]:
    """For each log a calibration of all other logs; none where these are too few."""
    try:
        return tuple(calibration_of(robot, [other for other in logs if other is not log]) for log in logs)
    except InputError:
        return ()


def save_calibrations(
    logs: Sequence[TouchLog], calibrations: Sequence[Calibration], folder: Path
) -> list[Path]:
    """Writes each log's calibration as `NAME.yaml` into a folder; returns the files.

    Raises:
        InputError: there are none, or the folder cannot be written to.
    """
    if not calibrations:
        raise InputError("calibrations: the data has too few logs for them")
    try:
        folder.mkdir(parents=True, exist_ok=True)
        files = [folder / f"{log.name}.yaml" for log in logs]
        for file, calibration in zip(files, calibrations, strict=True):
            calibration.save(file, source=f"the logs other than {file.stem}, without contact")
    except OSError as cause:
        raise InputError(f"calibrations: cannot write into '{folder}': {cause.strerror or cause}") from cause
    return files

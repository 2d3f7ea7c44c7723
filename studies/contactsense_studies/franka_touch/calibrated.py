"""The vendor's torque with noise and levels from the untouched stretches of other logs.

Each log is judged with a calibration of the external torque that the other logs show while nobody touches the
arm: no setting of detection is chosen, and nothing of the log itself is known beforehand.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from contactsense import Calibration, ContactMonitor, InputError, Log, Robot, calibrate

from .logs import BoolArray, TouchLog
from .replay import Replay
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
        free = untouched(log)
        # Some rows come with the time of the row before.
        free[1:] &= np.diff(log.time) > 0.0
        times.append(log.time[free] - log.time[0] + start)
        rows.append(np.hstack([log.q, log.dq, log.vendor])[free])
        start = times[-1][-1] + PAUSE
    q, v, external = np.split(np.concatenate(rows), 3, axis=1)
    return calibrate(robot, Log(np.concatenate(times), q, v, external_torque=external))


def replay_calibrated(robot: Robot, log: TouchLog, calibration: Calibration) -> tuple[Replay, Settings]:
    """Runs the monitor over the vendor's torque of a log; the settings are those of its calibration."""
    monitor = ContactMonitor(robot, dt=log.dt, calibration=calibration)
    rows = zip(log.q, log.vendor, log.dq, strict=True)
    reports = [monitor.update_external(q, external, v=v) for q, external, v in rows]
    told = Replay(
        np.array([report.collision for report in reports]),
        np.array([report.onset for report in reports]),
        np.array([report.external_torque for report in reports]),
        tuple(next(iter(report.contacts), None) for report in reports),
    )
    return told, replace(CALIBRATED, noise=tuple(monitor.torque_threshold))


def replay_by_others(robot: Robot, logs: Sequence[TouchLog]) -> list[tuple[Replay, Settings]]:
    """Each log with a calibration of all other logs.

    Raises:
        InputError: there are too few other logs.
    """
    return [
        replay_calibrated(robot, log, calibration_of(robot, [other for other in logs if other is not log]))
        for log in logs
    ]

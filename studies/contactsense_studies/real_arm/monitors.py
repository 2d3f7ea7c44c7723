"""The monitors that are compared, and what each says of a log. No truth in here."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from contactsense import Calibration, ContactMonitor, Robot
from contactsense.log import Log

from .records import DT

# In the order of tables, pictures and results.
MONITORS = ("default", "thresholds", "calibrated")
TITLES = {
    "default": "uncalibrated, default thresholds",
    "thresholds": "uncalibrated, thresholds of this arm",
    "calibrated": "calibrated",
}
# Thresholds above the largest external torque of a contact-free log.
MARGIN = 1.2
# The observer's first rows, still settling [s].
SETTLING = 0.5
# A threshold that nothing exceeds, to see the external torque alone [Nm].
_NEVER = 1e9


@dataclass(frozen=True, eq=False)
class Heard:
    """What a monitor said of every row of a log."""

    onset: NDArray[np.bool_]  # (n,)
    collision: NDArray[np.bool_]  # (n,)
    external_torque: NDArray[np.float64]  # (n, nv) [Nm]


def settings(robot: Robot, everyday: Log, calibration: Calibration) -> dict[str, dict[str, Any]]:
    """Arguments of each monitor besides the robot and `dt`."""
    return {
        "default": {},
        "thresholds": {"torque_threshold": thresholds(robot, everyday)},
        "calibrated": {"calibration": calibration},
    }


def thresholds(robot: Robot, log: Log) -> NDArray[np.float64]:
    """(nv,) `MARGIN` times the largest external torque of a log without contact [Nm]."""
    heard = hear(robot, log, torque_threshold=_NEVER)
    settled = log.time > log.time[0] + SETTLING
    largest: NDArray[np.float64] = MARGIN * np.abs(heard.external_torque[settled]).max(axis=0)
    return largest


def hear(robot: Robot, log: Log, **arguments: Any) -> Heard:
    """Runs a monitor over a log as a controller would, with the steps that the time stamps show."""
    assert log.tau is not None
    monitor = ContactMonitor(robot, dt=DT, **arguments)
    onset, collision = np.zeros(len(log), dtype=bool), np.zeros(len(log), dtype=bool)
    torque = np.empty((len(log), robot.nv))
    steps = np.diff(log.time, prepend=log.time[0] - DT)
    for row, (q, v, tau, step) in enumerate(zip(log.q, log.v, log.tau, steps, strict=True)):
        report = monitor.update(q, v, tau, dt=step)
        onset[row], collision[row], torque[row] = report.onset, report.collision, report.external_torque
    return Heard(onset, collision, torque)

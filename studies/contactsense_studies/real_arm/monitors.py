"""The monitors that are compared, and what each says of a log. No truth in here."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from contactsense import Calibration, Contact, ContactMonitor, ContactReport, Robot
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
# Where a contact is, is read from a report at most so long after the onset, as a reaction would [s].
REACTION = 0.5
# A threshold that nothing exceeds, to see the external torque alone [Nm].
_NEVER = 1e9


@dataclass(frozen=True, eq=False)
class Latest:
    """The last report with contacts, of those up to `REACTION` after an onset."""

    onset: int  # row
    row: int  # of the report
    contacts: tuple[Contact, ...]


@dataclass(frozen=True, eq=False)
class Heard:
    """What a monitor said of every row of a log."""

    onset: NDArray[np.bool_]  # (n,)
    collision: NDArray[np.bool_]  # (n,)
    external_torque: NDArray[np.float64]  # (n, nv) [Nm]
    # By number of the stretch of rows that was asked for; none without an onset or a contact in it.
    latest: Mapping[int, Latest] = field(default_factory=dict)


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


def hear(robot: Robot, log: Log, stretches: Sequence[slice] = (), **arguments: Any) -> Heard:
    """Runs a monitor over a log as a controller would, with the steps that the time stamps show.

    Args:
        robot: as described.
        log: what it measured.
        stretches: of rows, each of which is to have its `Latest`.
        arguments: of the monitor.
    """
    assert log.tau is not None
    monitor = ContactMonitor(robot, dt=DT, **arguments)
    onset, collision = np.zeros(len(log), dtype=bool), np.zeros(len(log), dtype=bool)
    torque = np.empty((len(log), robot.nv))
    listener = _Listener(log.time, stretches)
    steps = np.diff(log.time, prepend=log.time[0] - DT)
    for row, (q, v, tau, step) in enumerate(zip(log.q, log.v, log.tau, steps, strict=True)):
        report = monitor.update(q, v, tau, dt=step)
        onset[row], collision[row], torque[row] = report.onset, report.collision, report.external_torque
        listener.hear(row, report)
    return Heard(onset, collision, torque, listener.latest)


class _Listener:
    """Keeps the `Latest` of each stretch, while reports come in."""

    def __init__(self, time: NDArray[np.float64], stretches: Sequence[slice]) -> None:
        self.latest: dict[int, Latest] = {}
        self._time = time
        self._onsets: dict[int, int] = {}
        self._stretch = np.full(len(time), -1)
        for number, rows in enumerate(stretches):
            self._stretch[rows] = number

    def hear(self, row: int, report: ContactReport) -> None:
        number = int(self._stretch[row])
        if number < 0:
            return
        if report.onset:
            self._onsets.setdefault(number, row)
        onset = self._onsets.get(number)
        if onset is None or self._time[row] > self._time[onset] + REACTION:
            return
        if contacts := report.contacts:
            self.latest[number] = Latest(onset, row, contacts)

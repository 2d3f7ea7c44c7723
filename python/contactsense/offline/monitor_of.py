"""The monitor and the classifier for a log."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from .. import _core
from ..errors import InputError
from ..log import Log


def monitor_of(log: Log, robot: _core.Robot, **arguments: Any) -> _core.ContactMonitor:
    """A monitor at the rate of a log's rows; `arguments` are those of `ContactMonitor` but `dt`."""
    if len(log) < 2:
        raise InputError(f"log: has {len(log)} rows; at least 2 are wanted")
    return _core.ContactMonitor(robot, dt=float(np.median(np.diff(log.time))), **arguments)


def classifier_of(
    monitor: _core.ContactMonitor, arguments: Mapping[str, Any] | None
) -> _core.ContactClassifier | None:
    """A classifier for a monitor's reports; `arguments` are its own but `dt`, None for no classifier."""
    return None if arguments is None else _core.ContactClassifier(monitor.robot, dt=monitor.dt, **arguments)

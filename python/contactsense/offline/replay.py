"""A log through a monitor, row by row as a control loop would have called it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from .. import _core
from ..errors import InputError
from ..log import Log
from .collect import Collector
from .result import Replay

# Rows between two reports of progress, or until Ctrl-C is heard: a fraction of a second.
_CHUNK = 2048

Progress = Callable[[int, int], None]


def replay(
    log: Log,
    monitor: _core.ContactMonitor,
    *,
    classifier: _core.ContactClassifier | None = None,
    on_progress: Progress | None = None,
) -> Replay:
    """Gives every row of a log to a monitor, as a control loop would have.

    The monitor is called with the time between two rows as `dt`, and continues from the state that it has: a
    new one, or one that has been reset, starts afresh. Answers are those of the live loop on the same
    samples, bit for bit. Ctrl-C ends it early, with the rows until then.

    Args:
        log: of the monitor's robot; where it has no `tau`, its `external_torque` is taken.
        monitor: its `dt` is that of the first row.
        classifier: says of each contact what kind it is; of the monitor's robot, and it continues from the
            state that it has. None: contacts have no classes.
        on_progress: called from time to time with the number of rows done and of all rows.

    Returns:
        A `Replay`: contacts, and columns of all ticks.

    Raises:
        InputError: the log is not one of the monitor's robot; names the argument.

    Example:
        >>> import contactsense as cs, numpy as np
        >>> robot = cs.Robot.named("iiwa14")
        >>> q = robot.neutral()
        >>> still = robot.inverse_dynamics(q, np.zeros(7), np.zeros(7))
        >>> log = cs.Log(np.arange(100) / 1000, [q] * 100, np.zeros((100, 7)), [still] * 100)
        >>> result = cs.replay(log, cs.ContactMonitor(robot, dt=0.001))
        >>> len(result.contacts), int(result.ticks["collision"].sum())
        (0, 0)
    """
    _check(log, monitor, classifier)
    collector = Collector(log, monitor, classified=classifier is not None)
    rows = len(log)
    interrupted = False
    try:
        for start in range(0, rows, _CHUNK):
            chunk = slice(start, min(start + _CHUNK, rows))
            arrays, readings = _arrays(log, chunk), _readings(log, chunk)
            collector.add(chunk, *monitor._update_rows(arrays, readings, log.tau is None, classifier))
            if on_progress is not None:
                on_progress(chunk.stop, rows)
    except KeyboardInterrupt:
        interrupted = True
    return collector.result(interrupted)


def _arrays(log: Log, chunk: slice) -> list[NDArray[np.float64]]:
    """Positions, velocities and torques of some rows, and the steps to them, all flat."""
    # The first row of all has the monitor's step; a NaN says so.
    before = log.time[chunk.start - 1] if chunk.start else np.nan
    tau = log.external_torque if log.tau is None else log.tau
    assert tau is not None  # a log has one of them
    steps = np.diff(log.time[chunk], prepend=before)
    return [log.q[chunk].ravel(), log.v[chunk].ravel(), tau[chunk].ravel(), steps]


def _readings(log: Log, chunk: slice) -> NDArray[np.float64] | None:
    """Readings of all sensors, a row each."""
    return None if log.wrenches is None else log.wrenches[chunk].reshape(-1, 6)


def _check(log: Log, monitor: _core.ContactMonitor, classifier: _core.ContactClassifier | None) -> None:
    if not isinstance(log, Log):
        raise InputError(f"log: expected a contactsense.Log, got {type(log).__name__}")
    if not isinstance(monitor, _core.ContactMonitor):
        raise InputError(f"monitor: expected a contactsense.ContactMonitor, got {type(monitor).__name__}")
    robot = monitor.robot
    if log.q.shape[1] != robot.nq or log.v.shape[1] != robot.nv:
        shapes = f"q {log.q.shape[1]} and v {log.v.shape[1]} columns"
        raise InputError(f"log: has {shapes}; the monitor's robot has nq = {robot.nq} and nv = {robot.nv}")
    sensors = 0 if log.wrenches is None else log.wrenches.shape[1]
    if sensors != len(monitor.sensors):
        raise InputError(f"log: has wrenches of {sensors} sensors; the monitor has {len(monitor.sensors)}")
    if classifier is None:
        return
    if not isinstance(classifier, _core.ContactClassifier):
        raise InputError(
            f"classifier: expected a contactsense.ContactClassifier, got {type(classifier).__name__}"
        )
    if (classifier.robot.nq, classifier.robot.nv) != (robot.nq, robot.nv):
        raise InputError(f"classifier: is of '{classifier.robot.name}', the monitor of '{robot.name}'")

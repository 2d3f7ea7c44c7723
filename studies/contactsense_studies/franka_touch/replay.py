"""A log through `ContactMonitor`, as `contactsense replay` does it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

import contactsense
from contactsense import ContactMonitor, Log, Replay, Robot

from .logs import FloatArray, TouchLog
from .settings import Settings

# Rows this near to the first touch may already be part of it [s].
UNTOUCHED_MARGIN = 0.3
# The observer's first rows, still settling [s].
SETTLING = 0.2
# No torque reaches it: the bias that a monitor with this threshold takes off is none [Nm].
NEVER = 1e6


def replay(robot: Robot, log: TouchLog, settings: Settings) -> Replay:
    """Runs the monitor over a log.

    Rows that repeat the one before are given to it too: a controller that runs faster than its robot's
    messages sees just that.
    """
    monitor = ContactMonitor(
        robot,
        dt=log.dt,
        observer_gain=settings.observer_gain,
        torque_threshold=settings.detection_threshold,
        bias_time_constant=settings.bias_time_constant,
        hold_time=settings.hold_time,
        samples=0,  # its contacts are not asked for: `judge` names links from the mean torque of a touch
    )
    return contactsense.replay(signals(log, settings), monitor)


def signals(log: TouchLog, settings: Settings) -> Log:
    """The log with the torques that the settings are for."""
    return log.measured if settings.source == "measured" else log.vendor


def noise(robot: Robot, log: TouchLog, settings: Settings) -> FloatArray:
    """Standard deviation of the external torque before the first touch `(7,)` [Nm]."""
    monitor = ContactMonitor(
        robot, dt=log.dt, observer_gain=settings.observer_gain, torque_threshold=NEVER, samples=0
    )
    until = log.time[log.touches[0][0]] - UNTOUCHED_MARGIN
    ticks = contactsense.replay(
        signals(log, settings)[: int(np.count_nonzero(log.time < until))], monitor
    ).ticks
    deviation: FloatArray = ticks["external_torque"][ticks["time"] > SETTLING].std(axis=0)
    return deviation


def with_noise_of(robot: Robot, logs: list[TouchLog], settings: Settings) -> Settings:
    """Settings with the noise of these logs: root of the mean variance, to two digits."""
    variance = np.mean([noise(robot, log, settings) ** 2 for log in logs], axis=0)
    return replace(settings, noise=tuple(float(f"{deviation:.1e}") for deviation in np.sqrt(variance)))

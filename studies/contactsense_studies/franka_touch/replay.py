"""A log through `ContactMonitor`, row by row as a controller would have called it."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from contactsense import Contact, ContactMonitor, MomentumObserver, Robot

from .logs import BoolArray, FloatArray, TouchLog
from .settings import Settings

# Passes the vendor's torque, which is filtered already, through the observer unchanged [1/s].
VENDOR_GAIN = 1e5
# Rows this near to the first touch may already be part of it [s].
UNTOUCHED_MARGIN = 0.3
# The observer's first rows, still settling [s].
SETTLING = 0.2


@dataclass(frozen=True)
class Replay:
    """What the monitor said of every row."""

    collision: BoolArray  # (n,)
    onset: BoolArray  # (n,)
    external_torque: FloatArray  # (n, 7), free of bias [Nm]
    # The first of each row, where the monitor's own contacts are judged.
    contacts: tuple[Contact | None, ...] = ()


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
    )
    dq, tau = signals(robot, log, settings)
    reports = [monitor.update(*row) for row in zip(log.q, dq, tau, strict=True)]
    return Replay(
        np.array([report.collision for report in reports]),
        np.array([report.onset for report in reports]),
        np.array([report.external_torque for report in reports]),
    )


def signals(robot: Robot, log: TouchLog, settings: Settings) -> tuple[FloatArray, FloatArray]:
    """Velocity and torque `(n, 7)` for the observer: measured, or such that it sees the vendor's torque."""
    if settings.source == "measured":
        return log.dq, log.tau
    still = np.zeros(robot.nv)
    weight = np.array([robot.inverse_dynamics(q, still, still) for q in log.q])
    return np.zeros_like(log.dq), weight - log.vendor


def noise(robot: Robot, log: TouchLog, settings: Settings) -> FloatArray:
    """Standard deviation of the external torque before the first touch `(7,)` [Nm]."""
    observer = MomentumObserver(robot, dt=log.dt, gain=settings.observer_gain)
    dq, tau = signals(robot, log, settings)
    torque = np.array([observer.update(*row) for row in zip(log.q, dq, tau, strict=True)])
    until = log.time[log.touches[0][0]] - UNTOUCHED_MARGIN
    rows = (log.time > log.time[0] + SETTLING) & (log.time < until)
    deviation: FloatArray = torque[rows].std(axis=0)
    return deviation


def with_noise_of(robot: Robot, logs: list[TouchLog], settings: Settings) -> Settings:
    """Settings with the noise of these logs: root of the mean variance, to two digits."""
    variance = np.mean([noise(robot, log, settings) ** 2 for log in logs], axis=0)
    return replace(settings, noise=tuple(float(f"{deviation:.1e}") for deviation in np.sqrt(variance)))

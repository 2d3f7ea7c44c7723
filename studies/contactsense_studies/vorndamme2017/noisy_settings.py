"""What a user who knows the noise tells the isolator of it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from contactsense import Robot
from contactsense.sim._arrays import FloatArray

from .instruments import Method, external_torque, external_wrenches, sensor_links
from .isolation import THRESHOLD, Setting
from .noise import Noise
from .scenes import Scene

SIGMAS = 3.0  # threshold over noise


def stated_settings(
    robot: Robot, scenes: Sequence[Scene], method: Method, noise: Noise
) -> tuple[Setting, Setting]:
    """Thresholds of three standard deviations at usual torques and wrenches, or a noise model of the torques.

    Usual: the root mean square of those that are not nil, of each coordinate, and of each component of a
    sensor. The noise model's thresholds are those of the untouched robot.
    """
    torques = np.array([external_torque(robot, scene) for scene in scenes])
    limits = np.maximum(SIGMAS * noise.on_torques(_usual(torques)), THRESHOLD)
    wrench_threshold: float | tuple[tuple[float, ...], ...] = THRESHOLD
    if sensors := sensor_links(method):
        wrenches = np.array([external_wrenches(robot, scene, sensors) for scene in scenes])
        wrench_limits = np.maximum(SIGMAS * noise.on_wrenches(_usual(wrenches)), THRESHOLD)
        wrench_threshold = tuple(tuple(row) for row in wrench_limits.tolist())
    return (
        Setting(method, noise, "thresholds", tuple(limits.tolist()), wrench_threshold),
        Setting(method, noise, "noise model", None, wrench_threshold),
    )


def _usual(values: FloatArray) -> FloatArray:
    counted = np.maximum((values != 0.0).sum(axis=0), 1)
    usual: FloatArray = np.sqrt((values**2).sum(axis=0) / counted)
    return usual

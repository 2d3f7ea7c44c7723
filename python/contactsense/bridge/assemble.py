"""The robot and the monitor of a configuration."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from .. import _core
from ..calibration import Calibration
from ..errors import InputError
from ..robot import DESCRIPTIONS, Robot
from .configuration import Configuration


def robot_of(configuration: Configuration, package_dirs: Sequence[Path] = ()) -> Robot:
    """The robot; packages are looked for in further folders as well.

    Raises:
        InputError: it has a floating base, whose pose joint states do not tell.
        ModelError, GeometryError: the description cannot be used.
    """
    if configuration.robot in DESCRIPTIONS:
        robot = Robot.named(configuration.robot)
    else:
        robot = Robot.from_urdf(
            configuration.robot,
            package_dirs=[*configuration.package_dirs, *package_dirs],
            geometry=configuration.geometry,
            locked_joints=configuration.locked_joints or None,
            missing_meshes="warn",
        )
    if robot.floating_base:
        raise InputError(f"robot: {robot.name} has a floating base; joint states do not tell where it is")
    return robot


def monitor_of(configuration: Configuration, robot: Robot) -> _core.ContactMonitor:
    """The monitor.

    Raises:
        InputError: an entry does not fit the robot; names it.
    """
    sensors = [
        _core.ForceTorqueSensor(name, sensor.link, convention=sensor.convention)
        for name, sensor in configuration.sensors.items()
    ]
    path = configuration.calibration
    arguments: dict[str, Any] = {}
    if configuration.torque_threshold is not None:
        arguments["torque_threshold"] = configuration.torque_threshold
    return _core.ContactMonitor(
        robot,
        dt=1.0 / configuration.rate,
        sensors=sensors,
        wanted_contacts=[name for name, sensor in configuration.sensors.items() if sensor.wanted],
        observer_gain=configuration.observer_gain,
        wrench_threshold=configuration.wrench_threshold,
        bias_time_constant=configuration.bias_time,
        calibration=None if path is None else Calibration.load(path),
        **arguments,
    )

"""Which force/torque sensors a log is asked for."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from .. import _core
from ..errors import InputError

# Each sensor or its name, and where its readings are: a topic, a pattern of columns or all six; None to find
# out.
Sensors = (
    Iterable[_core.ForceTorqueSensor | str]
    | Mapping[_core.ForceTorqueSensor | str, str | Sequence[str] | None]
)

# Two frames nearer to each other than this [m, rad] are one, as numbers of descriptions are rounded.
_SAME = 1e-6


@dataclass(frozen=True)
class WantedSensor:
    """A sensor and where its readings are; `sensor` is None where only a name is known."""

    name: str
    sensor: _core.ForceTorqueSensor | None
    source: str | Sequence[str] | None

    @property
    def link(self) -> str:
        """Its link; empty where only a name is known."""
        return "" if self.sensor is None else self.sensor.link

    def frame_note(self, frame: str, robot: _core.Robot) -> str:
        """What is to be said of readings in a frame of that name; empty if it is the sensor's.

        Raises:
            InputError: the robot has this frame, and it is not the sensor's.
        """
        if not frame or self.sensor is None:
            return ""
        links = robot.all_link_names
        known = next((it for it in (frame, frame.rpartition("/")[2]) if it in links), None)
        if known is None and frame == self.name:
            return ""
        if known is None:
            return f"; the robot has no frame '{frame}', which is taken as the sensor's"
        place, elsewhere = (
            np.linalg.solve(robot.link_pose(q, self.link), robot.link_pose(q, known))
            for q in (robot.neutral(), robot.random_configuration(0))
        )
        if np.abs(place - elsewhere).max() > _SAME:
            where = f"which moves against its link '{self.link}'"
        elif np.abs(place - self.sensor.pose).max() > _SAME:
            where = f"which is not its frame: give the sensor pose={place.round(9).tolist()}"
        else:
            return ""
        raise InputError(
            f"sensors: readings of '{self.name}' are in the frame '{known}', {where}; "
            "where the messages name a wrong frame, give its name in place of the sensor"
        )


def wanted_sensors(given: Sensors, robot: _core.Robot) -> tuple[WantedSensor, ...]:
    """What `read_log` was asked for, in the order of the readings.

    Raises:
        InputError: it is no sensor or name, or two have one name.
    """
    if isinstance(given, str | _core.ForceTorqueSensor) or not isinstance(given, Iterable):
        raise InputError("sensors: must be a sequence or a mapping of sensors, or of their names")
    pairs = given.items() if isinstance(given, Mapping) else [(it, None) for it in given]
    wanted = [_wanted(sensor, source, robot) for sensor, source in pairs]
    names = [it.name for it in wanted]
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise InputError(f"sensors: '{twice}' is there twice")
    return tuple(wanted)


def _wanted(
    sensor: _core.ForceTorqueSensor | str, source: str | Sequence[str] | None, robot: _core.Robot
) -> WantedSensor:
    is_list = isinstance(source, Sequence) and all(isinstance(name, str) for name in source)
    if source is not None and not is_list:
        raise InputError("sensors: readings are named by a topic, a pattern or six columns")
    if isinstance(sensor, str):
        return WantedSensor(sensor, None, source)
    if not isinstance(sensor, _core.ForceTorqueSensor):
        raise InputError(
            f"sensors: must be of contactsense.ForceTorqueSensor or names, not {type(sensor).__name__}"
        )
    if sensor.link not in robot.all_link_names:
        raise InputError(f"sensors: '{sensor.name}' is at '{sensor.link}', which the robot does not have")
    return WantedSensor(sensor.name, sensor, source)

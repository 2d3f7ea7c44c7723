"""A log with what was found, as an MCAP file of ROS 2 messages."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import _core
from .._extras import require
from ..log import Log
from ..log.base_frames import base_frames, placed
from ..log.joint_columns import JointColumns
from .ros_messages import JOINT_STATE, MARKERS, NANOSECONDS, WRENCH, Marker, Messages
from .whole import whole_file

JOINT_STATES = "/joint_states"
BASE = "/base"
EXTERNAL_TORQUE = "/contactsense/external_torque"
CONTACTS = "/contactsense/contacts"
# Size of what is drawn: a hundred newtons are a metre, and a point is a ball of two centimetres [m].
_METRES_PER_NEWTON = 0.01
_BALL = 0.02
_SHAFT, _HEAD = 0.01, 0.02


Columns = Mapping[str, NDArray[Any]]


def write_mcap(
    log: Log,
    ticks: Columns,
    found: Columns,
    path: str | os.PathLike[str],
    robot: _core.Robot,
    sensors: Sequence[_core.ForceTorqueSensor],
) -> None:
    """A log with the columns of its ticks and of contacts in them; the file appears whole or not at all."""
    require("log", "rosbags", "mcap")
    from mcap.writer import Writer

    messages = Messages()
    with whole_file(path) as file, file.open("wb") as stream:
        writer: Any = Writer(stream)
        writer.start(profile="ros2", library="contactsense")
        channels = {}
        kinds = {
            JOINT_STATES: JOINT_STATE,
            EXTERNAL_TORQUE: JOINT_STATE,
            CONTACTS: MARKERS,
        }
        if robot.floating_base:
            kinds[BASE] = "nav_msgs/msg/Odometry"
        kinds |= {_topic(sensor): WRENCH for sensor in sensors}
        for topic, kind in kinds.items():
            schema = writer.register_schema(kind, "ros2msg", messages.definition(kind))
            channels[topic] = (writer.register_channel(topic, "cdr", schema), kind)
        for number, (stamp, topic, message) in enumerate(_all(log, ticks, found, robot, sensors, messages)):
            channel, kind = channels[topic]
            writer.add_message(channel, stamp, messages.pack(message, kind), stamp, number)
        writer.finish()


def _all(
    log: Log,
    ticks: Columns,
    found: Columns,
    robot: _core.Robot,
    sensors: Sequence[_core.ForceTorqueSensor],
    messages: Messages,
) -> Iterator[tuple[int, str, Any]]:
    """All messages in the order of time; stamps are in nanoseconds."""
    joints = JointColumns(robot)
    names = list(joints.names)
    frames = base_frames(robot) if robot.floating_base else None
    base_poses = log.q[:, :7] if frames is None else placed(frames.origin, log.q[:, :7])
    base_link = "" if frames is None else next(iter(frames.own), "")
    position = joints.positions(log.q)
    columns = [joints.velocities(rows) for rows in (log.v, ticks["external_torque"])]
    effort = np.zeros((len(log), 0)) if log.tau is None else joints.velocities(log.tau)
    first = np.searchsorted(found["row"], np.arange(len(ticks["time"]) + 1))
    lifetime = round(2.0 * NANOSECONDS * float(np.median(np.diff(log.time)))) if len(log) > 1 else 0
    for row, time in enumerate(ticks["time"].tolist()):
        stamp = round(time * NANOSECONDS)
        if frames is not None:
            yield stamp, BASE, messages.odometry(stamp, base_poses[row], log.v[row], base_link)
        if log.wrenches is not None:
            for sensor, reading in zip(sensors, log.wrenches[row].tolist(), strict=True):
                yield stamp, _topic(sensor), messages.wrench(stamp, _frame(sensor), reading)
        state = messages.joint_state(stamp, names, position[row], columns[0][row], effort[row])
        yield stamp, JOINT_STATES, state
        yield stamp, EXTERNAL_TORQUE, messages.joint_state(stamp, names, effort=columns[1][row])
        markers = []
        for k in range(int(first[row]), int(first[row + 1])):
            point, force = found["point"][k], found["force"][k]
            if not np.all(np.isfinite(point)):
                continue
            number = int(found["id"][k]) % (1 << 31)
            ball = (_BALL, _BALL, _BALL)
            markers.append(messages.marker(stamp, number, Marker.SPHERE, [point], ball, lifetime))
            if np.all(np.isfinite(force)):
                ends = [point - _METRES_PER_NEWTON * force, point]
                scale = (_SHAFT, _HEAD, 0.0)
                markers.append(messages.marker(stamp, number, Marker.ARROW, ends, scale, lifetime))
        if markers:
            yield stamp, CONTACTS, messages.markers(markers)


def _topic(sensor: _core.ForceTorqueSensor) -> str:
    return f"/{sensor.name}/wrench"


def _frame(sensor: _core.ForceTorqueSensor) -> str:
    """The frame of the readings: the link's, or one of the sensor's own."""
    return sensor.link if np.array_equal(sensor.pose, np.eye(4)) else sensor.name

"""A log with what was found, as an MCAP file of ROS 2 messages."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import _core
from .._extras import require
from ..log import Log
from ..log.base_frames import base_frames, placed
from ..log.joint_columns import JointColumns
from .whole import whole_file

JOINT_STATES = "/joint_states"
BASE = "/base"
EXTERNAL_TORQUE = "/contactsense/external_torque"
CONTACTS = "/contactsense/contacts"
# Size of what is drawn: a hundred newtons are a metre, and a point is a ball of two centimetres [m].
_METRES_PER_NEWTON = 0.01
_BALL = 0.02
_SHAFT, _HEAD = 0.01, 0.02
_NANOSECONDS = 1_000_000_000


class _Messages:
    """Makes and packs messages."""

    def __init__(self) -> None:
        from rosbags.typesys import Stores, get_typestore

        self._store = get_typestore(Stores.ROS2_HUMBLE)
        self._types: Any = self._store.types

    def definition(self, kind: str) -> bytes:
        return self._store.generate_msgdef(kind)[0].encode()

    def pack(self, message: Any, kind: str) -> bytes:
        return bytes(self._store.serialize_cdr(message, kind))

    def header(self, time: float) -> Any:
        seconds, nanoseconds = divmod(round(time * _NANOSECONDS), _NANOSECONDS)
        stamp = self._types["builtin_interfaces/msg/Time"](seconds, nanoseconds)
        return self._types["std_msgs/msg/Header"](stamp, "world")

    def joint_state(self, time: float, names: list[str], *values: Any) -> Any:
        none = np.zeros(0)
        position, velocity, effort = (none if it is None else it for it in values)
        return self._types["sensor_msgs/msg/JointState"](self.header(time), names, position, velocity, effort)

    def odometry(self, time: float, q: NDArray[np.float64], v: NDArray[np.float64], base: str) -> Any:
        make, none = self._types, np.zeros(36)
        point, quaternion, pose, vector, twist = (
            make[f"geometry_msgs/msg/{name}"] for name in ("Point", "Quaternion", "Pose", "Vector3", "Twist")
        )
        with_pose, with_twist = (
            make[f"geometry_msgs/msg/{name}WithCovariance"] for name in ("Pose", "Twist")
        )
        place = pose(point(*q[:3].tolist()), quaternion(*q[3:7].tolist()))
        speed = twist(vector(*v[:3].tolist()), vector(*v[3:6].tolist()))
        return make["nav_msgs/msg/Odometry"](
            self.header(time), base, with_pose(place, none), with_twist(speed, none)
        )

    def marker(
        self, time: float, number: int, shape: int, points: list[Any], scale: Any, seconds: float
    ) -> Any:
        make = self._types
        geometry = ("Point", "Vector3", "Quaternion", "Pose")
        point, vector, quaternion, pose = (make[f"geometry_msgs/msg/{name}"] for name in geometry)
        colour = make["std_msgs/msg/ColorRGBA"]
        whole, part = divmod(round(seconds * _NANOSECONDS), _NANOSECONDS)
        at = points[0] if shape == _Marker.SPHERE else np.zeros(3)
        fields = dict(
            header=self.header(time),
            ns="contact" if shape == _Marker.SPHERE else "force",
            id=number,
            type=shape,
            action=0,
            pose=pose(point(*map(float, at)), quaternion(0.0, 0.0, 0.0, 1.0)),
            scale=vector(*map(float, scale)),
            color=colour(0.9, 0.2, 0.1, 1.0),
            lifetime=make["builtin_interfaces/msg/Duration"](whole, part),
            frame_locked=False,
            points=[] if shape == _Marker.SPHERE else [point(*map(float, it)) for it in points],
            colors=[],
            texture_resource="",
            texture=make["sensor_msgs/msg/CompressedImage"](
                self.header(time), "", np.zeros(0, dtype=np.uint8)
            ),
            uv_coordinates=[],
            text="",
            mesh_resource="",
            mesh_file=make["visualization_msgs/msg/MeshFile"]("", np.zeros(0, dtype=np.uint8)),
            mesh_use_embedded_materials=False,
        )
        return make["visualization_msgs/msg/Marker"](**fields)

    def markers(self, markers: list[Any]) -> Any:
        return self._types["visualization_msgs/msg/MarkerArray"](markers)


class _Marker:
    ARROW, SPHERE = 0, 2


Columns = Mapping[str, NDArray[Any]]


def write_mcap(
    log: Log, ticks: Columns, found: Columns, path: str | os.PathLike[str], robot: _core.Robot
) -> None:
    """A log with the columns of its ticks and of contacts in them; the file appears whole or not at all."""
    require("log", "rosbags", "mcap")
    from mcap.writer import Writer

    messages = _Messages()
    with whole_file(path) as file, file.open("wb") as stream:
        writer: Any = Writer(stream)
        writer.start(profile="ros2", library="contactsense")
        channels = {}
        kinds = {
            JOINT_STATES: "sensor_msgs/msg/JointState",
            EXTERNAL_TORQUE: "sensor_msgs/msg/JointState",
            CONTACTS: "visualization_msgs/msg/MarkerArray",
        }
        if robot.floating_base:
            kinds[BASE] = "nav_msgs/msg/Odometry"
        for topic, kind in kinds.items():
            schema = writer.register_schema(kind, "ros2msg", messages.definition(kind))
            channels[topic] = (writer.register_channel(topic, "cdr", schema), kind)
        for number, (time, topic, message) in enumerate(_all(log, ticks, found, robot, messages)):
            channel, kind = channels[topic]
            stamp = round(time * _NANOSECONDS)
            writer.add_message(channel, stamp, messages.pack(message, kind), stamp, number)
        writer.finish()


def _all(
    log: Log, ticks: Columns, found: Columns, robot: _core.Robot, messages: _Messages
) -> Iterator[tuple[float, str, Any]]:
    """All messages in the order of time."""
    joints = JointColumns(robot)
    names = list(joints.names)
    frames = base_frames(robot) if robot.floating_base else None
    base_poses = log.q[:, :7] if frames is None else placed(frames.origin, log.q[:, :7])
    base_link = "" if frames is None else next(iter(frames.own), "")
    position = joints.positions(log.q)
    columns = [joints.velocities(rows) for rows in (log.v, ticks["external_torque"])]
    effort = None if log.tau is None else joints.velocities(log.tau)
    first = np.searchsorted(found["row"], np.arange(len(ticks["time"]) + 1))
    step = float(np.median(np.diff(log.time))) if len(log) > 1 else 0.0
    for row, time in enumerate(ticks["time"].tolist()):
        if frames is not None:
            yield time, BASE, messages.odometry(time, base_poses[row], log.v[row], base_link)
        own_effort = None if effort is None else effort[row]
        yield (
            time,
            JOINT_STATES,
            messages.joint_state(time, names, position[row], columns[0][row], own_effort),
        )
        yield time, EXTERNAL_TORQUE, messages.joint_state(time, names, None, None, columns[1][row])
        markers = []
        for k in range(int(first[row]), int(first[row + 1])):
            point, force = found["point"][k], found["force"][k]
            if not np.all(np.isfinite(point)):
                continue
            number = int(found["id"][k]) % (1 << 31)
            ball = (_BALL, _BALL, _BALL)
            markers.append(messages.marker(time, number, _Marker.SPHERE, [point], ball, 2.0 * step))
            if np.all(np.isfinite(force)):
                ends = [point - _METRES_PER_NEWTON * force, point]
                scale = (_SHAFT, _HEAD, 0.0)
                markers.append(messages.marker(time, number, _Marker.ARROW, ends, scale, 2.0 * step))
        if markers:
            yield time, CONTACTS, messages.markers(markers)

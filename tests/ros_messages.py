"""Messages of forces, poses and velocities, as bags of ROS 1 and 2 have them."""

from __future__ import annotations

from typing import Any

import numpy as np
from bag_files import STORES, joint_state
from numpy.typing import NDArray

import contactsense as cs

START = 1_700_000_000_000_000_000  # of all logs [ns]
WRENCH = "geometry_msgs/msg/WrenchStamped"
ODOMETRY, IMU = "nav_msgs/msg/Odometry", "sensor_msgs/msg/Imu"
POSE, TWIST = "geometry_msgs/msg/PoseStamped", "geometry_msgs/msg/TwistStamped"
Rows = NDArray[np.float64]
Message = tuple[str, str, int, bytes]


class Writer:
    """Makes messages of one encoding, `cdr` or `ros1`, at times from the log's first on [s]."""

    def __init__(self, encoding: str) -> None:
        self.encoding, self.store = encoding, STORES[encoding]

    def wrench(self, topic: str, time: float, reading: Rows, frame: str = "") -> Message:
        make = self._make
        parts = [make("geometry_msgs/msg/Vector3", *reading[k : k + 3]) for k in (0, 3)]
        wrench = self.store.types["geometry_msgs/msg/Wrench"](*parts)
        return self._message(topic, WRENCH, time, frame, wrench)

    def odometry(self, topic: str, time: float, q: Rows, v: Rows, child: str, frame: str = "odom") -> Message:
        covariance = np.zeros(36)
        pose = self.store.types["geometry_msgs/msg/PoseWithCovariance"](self._pose(q), covariance)
        twist = self.store.types["geometry_msgs/msg/TwistWithCovariance"](self._twist(v), covariance)
        return self._message(topic, ODOMETRY, time, frame, child, pose, twist)

    def pose(self, topic: str, time: float, q: Rows, frame: str = "map") -> Message:
        return self._message(topic, POSE, time, frame, self._pose(q))

    def twist(self, topic: str, time: float, v: Rows, frame: str) -> Message:
        return self._message(topic, TWIST, time, frame, self._twist(v))

    def imu(
        self, topic: str, time: float, quaternion: Rows, angular: Rows, frame: str, known: float = 0.0
    ) -> Message:
        """`known` is the first number of the orientation's covariance, -1 for none."""
        make, none = self._make, np.zeros(9)
        covariance = np.array([known, *none[1:]])
        turn = make("geometry_msgs/msg/Quaternion", *quaternion)
        speed, gravity = (make("geometry_msgs/msg/Vector3", *it) for it in (angular, (0.0, 0.0, 9.81)))
        return self._message(topic, IMU, time, frame, turn, covariance, speed, none, gravity, none)

    def joints(self, log: cs.Log, names: tuple[str, ...], width: int) -> list[Message]:
        """`/joint_states` of the last `width` columns of each quantity."""
        assert log.tau is not None
        rows = zip(log.time, log.q[:, -width:], log.v[:, -width:], log.tau[:, -width:], strict=True)
        found = []
        for time, q, v, tau in rows:
            stamp = stamp_of(time)
            data = joint_state(self.encoding, names, stamp, q, velocity=v, effort=tau)
            found.append(("/joint_states", "sensor_msgs/msg/JointState", stamp, data))
        return found

    def _make(self, kind: str, *numbers: Any) -> Any:
        return self.store.types[kind](*map(float, numbers))

    def _pose(self, q: Rows) -> Any:
        parts = (
            self._make("geometry_msgs/msg/Point", *q[:3]),
            self._make("geometry_msgs/msg/Quaternion", *q[3:7]),
        )
        return self.store.types["geometry_msgs/msg/Pose"](*parts)

    def _twist(self, v: Rows) -> Any:
        parts = (self._make("geometry_msgs/msg/Vector3", *v[k : k + 3]) for k in (0, 3))
        return self.store.types["geometry_msgs/msg/Twist"](*parts)

    def _message(self, topic: str, kind: str, time: float, frame: str, *fields: Any) -> Message:
        stamp = stamp_of(time)
        first = (0,) if self.encoding == "ros1" else ()
        at = self.store.types["builtin_interfaces/msg/Time"](stamp // 10**9, stamp % 10**9)
        header = self.store.types["std_msgs/msg/Header"](*first, at, frame)
        message = self.store.types[kind](header, *fields)
        write = self.store.serialize_ros1 if self.encoding == "ros1" else self.store.serialize_cdr
        return topic, kind, stamp, bytes(write(message, kind))


def stamp_of(time: float) -> int:
    return START + round(time * 1e9)

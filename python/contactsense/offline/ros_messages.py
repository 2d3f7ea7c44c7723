"""ROS 2 messages of a log and of contacts, made and packed."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

NANOSECONDS = 1_000_000_000  # of a second


class Messages:
    """Makes and packs messages."""

    def __init__(self) -> None:
        from rosbags.typesys import Stores, get_typestore

        self._store = get_typestore(Stores.ROS2_HUMBLE)
        self._types: Any = self._store.types

    def definition(self, kind: str) -> bytes:
        """The text that defines a type."""
        return self._store.generate_msgdef(kind)[0].encode()

    def pack(self, message: Any, kind: str) -> bytes:
        """The bytes of a message."""
        return bytes(self._store.serialize_cdr(message, kind))

    def header(self, time: float, frame: str = "world") -> Any:
        """A stamp [s] and a frame."""
        seconds, nanoseconds = divmod(round(time * NANOSECONDS), NANOSECONDS)
        stamp = self._types["builtin_interfaces/msg/Time"](seconds, nanoseconds)
        return self._types["std_msgs/msg/Header"](stamp, frame)

    def wrench(self, time: float, frame: str, reading: list[float]) -> Any:
        """A `WrenchStamped` of force and torque [N, Nm]."""
        make = self._types
        force, torque = (make["geometry_msgs/msg/Vector3"](*part) for part in (reading[:3], reading[3:]))
        both = make["geometry_msgs/msg/Wrench"](force, torque)
        return make["geometry_msgs/msg/WrenchStamped"](self.header(time, frame), both)

    def joint_state(self, time: float, names: list[str], *values: Any) -> Any:
        """A `JointState` of positions, velocities and efforts; None where there are none."""
        none = np.zeros(0)
        position, velocity, effort = (none if it is None else it for it in values)
        return self._types["sensor_msgs/msg/JointState"](self.header(time), names, position, velocity, effort)

    def odometry(self, time: float, q: NDArray[np.float64], v: NDArray[np.float64], base: str) -> Any:
        """An `Odometry` of a base: position and quaternion, and the twist in its own axes."""
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
        """A `Marker` of a shape through points [m], which is shown for so many seconds."""
        make = self._types
        geometry = ("Point", "Vector3", "Quaternion", "Pose")
        point, vector, quaternion, pose = (make[f"geometry_msgs/msg/{name}"] for name in geometry)
        colour = make["std_msgs/msg/ColorRGBA"]
        whole, part = divmod(round(seconds * NANOSECONDS), NANOSECONDS)
        at = points[0] if shape == Marker.SPHERE else np.zeros(3)
        fields = dict(
            header=self.header(time),
            ns="contact" if shape == Marker.SPHERE else "force",
            id=number,
            type=shape,
            action=0,
            pose=pose(point(*map(float, at)), quaternion(0.0, 0.0, 0.0, 1.0)),
            scale=vector(*map(float, scale)),
            color=colour(0.9, 0.2, 0.1, 1.0),
            lifetime=make["builtin_interfaces/msg/Duration"](whole, part),
            frame_locked=False,
            points=[] if shape == Marker.SPHERE else [point(*map(float, it)) for it in points],
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
        """A `MarkerArray`."""
        return self._types["visualization_msgs/msg/MarkerArray"](markers)


class Marker:
    """Numbers of the shapes that are used."""

    ARROW, SPHERE = 0, 2

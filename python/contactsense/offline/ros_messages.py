"""ROS 2 messages of a log and of contacts, made and packed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

NANOSECONDS = 1_000_000_000  # of a second

JOINT_STATE = "sensor_msgs/msg/JointState"
WRENCH = "geometry_msgs/msg/WrenchStamped"
MARKERS = "visualization_msgs/msg/MarkerArray"
DIAGNOSTICS = "diagnostic_msgs/msg/DiagnosticArray"

Colour = tuple[float, float, float, float]
# Red, green, blue and opacity of what is drawn.
_RED: Colour = (0.9, 0.2, 0.1, 1.0)


class Marker:
    """Numbers of the shapes and actions that are used."""

    ARROW, SPHERE, TEXT = 0, 2, 9
    ADD, DELETE = 0, 2


class Messages:
    """Makes messages, of the types of rosbags, and packs them. Times are in nanoseconds."""

    def __init__(self) -> None:
        from rosbags.typesys import Stores, get_typestore

        # The types below are the same from ROS 2 Humble on.
        self._store = get_typestore(Stores.ROS2_HUMBLE)
        self._types: Any = self._store.types

    def definition(self, kind: str) -> bytes:
        """The text that defines a type."""
        return self._store.generate_msgdef(kind)[0].encode()

    def type_hash(self, kind: str) -> str:
        """The hash of a type, as ROS 2 writes it (RIHS01)."""
        return self._store.hash_rihs01(kind)

    def pack(self, message: Any, kind: str) -> bytes:
        """The bytes of a message."""
        return bytes(self._store.serialize_cdr(message, kind))

    def unpack(self, data: bytes, kind: str) -> Any:
        """The message of bytes; raises whatever rosbags does if they are none."""
        return self._store.deserialize_cdr(data, kind)

    def header(self, stamp: int, frame: str = "world") -> Any:
        """A stamp and a frame."""
        return self._make("std_msgs/msg/Header", stamp=self._time("Time", stamp), frame_id=frame)

    def wrench(self, stamp: int, frame: str, reading: Sequence[float]) -> Any:
        """A `WrenchStamped` of force and torque [N, Nm]."""
        force, torque = (self._vector("Vector3", part) for part in (reading[:3], reading[3:]))
        both = self._make("geometry_msgs/msg/Wrench", force=force, torque=torque)
        return self._make(WRENCH, header=self.header(stamp, frame), wrench=both)

    def joint_state(
        self,
        stamp: int,
        names: Sequence[str],
        position: ArrayLike = (),
        velocity: ArrayLike = (),
        effort: ArrayLike = (),
        frame: str = "world",
    ) -> Any:
        """A `JointState` of positions, velocities and efforts; empty where there are none."""
        values = {"position": position, "velocity": velocity, "effort": effort}
        return self._make(
            JOINT_STATE,
            header=self.header(stamp, frame),
            name=list(names),
            **{name: self._doubles(value) for name, value in values.items()},
        )

    def odometry(self, stamp: int, q: NDArray[np.float64], v: NDArray[np.float64], base: str) -> Any:
        """An `Odometry` of a base: position and quaternion, and the twist in its own axes."""
        linear, angular = (self._vector("Vector3", part) for part in (v[:3], v[3:6]))
        twist = self._make("geometry_msgs/msg/Twist", linear=linear, angular=angular)
        unknown = self._doubles(np.zeros(36))
        with_pose, with_twist = (
            self._make(f"geometry_msgs/msg/{kind}WithCovariance", **{name: value, "covariance": unknown})
            for kind, name, value in (("Pose", "pose", self._pose(q[:3], q[3:7])), ("Twist", "twist", twist))
        )
        return self._make(
            "nav_msgs/msg/Odometry",
            header=self.header(stamp),
            child_frame_id=base,
            pose=with_pose,
            twist=with_twist,
        )

    def marker(
        self,
        stamp: int,
        number: int,
        shape: int,
        points: Sequence[ArrayLike],
        scale: ArrayLike,
        lifetime: int,
        *,
        frame: str = "world",
        namespace: str | None = None,
        colour: Colour = _RED,
        text: str = "",
        action: int = Marker.ADD,
    ) -> Any:
        """A `Marker` of a shape: an arrow through points [m], or at a point; shown for `lifetime`."""
        is_arrow = shape == Marker.ARROW
        at = (0.0, 0.0, 0.0) if is_arrow or not len(points) else points[0]
        red, green, blue, opacity = colour
        return self._make(
            "visualization_msgs/msg/Marker",
            header=self.header(stamp, frame),
            ns=namespace or ("force" if is_arrow else "contact"),
            id=number,
            type=shape,
            action=action,
            pose=self._pose(at, (0.0, 0.0, 0.0, 1.0)),
            scale=self._vector("Vector3", scale),
            color=self._make("std_msgs/msg/ColorRGBA", r=red, g=green, b=blue, a=opacity),
            lifetime=self._time("Duration", lifetime),
            points=[self._vector("Point", it) for it in points] if is_arrow else [],
            text=text,
            **self._rest_of_marker(),
        )

    def markers(self, markers: list[Any]) -> Any:
        """A `MarkerArray`."""
        return self._make(MARKERS, markers=markers)

    def diagnostics(
        self, stamp: int, level: int, name: str, message: str, hardware: str, values: Mapping[str, str]
    ) -> Any:
        """A `DiagnosticArray` of one status; level 0 is well, 1 a warning and 2 an error."""
        status = self._make(
            "diagnostic_msgs/msg/DiagnosticStatus",
            level=self._octet(level),
            name=name,
            message=message,
            hardware_id=hardware,
            values=[
                self._make("diagnostic_msgs/msg/KeyValue", key=key, value=value)
                for key, value in values.items()
            ],
        )
        return self._make(DIAGNOSTICS, header=self.header(stamp, ""), status=[status])

    def _make(self, kind: str, **fields: Any) -> Any:
        return self._types[kind](**fields)

    def _doubles(self, values: ArrayLike) -> Any:
        return np.asarray(values, dtype=np.float64)

    def _octet(self, value: int) -> Any:
        return value

    def _time(self, kind: str, nanoseconds: int) -> Any:
        seconds, rest = divmod(nanoseconds, NANOSECONDS)
        return self._make(f"builtin_interfaces/msg/{kind}", sec=seconds, nanosec=rest)

    def _vector(self, kind: str, values: Any) -> Any:
        x, y, z = map(float, values)
        return self._make(f"geometry_msgs/msg/{kind}", x=x, y=y, z=z)

    def _pose(self, point: Any, quaternion: Any) -> Any:
        x, y, z, w = map(float, quaternion)
        turn = self._make("geometry_msgs/msg/Quaternion", x=x, y=y, z=z, w=w)
        return self._make("geometry_msgs/msg/Pose", position=self._vector("Point", point), orientation=turn)

    def _rest_of_marker(self) -> dict[str, Any]:
        """The fields that nothing here needs; types of rosbags have no defaults."""
        nothing = np.zeros(0, dtype=np.uint8)
        return {
            "frame_locked": False,
            "colors": [],
            "texture_resource": "",
            "texture": self._make(
                "sensor_msgs/msg/CompressedImage", header=self.header(0, ""), format="", data=nothing
            ),
            "uv_coordinates": [],
            "mesh_resource": "",
            "mesh_file": self._make("visualization_msgs/msg/MeshFile", filename="", data=nothing),
            "mesh_use_embedded_materials": False,
        }

"""Messages of the classes that a distribution of ROS 2 has."""

from __future__ import annotations

from importlib import import_module
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..offline.ros_messages import Messages


class Ros2Messages(Messages):
    """Makes messages for `rclpy`; it packs them itself."""

    def __init__(self) -> None:
        self._types = {}

    def kind(self, name: str) -> Any:
        """The class of a type such as `sensor_msgs/msg/JointState`.

        Raises:
            ModuleNotFoundError: the package of ROS 2 is not there.
        """
        if name not in self._types:
            package, _, short = name.rpartition("/")
            self._types[name] = getattr(import_module(package.replace("/", ".")), short)
        return self._types[name]

    def _make(self, kind: str, **fields: Any) -> Any:
        return self.kind(kind)(**fields)

    def _doubles(self, values: ArrayLike) -> Any:
        # The setters of rclpy take no arrays of NumPy for sequences.
        return np.asarray(values, dtype=np.float64).tolist()

    def _octet(self, value: int) -> Any:
        return bytes([value])

    def _rest_of_marker(self) -> dict[str, Any]:
        return {}

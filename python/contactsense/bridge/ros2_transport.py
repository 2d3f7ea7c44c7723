"""A bridge as a node of `rclpy`."""

from __future__ import annotations

import time
from contextlib import suppress
from typing import Any

import numpy as np

from ..errors import InputError
from ..offline.ros_messages import DIAGNOSTICS, JOINT_STATE, MARKERS, NANOSECONDS, WRENCH
from .configuration import Configuration
from .node import PERIOD, ContactNode
from .output_messages import message_of
from .ros2_messages import Ros2Messages
from .values import JointReading, Published

# Messages that wait for a slow subscriber.
_DEPTH = 10


class Ros2Bridge:
    """A node in the graph of ROS 2; a context manager.

    Args:
        configuration: of the bridge.
        node: that finds the contacts.

    Raises:
        InputError: `rclpy` or a package of messages is not there.
    """

    def __init__(self, configuration: Configuration, node: ContactNode) -> None:
        try:
            import rclpy
            from rclpy.executors import ExternalShutdownException
            from rclpy.node import Node
            from rclpy.qos import qos_profile_sensor_data
        except ModuleNotFoundError as missing:
            raise InputError("transport: rclpy is not there; source a ROS 2 workspace first") from missing
        self._node, self._messages = node, Ros2Messages()
        self._rclpy, self._end = rclpy, ExternalShutdownException
        rclpy.init()
        self._ros: Any = Node(configuration.node)
        make = self._messages.kind
        self._publishers = {
            topic: self._ros.create_publisher(make(kind), topic, _DEPTH)
            for topic, kind in (
                (configuration.external_torque_topic, JOINT_STATE),
                (configuration.contacts_topic, WRENCH),
                (configuration.not_located_topic, WRENCH),
                (configuration.markers_topic, MARKERS),
                (configuration.diagnostics, DIAGNOSTICS),
            )
        }
        subscribe, qos = self._ros.create_subscription, qos_profile_sensor_data
        subscribe(make(JOINT_STATE), configuration.joint_states, self._take, qos)
        for sensor in configuration.sensors.values():
            subscribe(make(WRENCH), sensor.topic, self._wrench_of(sensor.topic), qos)
        self._ros.create_timer(PERIOD, self._tell)
        node.start(time.monotonic())

    def run(self) -> None:
        """Spins until Ctrl-C or the end of the context of ROS 2."""
        with suppress(self._end):
            self._rclpy.spin(self._ros)

    def close(self) -> None:
        """Ends the node."""
        self._ros.destroy_node()
        self._rclpy.try_shutdown()

    def __enter__(self) -> Ros2Bridge:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _take(self, message: Any) -> None:
        """Takes in a `JointState`; the executor calls this and the others one at a time."""
        stamp = message.header.stamp
        rows = [np.array(it, dtype=np.float64) for it in (message.position, message.velocity, message.effort)]
        reading = JointReading(stamp.sec * NANOSECONDS + stamp.nanosec, tuple(message.name), *rows)
        for output in self._node.take(reading, time.monotonic()):
            self._publish(output)

    def _wrench_of(self, topic: str) -> Any:
        def take(message: Any) -> None:
            parts = message.wrench.force, message.wrench.torque
            reading = np.array([[part.x, part.y, part.z] for part in parts]).ravel()
            self._node.take_wrench(topic, reading, time.monotonic())

        return take

    def _tell(self) -> None:
        self._publish(self._node.health(time.time_ns(), time.monotonic()))

    def _publish(self, published: Published) -> None:
        topic, output = published
        self._publishers[topic].publish(message_of(self._messages, output))

"""Bytes of messages in and out: the node behind a transport that carries CDR."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from ..offline.ros_messages import JOINT_STATE, NANOSECONDS, WRENCH, Marker, Messages
from .layouts import JointLayout, Stencil
from .node import ContactNode
from .output_messages import message_of
from .values import KINDS, Drawing, Drawings, ExternalTorque, Health, JointReading, LinkWrench, Output

# No joint state has as many bytes: what is longer is not read.
_LARGEST = 1 << 16
# As many layouts of joint states are remembered; a topic has one a sender.
_MOST_LAYOUTS = 16

PublishedBytes = tuple[str, bytes]


class CdrNode:
    """Reads messages for a node and writes what it publishes. One thread at a time may use it.

    Args:
        node: that takes in the messages.
        messages: that packs them.
    """

    def __init__(self, node: ContactNode, messages: Messages) -> None:
        self.node = node
        self._messages = messages
        self._layouts: dict[int, JointLayout] = {}  # by size of the message
        self._stencils: dict[str, Stencil] = {}  # of wrenches, by link
        self._torque: Stencil | None = None
        self._warm_up()

    def joint_state(self, data: bytes, now: float) -> Iterator[PublishedBytes]:
        """Takes in a `JointState`, whatever its bytes are; each result is packed when its turn comes."""
        try:
            reading = self._reading(data)
        except Exception as error:  # what rosbags raises on bytes that are no message is not stated
            self.node.refuse(f"is no JointState ({type(error).__name__}: {error})")
            return iter(())
        return ((topic, self._packed(output)) for topic, output in self.node.take(reading, now))

    def wrench(self, topic: str, data: bytes, now: float) -> None:
        """Takes in a `WrenchStamped`, whatever its bytes are."""
        try:
            wrench = self._unpacked(data, WRENCH).wrench
            parts = wrench.force, wrench.torque
            reading = np.array([[part.x, part.y, part.z] for part in parts], dtype=np.float64).ravel()
        except Exception as error:
            self.node.refuse_wrench(f"is no WrenchStamped ({type(error).__name__}: {error})")
            return
        self.node.take_wrench(topic, reading, now)

    def health(self, stamp: int, now: float) -> PublishedBytes:
        """The diagnostics."""
        topic, output = self.node.health(stamp, now)
        return topic, self._packed(output)

    def _warm_up(self) -> None:
        """Lets rosbags make its code for each type now: in a tick that would take tens of milliseconds."""
        nothing = np.zeros(0)
        for output in (
            ExternalTorque(0, (), nothing),
            LinkWrench(0, "", np.zeros(6)),
            Drawings(0, "", 0, (Drawing("", 0, Marker.ARROW, [np.zeros(3), np.zeros(3)]),)),
            Health(0, 0, "", "", {"": ""}),
        ):
            kind = KINDS[type(output)]
            self._messages.unpack(self._packed_anew(output), kind)

    def _reading(self, data: bytes) -> JointReading:
        known = self._layouts.get(len(data))
        found = None if known is None else known.read(data)
        if found is None:
            found = self._unpacked_reading(data)
            layout = JointLayout.of(data, found)
            if layout is not None:
                if len(self._layouts) >= _MOST_LAYOUTS:
                    self._layouts.clear()
                self._layouts[len(data)] = layout
        return found

    def _unpacked_reading(self, data: bytes) -> JointReading:
        message = self._unpacked(data, JOINT_STATE)
        stamp = message.header.stamp
        return JointReading(
            stamp.sec * NANOSECONDS + stamp.nanosec,
            tuple(message.name),
            message.position,
            message.velocity,
            message.effort,
        )

    def _unpacked(self, data: bytes, kind: str) -> Any:
        if len(data) > _LARGEST:
            raise ValueError(f"it has {len(data)} bytes")
        return self._messages.unpack(data, kind)

    def _packed(self, output: Output) -> bytes:
        match output:
            case ExternalTorque():
                if self._torque is None:
                    self._torque = Stencil(self._packed_anew(output), len(output.torque))
                return self._torque.filled(output.stamp, output.torque)
            case LinkWrench():
                stencil = self._stencils.get(output.link)
                if stencil is None:
                    stencil = Stencil(self._packed_anew(output), len(output.wrench))
                    self._stencils[output.link] = stencil
                return stencil.filled(output.stamp, output.wrench)
        return self._packed_anew(output)

    def _packed_anew(self, output: Output) -> bytes:
        return self._messages.pack(message_of(self._messages, output), KINDS[type(output)])

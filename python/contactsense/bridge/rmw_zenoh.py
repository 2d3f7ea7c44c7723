"""How `rmw_zenoh` names topics and makes itself known, so that a graph of ROS 2 sees a bridge.

The form is that of its design document: key expressions of topics, liveliness tokens, and what is attached
to each message.
"""

from __future__ import annotations

import hashlib
import struct
from dataclasses import dataclass
from typing import Literal

# Where types have no hash, as in ROS 2 Humble.
NO_HASH = "TypeHashNotSupported"
# Only what differs from the defaults of rmw_zenoh is written: reliability, durability, history and depth,
# deadline, lifespan, liveliness.
_DEPTH = 10
_RELIABLE = f"::,{_DEPTH}:,:,:,,"
_BEST_EFFORT = f"2::,{_DEPTH}:,:,:,,"
# Of a message: sequence number, time [ns], and the identity of the sender with its length before it.
_ATTACHMENT = struct.Struct("<qqB16s")
_IDENTITY = 16

Entity = Literal["NN", "MP", "MS"]


def dds_type(kind: str) -> str:
    """The name of a type such as `sensor_msgs/msg/JointState` in DDS."""
    package, _, name = kind.rpartition("/")
    return f"{package.replace('/', '::')}::dds_::{name}_"


def key_expression(domain: int, topic: str, kind: str, type_hash: str) -> str:
    """Where messages of a topic go; the hash may be `*` for those that are received."""
    return f"{domain}/{topic.strip('/')}/{dds_type(kind)}/{type_hash}"


@dataclass(frozen=True)
class Graph:
    """The tokens of one node.

    Args:
        domain: of ROS 2.
        session: identity of the session of Zenoh.
        node: its name.
    """

    domain: int
    session: str
    node: str

    def node_token(self) -> str:
        """Of the node itself."""
        return self._token(0, "NN")

    def publisher_token(self, number: int, topic: str, kind: str, type_hash: str) -> str:
        """Of a topic that is written; numbers start at one."""
        return f"{self._token(number, 'MP')}/{_topic(topic, kind, type_hash)}/{_RELIABLE}"

    def subscription_token(self, number: int, topic: str, kind: str, type_hash: str) -> str:
        """Of a topic that is read."""
        return f"{self._token(number, 'MS')}/{_topic(topic, kind, type_hash)}/{_BEST_EFFORT}"

    def _token(self, number: int, entity: Entity) -> str:
        # Enclave and namespace are those of the root.
        return f"@ros2_lv/{self.domain}/{self.session}/0/{number}/{entity}/%/%/{self.node}"


def _topic(topic: str, kind: str, type_hash: str) -> str:
    return f"{topic.replace('/', '%')}/{dds_type(kind)}/{type_hash}"


class Attachments:
    """What is attached to the messages of a publisher.

    Args:
        token: of the publisher.
    """

    def __init__(self, token: str) -> None:
        self._identity = hashlib.blake2b(token.encode(), digest_size=_IDENTITY).digest()
        self._number = 0

    def next(self, time: int) -> bytes:
        """Of the next message, which is sent at a time [ns]."""
        self._number += 1
        return _ATTACHMENT.pack(self._number, time, _IDENTITY, self._identity)


class Losses:
    """Counts what numbered senders sent and did not arrive."""

    _MOST = 64  # senders that are remembered

    def __init__(self) -> None:
        self._last: dict[bytes, int] = {}

    def before(self, attachment: bytes) -> int:
        """How many messages are missing before the one with this attachment; 0 where there is no number."""
        if len(attachment) != _ATTACHMENT.size:
            return 0
        number, _, length, sender = _ATTACHMENT.unpack(attachment)
        if length != _IDENTITY:
            return 0
        last = self._last.get(sender)
        if last is None and len(self._last) >= self._MOST:
            self._last.clear()
        self._last[sender] = number
        return 0 if last is None else max(0, number - last - 1)

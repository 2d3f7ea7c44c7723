"""Topics and sessions of the processes around a bridge."""

from __future__ import annotations

import json
import struct
from typing import Any

import zenoh

from contactsense.bridge.endpoints import SETTINGS
from contactsense.bridge.rmw_zenoh import key_expression
from contactsense.offline.ros_messages import JOINT_STATE, NANOSECONDS, WRENCH

JOINTS, TORQUE, CONTACTS = "joint_states", "contactsense/external_torque", "contactsense/contacts"
KINDS = {JOINTS: JOINT_STATE, TORQUE: JOINT_STATE, CONTACTS: WRENCH}
# Where a message has its stamp: seconds, nanoseconds.
STAMP, STAMP_AT = struct.Struct("<iI"), 4
SETTLING = 0.5  # until declarations have gone around [s]


def session(**endpoints: str) -> Any:
    """A session of Zenoh that looks for nobody: `connect=` or `listen=` an address."""
    settings = zenoh.Config()
    for name, value in SETTINGS.items():
        settings.insert_json5(name, value)
    for name, address in ({"listen": "tcp/127.0.0.1:0"} | endpoints).items():
        settings.insert_json5(f"{name}/endpoints", json.dumps([address]))
    return zenoh.open(settings)


def key(topic: str, type_hash: str = "*") -> str:
    """The key expression of a topic; without a hash, one that is subscribed to."""
    return key_expression(0, topic, KINDS[topic], type_hash)


def stamp_of(message: bytes) -> int:
    """The stamp of a message [ns]."""
    seconds, rest = STAMP.unpack_from(message, STAMP_AT)
    return int(seconds) * NANOSECONDS + int(rest)

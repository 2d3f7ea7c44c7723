"""Bytes of messages: whatever arrives is read or counted, and fast ways give what rosbags gives."""

from __future__ import annotations

import struct

import numpy as np
import pytest

pytest.importorskip("rosbags")
from bridge_arm import HELD, NAMES, START, STEP, ZERO, Q, efforts, is_the_push, node
from hypothesis import given, settings
from hypothesis import strategies as st

from contactsense.bridge.cdr import CdrNode
from contactsense.bridge.layouts import JointLayout, Stencil
from contactsense.bridge.values import JointReading, LinkWrench
from contactsense.offline.ros_messages import DIAGNOSTICS, JOINT_STATE, MARKERS, WRENCH, Messages

MESSAGES = Messages()
KINDS = {
    "external_torque": JOINT_STATE,
    "contacts": WRENCH,
    "contacts_not_located": WRENCH,
    "markers": MARKERS,
}
SENSOR = "sensors: {wrist: {link: iiwa_link_7, topic: /wrist/wrench}}\n"


def packed(tick: int = 0, effort: np.ndarray = HELD, names: tuple[str, ...] = NAMES) -> bytes:
    state = MESSAGES.joint_state(START + STEP * tick, names, Q, ZERO, effort)
    return MESSAGES.pack(state, JOINT_STATE)


def reading_of(data: bytes) -> JointReading:
    it = MESSAGES.unpack(data, JOINT_STATE)
    stamp = it.header.stamp.sec * 1_000_000_000 + it.header.stamp.nanosec
    return JointReading(stamp, tuple(it.name), it.position, it.velocity, it.effort)


def taken(bridge: CdrNode, data: bytes, now: float) -> list[tuple[str, bytes]]:
    return list(bridge.joint_state(data, now))


def same(a: JointReading | None, b: JointReading) -> bool:
    if a is None or (a.stamp, a.names) != (b.stamp, b.names):
        return False
    fields = ("position", "velocity", "effort")
    return all(getattr(a, name).tobytes() == getattr(b, name).tobytes() for name in fields)


def test_a_push_comes_out_as_bytes_of_ros() -> None:
    bridge = CdrNode(node(), MESSAGES)
    found: dict[str, list] = {name: [] for name in KINDS}
    for tick, row in enumerate(efforts(500, range(100, 400))):
        for topic, data in taken(bridge, packed(tick, row), 1e-3 * tick):
            name = topic.removeprefix("/contactsense/")
            found[name].append(MESSAGES.unpack(data, KINDS[name]))
    assert len(found["external_torque"]) == 500
    last = found["contacts"][250]
    force, torque = last.wrench.force, last.wrench.torque
    wrench = np.array([force.x, force.y, force.z, torque.x, torque.y, torque.z])
    assert is_the_push(LinkWrench(0, last.header.frame_id, wrench))
    assert found["external_torque"][7].header.stamp.nanosec == 7 * STEP
    assert tuple(found["external_torque"][7].name) == NAMES
    assert len(found["markers"]) > 3
    topic, data = bridge.health(START, 1.0)
    status = MESSAGES.unpack(data, DIAGNOSTICS).status[0]
    assert topic == "/diagnostics"
    assert {it.key: it.value for it in status.values}["messages"] == "500"


@settings(max_examples=300, deadline=None)
@given(st.binary(max_size=500))
def test_random_bytes_are_counted(data: bytes) -> None:
    bridge = CdrNode(node(SENSOR), MESSAGES)
    assert taken(bridge, data, 0.0) == []
    bridge.wrench("/wrist/wrench", data, 0.0)
    assert bridge.node.counts.received == 1
    assert bridge.node.counts.taken == 0
    assert taken(bridge, packed(1), 1e-3)


@settings(max_examples=500, deadline=None)
@given(st.data())
def test_broken_messages_are_read_as_rosbags_reads_them_or_counted(data: st.DataObject) -> None:
    """Of a message that was sound, some bytes are others, or it is cut off."""
    bridge, plain = CdrNode(node(), MESSAGES), CdrNode(node(), MESSAGES)
    taken(bridge, packed(0), 0.0)
    taken(plain, packed(0), 0.0)
    broken = bytearray(packed(1))
    for _ in range(data.draw(st.integers(1, 4))):
        broken[data.draw(st.integers(0, len(broken) - 1))] = data.draw(st.integers(0, 255))
    message = bytes(broken[: data.draw(st.integers(len(broken) // 2, len(broken)))])
    plain._layouts.clear()
    found, wanted = taken(bridge, message, 1e-3), taken(plain, message, 1e-3)
    assert found == wanted
    assert bridge.node.counts.received == plain.node.counts.received == 2
    assert bridge.node.counts.refused == plain.node.counts.refused
    assert bridge.node.counts.taken + bridge.node.counts.refused + bridge.node.counts.other_joints == 2


def test_large_messages_are_not_read() -> None:
    bridge = CdrNode(node(), MESSAGES)
    assert taken(bridge, packed() + bytes(1 << 16), 0.0) == []
    assert "it has 65" in bridge.node.summary()


@pytest.mark.parametrize("names", [NAMES, ("a",), ("a", "bc", "def"), ("",), tuple("abcdefghijklmnop")])
def test_a_layout_reads_what_rosbags_reads(names: tuple[str, ...]) -> None:
    rng = np.random.default_rng(len(names))

    def message(stamp: int) -> bytes:
        rows = rng.normal(size=(3, len(names)))
        rows[rng.random(rows.shape) < 0.1] = np.nan
        return MESSAGES.pack(MESSAGES.joint_state(stamp, names, *rows), JOINT_STATE)

    first = message(5)
    layout = JointLayout.of(first, reading_of(first))
    assert layout is not None
    for stamp in (0, 7, START, -3_000_000_001):
        data = message(stamp)
        assert same(layout.read(data), reading_of(data))
    # In another order of the names, or with other counts, it is another layout.
    if len(names) > 1 and len(set(map(len, names))) == 1:
        other = MESSAGES.pack(MESSAGES.joint_state(5, names[::-1], *np.zeros((3, len(names)))), JOINT_STATE)
        assert layout.read(other) is None
    count = struct.pack("<I", len(names) - 1)
    start = len(first) - 8 * (3 * len(names) + 2)
    for place in (start + 8 * len(names), start + 8 * (2 * len(names) + 1)):
        assert layout.read(first[:place] + count + first[place + 4 :]) is None


def test_other_layouts_are_not_taken_for_the_usual_one() -> None:
    unusual = [
        MESSAGES.joint_state(5, NAMES, Q, ZERO),
        MESSAGES.joint_state(5, NAMES, Q[:6], ZERO, HELD),
        MESSAGES.joint_state(5, (), (), (), ()),
    ]
    for message in unusual:
        data = MESSAGES.pack(message, JOINT_STATE)
        assert JointLayout.of(data, reading_of(data)) is None
    store = MESSAGES._store
    large_first = bytes(
        store.serialize_cdr(MESSAGES.joint_state(5, NAMES, Q, ZERO, HELD), JOINT_STATE, little_endian=False)
    )
    assert JointLayout.of(large_first, reading_of(large_first)) is None
    bridge = CdrNode(node(), MESSAGES)
    assert taken(bridge, large_first, 0.0)


def test_stencils_write_what_rosbags_writes() -> None:
    rng = np.random.default_rng(0)
    torques = Stencil(MESSAGES.pack(MESSAGES.joint_state(1, NAMES, effort=ZERO), JOINT_STATE), 7)
    wrenches = Stencil(MESSAGES.pack(MESSAGES.wrench(1, "link", [0.0] * 6), WRENCH), 6)
    for stamp in (0, 3, START):
        seven, six = rng.normal(size=7), rng.normal(size=6)
        wanted = MESSAGES.pack(MESSAGES.joint_state(stamp, NAMES, effort=seven), JOINT_STATE)
        assert torques.filled(stamp, seven) == wanted
        assert wrenches.filled(stamp, six) == MESSAGES.pack(
            MESSAGES.wrench(stamp, "link", six.tolist()), WRENCH
        )


def test_messages_of_two_senders_come_in_turns() -> None:
    bridge = CdrNode(node(), MESSAGES)
    finger = MESSAGES.pack(MESSAGES.joint_state(START, ("finger",), [0.0], [0.0], [0.0]), JOINT_STATE)
    for tick in range(20):
        assert taken(bridge, packed(tick), 1e-3 * tick)
        assert taken(bridge, finger, 1e-3 * tick) == []
    assert (bridge.node.counts.taken, bridge.node.counts.other_joints, bridge.node.counts.refused) == (
        20,
        20,
        0,
    )
    assert len(bridge._layouts) == 2


def test_layouts_are_not_remembered_without_end() -> None:
    bridge = CdrNode(node(), MESSAGES)
    for length in range(1, 60):
        taken(bridge, packed(names=("x" * length, *NAMES[1:])), 0.0)
    assert len(bridge._layouts) <= 16

"""Random messages of ROS, and small bags of them in every format that is read."""

from __future__ import annotations

import os
import sqlite3
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("rosbags")
pytest.importorskip("mcap")

import mcap.writer
import zstandard
from rosbags import rosbag1
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

# Files of each format that are mutated; a larger number searches further.
MUTATIONS = int(os.environ.get("CONTACTSENSE_MUTATIONS", "300"))
CUTS = 100
JOINT_STATE = "sensor_msgs/msg/JointState"
ARM = tuple(f"arm_joint{i}" for i in range(1, 8))
STORES = {"cdr": get_typestore(Stores.ROS2_HUMBLE), "ros1": get_typestore(Stores.ROS1_NOETIC)}
CUSTOM = """std_msgs/Header header
float64[7] tau
bool is_moving
int16[] counts
string mode
uint64 tick
geometry_msgs/Wrench[2] wrenches
float32[<=4] few
geometry_msgs/Point[] points
int8 last
"""
DYNAMIC = """std_msgs/Header header
string[] joint_names
control_msgs/InterfaceValue[] interface_values
================================================================================
MSG: control_msgs/InterfaceValue
string[] interface_names
float64[] values
"""
for _store in STORES.values():
    _store.register(get_types_from_msg(CUSTOM.replace("<=4", ""), "my_msgs/msg/State"))
    _store.register(get_types_from_msg(DYNAMIC, "control_msgs/msg/DynamicJointState"))

RANGES = {"bool": (0, 2, "?"), "byte": (-128, 128, "i1"), "char": (0, 256, "u1")}
RANGES |= {f"int{8 * n}": (-(2 ** (8 * n - 1)), 2 ** (8 * n - 1), f"i{n}") for n in (1, 2, 4, 8)}
RANGES |= {f"uint{8 * n}": (0, 2 ** (8 * n), f"u{n}") for n in (1, 2, 4, 8)}


def numbers(rng: np.random.Generator, base: str, count: int) -> Any:
    if base.startswith("float"):
        return rng.normal(size=count).astype(base)
    low, high, dtype = RANGES[base]
    return rng.integers(low, high, count, dtype=dtype)


def random_message(rng: np.random.Generator, encoding: str, kind: str) -> Any:
    """A message with random values, texts and lengths."""
    store = STORES[encoding]

    def element(description: Any) -> Any:
        node, what = int(description[0]), description[1]
        if node == 2:
            return random_message(rng, encoding, what)
        if node == 1:
            return text() if what[0] == "string" else numbers(rng, what[0], 1)[0].item()
        count = what[1] if node == 3 else int(rng.integers(0, 5))
        if int(what[0][0]) == 1 and what[0][1][0] != "string":
            return numbers(rng, what[0][1][0], count)
        return [element(what[0]) for _ in range(count)]

    def text() -> str:
        return "".join(rng.choice(list("abcdeäμ"), int(rng.integers(0, 9))))

    if kind.endswith(("/Time", "/Duration")):
        return store.types[kind](int(rng.integers(0, 2**31)), int(rng.integers(0, 10**9)))
    return store.types[kind](*(element(description) for _, description in store.fielddefs[kind][1]))


def flat_numbers(message: Any, encoding: str, kind: str) -> list[float]:
    """All numbers of a message in order, a time as one."""
    found: list[float] = []

    def visit(value: Any, description: Any) -> None:
        node, what = int(description[0]), description[1]
        if node == 2:
            found.extend(flat_numbers(value, encoding, what))
        elif node == 1:
            if what[0] != "string":
                found.append(float(value))
        else:
            for one in value:
                visit(one, what[0])

    if kind.endswith(("/Time", "/Duration")):
        return [message.sec + message.nanosec * 1e-9]
    for name, description in STORES[encoding].fielddefs[kind][1]:
        if name != "structure_needs_at_least_one_member":
            visit(getattr(message, name), description)
    return found


def joint_state(encoding: str, names: tuple[str, ...], stamp: int, values: Any, **arrays: Any) -> bytes:
    """A serialised JointState; `values` are positions, `arrays` velocity and effort."""
    types, store = STORES[encoding].types, STORES[encoding]
    time = types["builtin_interfaces/msg/Time"](stamp // 10**9, stamp % 10**9)
    first = (0,) if encoding == "ros1" else ()
    head = types["std_msgs/msg/Header"](*first, time, "base")
    rest = [np.asarray(arrays.get(name, values), float) for name in ("velocity", "effort")]
    message = types[JOINT_STATE](head, list(names), np.asarray(values, float), *rest)
    write = store.serialize_ros1 if encoding == "ros1" else store.serialize_cdr
    return bytes(write(message, JOINT_STATE))


Message = tuple[str, str, int, bytes]  # topic, type, time of reception [ns], data


def messages(encoding: str, count: int = 60) -> list[Message]:
    """An arm's states, a gripper's on the same topic, a wrench, and a text that has no numbers."""
    rng = np.random.default_rng(5)
    store, out = STORES[encoding], []
    write = store.serialize_ros1 if encoding == "ros1" else store.serialize_cdr
    for i in range(count):
        time = 1_700_000_000_000_000_000 + i * 1_000_000
        out.append(("/joint_states", JOINT_STATE, time, joint_state(encoding, ARM, time, rng.normal(size=7))))
        if i % 3 == 0:
            data = joint_state(encoding, ("finger",), time, [i], velocity=[], effort=[])
            out.append(("/joint_states", JOINT_STATE, time + 1000, data))
        for topic, kind in (("/wrench", "geometry_msgs/msg/WrenchStamped"), ("/text", "std_msgs/msg/String")):
            out.append((topic, kind, time + 2000, bytes(write(random_message(rng, encoding, kind), kind))))
    return out


def definition(encoding: str, kind: str) -> str:
    text: str = STORES[encoding].generate_msgdef(kind, ros_version=1 if encoding == "ros1" else 2)[0]
    return text


def write_mcap(path: Path, given: list[Message], encoding: str = "cdr", **options: Any) -> Path:
    """An MCAP file; `compression` is `none`, `zstd` or `lz4`."""
    compression = mcap.writer.CompressionType[options.pop("compression", "none").upper()]
    with path.open("wb") as file:
        writer = mcap.writer.Writer(file, compression=compression, **options)
        writer.start("ros1" if encoding == "ros1" else "ros2", "test")
        channels: dict[str, int] = {}
        for topic, kind, time, data in given:
            if topic not in channels:
                text = definition(encoding, kind).encode()
                name = kind.replace("/msg/", "/") if encoding == "ros1" else kind
                schema = writer.register_schema(name, "ros1msg" if encoding == "ros1" else "ros2msg", text)
                channels[topic] = writer.register_channel(topic, encoding, schema)
            writer.add_message(channels[topic], time, data, time)
        writer.finish()
    return path


def write_sqlite(path: Path, given: list[Message], page_size: int = 4096, *, packs: bool = False) -> Path:
    """A file as rosbag2 writes it; `packs` compresses every message."""
    base = sqlite3.connect(path)
    base.execute(f"PRAGMA page_size={page_size}")
    base.execute(
        "CREATE TABLE topics(id INTEGER PRIMARY KEY,name TEXT NOT NULL,type TEXT NOT NULL,"
        "serialization_format TEXT NOT NULL,offered_qos_profiles TEXT NOT NULL)"
    )
    base.execute(
        "CREATE TABLE messages(id INTEGER PRIMARY KEY,topic_id INTEGER NOT NULL,"
        "timestamp INTEGER NOT NULL, data BLOB NOT NULL)"
    )
    base.execute("CREATE INDEX timestamp_idx ON messages (timestamp ASC)")
    numbers: dict[str, int] = {}
    for topic, kind, time, data in given:
        if topic not in numbers:
            numbers[topic] = len(numbers) + 1
            base.execute("INSERT INTO topics VALUES (?,?,?,'cdr','')", (numbers[topic], topic, kind))
        blob = zstandard.ZstdCompressor().compress(data) if packs else data
        base.execute(
            "INSERT INTO messages(topic_id,timestamp,data) VALUES (?,?,?)", (numbers[topic], time, blob)
        )
    base.commit()
    base.close()
    return path


def write_bag(path: Path, given: list[Message], compression: str | None = None, chunk: int = 4096) -> Path:
    """A bag of ROS 1; `compression` is `bz2` or `lz4`."""
    writer = rosbag1.Writer(path)
    writer.chunk_threshold = chunk
    if compression:
        writer.set_compression(rosbag1.Writer.CompressionFormat[compression.upper()])
    with writer:
        connections: dict[str, Any] = {}
        for topic, kind, time, data in given:
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, kind, typestore=STORES["ros1"])
            writer.write(connections[topic], time, data)
    return path


def mutated(rng: np.random.Generator, data: bytes) -> bytes:
    """The bytes with some changed, removed, repeated or put elsewhere."""
    out = bytearray(data)
    for _ in range(int(rng.integers(1, 6))):
        at = int(rng.integers(0, len(out)))
        size = int(rng.integers(1, 1 + min(64, len(out) - at)))
        way = rng.integers(0, 5)
        if way == 0:
            out[at] ^= 1 << int(rng.integers(0, 8))
        elif way == 1:
            out[at : at + size] = rng.bytes(size)
        elif way == 2:
            out[at : at + size] = b"\xff" * size
        elif way == 3:
            out[at:at] = out[at : at + size]
        elif len(out) > 2 * size:
            del out[at : at + size]
    return bytes(out)

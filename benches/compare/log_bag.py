"""A long log of an arm in motion without contact: a rosbag2 folder with one MCAP file, and a calibration."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import contactsense as cs

ROBOT = "iiwa14"
DT = 0.001  # [s]
MOTION = 20.0  # there and back again, over and over [s]
TORQUE_NOISE = 0.05  # [Nm]
START = 1_700_000_000  # [s] since 1970
KIND = "sensor_msgs/msg/JointState"
NANOSECONDS = 1_000_000_000
# Messages that are packed together.
BATCH = 10_000


def make_bag(folder: Path, rows: int) -> tuple[Path, Path]:
    """Writes bag and calibration; returns the bag's folder and the calibration's file."""
    robot = cs.Robot.named(ROBOT)
    log = _log(robot, rows)
    calibration = folder / "arm.yaml"
    cs.calibrate(robot, log[: int(MOTION / DT)]).save(calibration)
    bag = folder / "bag"
    _write(bag, robot, log)
    return bag, calibration


def _log(robot: cs.Robot, rows: int) -> cs.Log:
    motion = cs.exciting_motion(robot, MOTION, dt=DT)
    one_way = list(zip(motion.q, motion.v, motion.a, strict=True))
    tau = np.array([robot.inverse_dynamics(q, v, a) for q, v, a in one_way])
    back_tau = np.array([robot.inverse_dynamics(q, -v, a) for q, v, a in reversed(one_way)])
    which = np.arange(rows) % (2 * len(tau))

    def there_and_back(there: NDArray[np.float64], back: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.concatenate([there, back])[which]

    tau = there_and_back(tau, back_tau)
    tau += np.random.default_rng(0).normal(0.0, TORQUE_NOISE, tau.shape)
    q, v = there_and_back(motion.q, motion.q[::-1]), there_and_back(motion.v, -motion.v[::-1])
    return cs.Log(np.arange(rows) * DT, q, v, tau)


def _write(bag: Path, robot: cs.Robot, log: cs.Log) -> None:
    from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    writer = Writer(bag, version=9, storage_plugin=StoragePlugin.MCAP)
    writer.set_compression(CompressionMode.STORAGE, CompressionFormat.ZSTD)
    with writer:
        connection = writer.add_connection("/joint_states", KIND, typestore=store)
        for stamp, data in _messages(store, robot, log):
            writer.write(connection, stamp, data)


def _messages(store: Any, robot: cs.Robot, log: cs.Log) -> Iterator[tuple[int, bytes]]:
    """Stamp and data of each message. One is serialised; the others differ from it in their numbers."""
    assert log.tau is not None
    marks = np.arange(3.0 * robot.nv).reshape(3, robot.nv) + 0.123
    stamp = store.types["builtin_interfaces/msg/Time"](1, 2)
    header = store.types["std_msgs/msg/Header"](stamp, "world")
    names = list(robot.actuated_joint_names)
    one = bytes(store.serialize_cdr(store.types[KIND](header, names, *marks), KIND))
    places = [(one.index(np.array([1, 2], dtype="<u4").tobytes()), 8)]
    places += [(one.index(mark.tobytes()), mark.nbytes) for mark in marks]
    for first in range(0, len(log), BATCH):
        part = slice(first, first + BATCH)
        stamps = START * NANOSECONDS + np.rint(log.time[part] * NANOSECONDS).astype(np.int64)
        times = np.column_stack(np.divmod(stamps, NANOSECONDS)).astype("<u4")
        packed = np.tile(np.frombuffer(one, dtype=np.uint8), (len(times), 1))
        for (at, size), values in zip(places, (times, log.q[part], log.v[part], log.tau[part]), strict=True):
            packed[:, at : at + size] = np.ascontiguousarray(values).view(np.uint8)
        yield from ((int(stamp), row.tobytes()) for stamp, row in zip(stamps, packed, strict=True))

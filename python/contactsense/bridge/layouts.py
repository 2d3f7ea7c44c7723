"""Messages that change in their numbers only, read and written by these.

A controller sends the same names with every joint state. By rosbags, reading one takes 14 us and writing a
torque 16 us, more than most ticks of the monitor; so, it takes 3 and 1 us.
"""

from __future__ import annotations

import struct

import numpy as np

from ..offline.ros_messages import NANOSECONDS
from .values import JointReading, Row

# Four bytes say how the rest is encoded; these: in CDR, the least byte of a number first.
_LITTLE = b"\x00\x01"
_STAMP = struct.Struct("<iI")  # seconds, nanoseconds
_STAMP_AT = 4
_NAMES_AT = _STAMP_AT + _STAMP.size
_COUNT = struct.Struct("<I")
_DOUBLE = 8  # bytes


class JointLayout:
    """Where the numbers are in joint states with the same names as one that was read.

    Positions, velocities and efforts stand at the end, each after how many they are; of counts and numbers
    all begin at multiples of eight bytes.
    """

    def __init__(self, data: bytes, read: JointReading) -> None:
        joints = len(read.names)
        self._size = len(data)
        self._names = read.names
        self._joints = joints
        self._start = len(data) - _DOUBLE * (3 * joints + 2)
        self._same = data[:_STAMP_AT], data[_NAMES_AT : max(_NAMES_AT, self._start)]

    @classmethod
    def of(cls, data: bytes, read: JointReading) -> JointLayout | None:
        """The layout of a message; None where it is not the usual one."""
        rows = read.position, read.velocity, read.effort
        if data[:2] != _LITTLE or any(len(row) != len(read.names) for row in rows) or not read.names:
            return None
        layout = cls(data, read)
        again = layout.read(data)
        if again is None or again.stamp != read.stamp:
            return None
        found = again.position, again.velocity, again.effort
        same = all(a.tobytes() == b.tobytes() for a, b in zip(rows, found, strict=True))
        return layout if same else None

    def read(self, data: bytes) -> JointReading | None:
        """A message; None where its layout is another one."""
        start, joints = self._start, self._joints
        if len(data) != self._size or start < _NAMES_AT:
            return None
        if (data[:_STAMP_AT], data[_NAMES_AT:start]) != self._same:
            return None
        for row in (1, 2):
            if _COUNT.unpack_from(data, start + _DOUBLE * (row * joints + row - 1))[0] != joints:
                return None
        seconds, nanoseconds = _STAMP.unpack_from(data, _STAMP_AT)
        numbers = np.frombuffer(data, dtype="<f8", offset=start)
        return JointReading(
            seconds * NANOSECONDS + nanoseconds,
            self._names,
            numbers[:joints],
            numbers[joints + 1 : 2 * joints + 1],
            numbers[2 * joints + 2 :],
        )


class Stencil:
    """A message whose stamp and last numbers are replaced.

    Args:
        packed: one such message.
        count: how many numbers stand at its end.
    """

    def __init__(self, packed: bytes, count: int) -> None:
        self._packed = bytearray(packed)
        self._numbers = len(packed) - _DOUBLE * count

    def filled(self, stamp: int, numbers: Row) -> bytes:
        """The message with a stamp [ns] and numbers."""
        _STAMP.pack_into(self._packed, _STAMP_AT, *divmod(stamp, NANOSECONDS))
        self._packed[self._numbers :] = numbers.astype("<f8", copy=False).tobytes()
        return bytes(self._packed)

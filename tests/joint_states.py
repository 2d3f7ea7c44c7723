"""Joint states of a rosbag2 SQLite file, as tests of real logs need them."""

import sqlite3
import struct
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

# What precedes the fields of a serialised message.
_HEADER = 4


class _Reader:
    """Numbers and texts of one CDR message, little endian."""

    def __init__(self, data: bytes) -> None:
        self._data, self._at = data, _HEADER

    def number(self, form: str, size: int) -> float:
        self._align(size)
        (value,) = struct.unpack_from("<" + form, self._data, self._at)
        self._at += size
        return value

    def text(self) -> str:
        length = int(self.number("I", 4))
        text = self._data[self._at : self._at + length - 1].decode()
        self._at += length
        return text

    def doubles(self) -> NDArray[np.float64]:
        length = int(self.number("I", 4))
        if length == 0:
            return np.zeros(0)
        self._align(8)
        values = np.frombuffer(self._data, "<f8", length, self._at)
        self._at += 8 * length
        return values

    def _align(self, size: int) -> None:
        self._at += -(self._at - _HEADER) % size


def joint_states(path: Path, joints: list[str]) -> tuple[NDArray[np.float64], ...]:
    """Time `(n,)` [s], and position, velocity and effort of the joints, `(n, joints)` each."""
    rows = []
    with sqlite3.connect(path) as bag:
        query = (
            "select data from messages where topic_id in "
            "(select id from topics where name like '%joint_states') order by timestamp"
        )
        for (data,) in bag.execute(query):
            reader = _Reader(data)
            time = reader.number("i", 4) + 1e-9 * reader.number("I", 4)
            reader.text()
            names = [reader.text() for _ in range(int(reader.number("I", 4)))]
            order = [names.index(joint) for joint in joints]
            rows.append((time, *(reader.doubles()[order] for _ in range(3))))
    time = np.array([row[0] for row in rows])
    new = np.r_[True, np.diff(time) > 0.0]
    columns = (np.array([row[k] for row in rows])[new] for k in (1, 2, 3))
    return (time[new], *columns)

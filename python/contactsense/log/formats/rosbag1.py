"""Bags of ROS 1 (version 2.0), without their index: what lies before a cut is readable."""

from __future__ import annotations

import mmap
from pathlib import Path
from struct import Struct

from ..._extras import require
from ...errors import InputError
from ..recording import Recording
from .collect import BATCH_BYTES, Channel, Collector
from .mapping import UnpackError, mapped, unpack_bz2, unpack_lz4
from .messages import IsWanted

MAGIC = b"#ROSBAG V2.0\n"
MESSAGE, BAG, CHUNK, CONNECTION = 0x02, 0x03, 0x05, 0x07
MAX_CHUNK = 2**28  # bytes of one unpacked chunk; rosbag makes chunks of 768 kB
_U32 = Struct("<I")
_TIME = Struct("<II")
# The header of a message in the orders that rosbag writes in C++ and in Python, each field after its length.
_CPP = Struct("<I5sII3sBI5sII")
_PYTHON = Struct("<I3sBI5sII5sII")

Buffer = bytes | mmap.mmap
Header = dict[bytes, bytes]


class RecordError(Exception):
    """A record is broken."""


class HeaderError(RecordError):
    """The header of a record is broken, so its length cannot be trusted either."""


def read(path: Path, is_wanted: IsWanted | None = None) -> Recording:
    """Reads all messages with numbers; `is_wanted(topic, type)` chooses other topics than usual.

    Raises:
        InputError: it is no bag of ROS 1.
        MissingExtraError: rosbags is not installed.
    """
    require("log", "rosbags")
    collector = Collector(is_wanted)
    with mapped(path, collector.damage) as data:
        if data[: len(MAGIC)] != MAGIC:
            raise InputError(f"{path.name}: must be a bag of ROS 1, version 2.0")
        _File(path.name, data, collector).read()
    return collector.recording()


class _File:
    def __init__(self, name: str, data: mmap.mmap, collector: Collector) -> None:
        self.name, self.data, self.collector = name, data, collector
        # By number; None for those left out.
        self.channels: dict[int, Channel | None] = {}
        self.waiting = 0
        self.has_index_been_read = False
        self.index = 0  # where the index begins

    def read(self) -> None:
        end = self._records(self.data, len(MAGIC), False)
        if end != len(self.data):
            self.collector.broken(f"{self.name}: is cut or broken at byte {end} of {len(self.data)}")
        elif not 0 < self.index < end:
            self.collector.broken(f"{self.name}: ends without an index at byte {end} of {end}")

    def _records(self, data: Buffer, at: int, is_chunk: bool) -> int:
        """Reads records; returns where no further one begins."""
        end, channels = len(data), self.channels
        while at + 8 <= end:
            (length,) = _U32.unpack_from(data, at)
            body = at + 8 + length
            if body > end:
                return at
            (size,) = _U32.unpack_from(data, body - 4)
            if body + size > end:
                return at
            try:
                code, number, time = message_head(data[at + 4 : body - 4])
                if code == MESSAGE:
                    channel = channels.get(number)
                    if channel is not None:
                        channel.data.append(data[body : body + size])
                        channel.times.append(time)
                        self.waiting += size
                        if self.waiting > BATCH_BYTES:
                            self.waiting = 0
                            self.collector.flush()
                    elif number not in channels:
                        self._find(number)
                        continue
                elif code == CONNECTION:
                    self._connection(number, header(data[at + 4 : body - 4]), data[body : body + size])
                elif code == CHUNK and not is_chunk:
                    self._chunk(header(data[at + 4 : body - 4]), data[body : body + size])
                elif code == BAG and not is_chunk:
                    self.index = int.from_bytes(
                        header(data[at + 4 : body - 4]).get(b"index_pos", b""), "little"
                    )
            except HeaderError:
                return at
            except RecordError as error:
                self.collector.broken(f"{self.name}: the record at byte {at} is skipped, {error}")
            at = body + size
        return at

    def _find(self, number: int) -> None:
        """Looks for a connection whose own record was lost in the index at the end, which repeats all."""
        if not self.has_index_been_read and self.index:
            self.has_index_been_read = True
            self._records(self.data, self.index, True)
        if number not in self.channels:
            self.channels[number] = None
            self.collector.broken(f"{self.name}: messages are of a connection {number} that is not there")

    def _chunk(self, head: Header, body: bytes) -> None:
        size = _number(head, b"size")
        if size > MAX_CHUNK:
            raise RecordError("its size is not possible")
        compression = head.get(b"compression", b"")
        try:
            if compression == b"bz2":
                body = unpack_bz2(body, size)
            elif compression == b"lz4":
                body = unpack_lz4(body, size)
            elif compression != b"none":
                raise RecordError("its compression is not known")
        except UnpackError as error:
            raise RecordError(str(error)) from error
        end = self._records(body, 0, True)
        if end != len(body) or len(body) != size:
            raise RecordError(f"its records are broken from their byte {end}")

    def _connection(self, number: int, head: Header, body: bytes) -> None:
        if number in self.channels:
            return
        about = header(body)
        topic, kind, definition = (
            part.decode("utf-8", "replace")
            for part in (
                head.get(b"topic", b""),
                about.get(b"type", b""),
                about.get(b"message_definition", b""),
            )
        )
        self.channels[number] = self.collector.channel(topic, kind, "ros1", definition)


def message_head(head: bytes) -> tuple[int, int, int]:
    """The record's kind, its connection and its time [ns] (0 where it has none)."""
    if len(head) == _CPP.size:
        a, conn, number, b, op, code, c, stamp, seconds, nanoseconds = _CPP.unpack(head)
        if conn != b"conn=":
            b, op, code, a, conn, number, c, stamp, seconds, nanoseconds = _PYTHON.unpack(head)
        if (a, b, c, conn, op, stamp) == (9, 4, 13, b"conn=", b"op=", b"time="):
            return code, number, seconds * 1_000_000_000 + nanoseconds
    fields = header(head)
    kind = fields.get(b"op", b"")
    if len(kind) != 1:
        raise HeaderError("it does not say what it is")
    if kind[0] not in (MESSAGE, CONNECTION):
        return kind[0], 0, 0
    time = fields.get(b"time", b"")
    seconds, nanoseconds = _TIME.unpack(time) if len(time) == 8 else (0, 0)
    return kind[0], _number(fields, b"conn"), seconds * 1_000_000_000 + nanoseconds


def header(data: bytes) -> Header:
    """The fields of a record's header, or of a connection."""
    fields, at = {}, 0
    while at + 4 <= len(data):
        (length,) = _U32.unpack_from(data, at)
        field = data[at + 4 : at + 4 + length]
        name, mark, value = field.partition(b"=")
        if len(field) != length or not mark:
            raise HeaderError("its header is broken")
        fields[name] = value
        at += 4 + length
    if at != len(data):
        raise HeaderError("its header is broken")
    return fields


def _number(head: Header, name: bytes) -> int:
    value = head.get(name, b"")
    if len(value) != 4:
        raise RecordError(f"its header lacks {name.decode()}")
    return int.from_bytes(value, "little")

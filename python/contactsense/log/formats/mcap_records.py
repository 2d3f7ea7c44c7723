"""The records of an MCAP file, without its index: what lies before a cut is readable."""

from __future__ import annotations

import mmap
import zlib
from dataclasses import dataclass
from struct import Struct
from struct import error as StructError

from .mapping import UnpackError, unpack_lz4, unpack_zstd

MAGIC = b"\x89MCAP0\r\n"
SCHEMA, CHANNEL, MESSAGE, CHUNK, DATA_END = 0x03, 0x04, 0x05, 0x06, 0x0F
FOOTER_BYTES = 9 + 20 + len(MAGIC)  # the footer's record and the closing magic
MAX_CHUNK = 2**28  # bytes of one unpacked chunk; writers make chunks of 1 to 4 MB

FRAME = Struct("<BQ")  # opcode, length of what follows
MESSAGE_HEAD = Struct("<BQHIqq")  # opcode, length, channel, sequence, log time, publish time [ns]
_CHUNK_HEAD = Struct(
    "<QQQII"
)  # first time, last time, unpacked size, checksum, length of the compression's name
_U16, _U32, _U64 = Struct("<H"), Struct("<I"), Struct("<Q")

Buffer = bytes | mmap.mmap


class RecordError(Exception):
    """A record does not hold what its kind must hold."""


@dataclass(frozen=True)
class Schema:
    """A type and its definition."""

    name: str
    encoding: str
    definition: str


@dataclass(frozen=True)
class ChannelRecord:
    """Messages of one topic and one publisher."""

    number: int
    schema: int
    topic: str
    encoding: str


def parse_schema(body: bytes) -> tuple[int, Schema]:
    """The schema and its number."""
    try:
        (number,) = _U16.unpack_from(body)
        name, at = _text(body, 2)
        encoding, at = _text(body, at)
        definition, at = _text(body, at)
    except StructError as error:
        raise RecordError("a schema is broken") from error
    return number, Schema(name, encoding, definition)


def parse_channel(body: bytes) -> ChannelRecord:
    """The channel a record tells of."""
    try:
        (number,), (schema,) = _U16.unpack_from(body), _U16.unpack_from(body, 2)
        topic, at = _text(body, 4)
        encoding, at = _text(body, at)
    except StructError as error:
        raise RecordError("a channel is broken") from error
    return ChannelRecord(number, schema, topic, encoding)


def _text(body: bytes, at: int) -> tuple[str, int]:
    (length,) = _U32.unpack_from(body, at)
    end = at + 4 + length
    if end > len(body):
        raise RecordError("a text is longer than its record")
    return body[at + 4 : end].decode("utf-8", "replace"), end


def unpack_chunk(body: bytes) -> bytes:
    """The records within a chunk."""
    try:
        _, _, size, checksum, length = _CHUNK_HEAD.unpack_from(body)
        compression, at = body[_CHUNK_HEAD.size :][:length], _CHUNK_HEAD.size + length
        (stored,) = _U64.unpack_from(body, at)
    except StructError as error:
        raise RecordError("its head is broken") from error
    packed = body[at + 8 : at + 8 + stored]
    if len(packed) != stored or size > MAX_CHUNK:
        raise RecordError("its sizes are not possible")
    try:
        if compression == b"zstd":
            packed = unpack_zstd(packed, size) if size else b""
        elif compression == b"lz4":
            packed = unpack_lz4(packed, size) if size else b""
        elif compression:
            raise RecordError("its compression is not known")
    except UnpackError as error:
        raise RecordError(str(error)) from error
    if len(packed) != size:
        raise RecordError("it has another size than it says")
    if checksum and zlib.crc32(packed) != checksum:
        raise RecordError("its checksum is wrong")
    return packed


def summary_start(data: mmap.mmap) -> int | None:
    """Where the summary begins, which repeats schemas and channels; None without one."""
    at = len(data) - FOOTER_BYTES
    if at < len(MAGIC) or data[-len(MAGIC) :] != MAGIC or data[at] != 0x02:
        return None
    (start,) = _U64.unpack_from(data, at + 9)
    return start if len(MAGIC) <= start < at else None

"""MCAP files of ROS 1 and ROS 2, also cut or corrupt ones."""

from __future__ import annotations

import mmap
from pathlib import Path

from ..._extras import require
from ...errors import InputError
from ..recording import Recording
from .collect import BATCH_BYTES, Channel, Collector
from .mapping import mapped
from .mcap_records import (
    CHANNEL,
    CHUNK,
    DATA_END,
    FRAME,
    MAGIC,
    MESSAGE,
    MESSAGE_HEAD,
    SCHEMA,
    Buffer,
    RecordError,
    Schema,
    parse_channel,
    parse_schema,
    summary_start,
    unpack_chunk,
)
from .messages import IsWanted


def read(path: Path, is_wanted: IsWanted | None = None) -> Recording:
    """Reads all messages with numbers; `is_wanted(topic, type)` chooses other topics than usual.

    Raises:
        InputError: it is no MCAP file.
        MissingExtraError: rosbags is not installed.
    """
    require("log", "rosbags")
    collector = Collector(is_wanted)
    add(path, collector)
    return collector.recording()


def add(path: Path, collector: Collector) -> None:
    """Reads one part of a bag."""
    with mapped(path, collector.damage) as data:
        if data[: len(MAGIC)] != MAGIC:
            raise InputError(f"{path.name}: must be an MCAP file")
        _File(path.name, data, collector).read()


class _File:
    def __init__(self, name: str, data: mmap.mmap, collector: Collector) -> None:
        self.name, self.data, self.collector = name, data, collector
        self.schemas: dict[int, Schema] = {}
        # By number; None for those left out.
        self.channels: dict[int, Channel | None] = {}
        self.waiting = 0
        self.has_summary_been_read = False

    def read(self) -> None:
        at = self._records(self.data, len(MAGIC), len(self.data), 0)
        if at < 0:
            return
        what = "ends without an end mark" if at == len(self.data) else "is cut or broken"
        self.collector.broken(f"{self.name}: {what} at byte {at} of {len(self.data)}")

    def _records(self, data: Buffer, at: int, end: int, chunk: int) -> int:
        """Reads records; returns where no further one begins, or -1 at the end of the data.

        `chunk` is where the chunk begins that the records are in, or 0.
        """
        channels = self.channels
        while at + 9 <= end:
            code, length = FRAME.unpack_from(data, at)
            following = at + 9 + length
            if following > end or not code:
                return at
            if code == MESSAGE and length >= 22:
                _, _, number, _, time, _ = MESSAGE_HEAD.unpack_from(data, at)
                channel = channels.get(number)
                if channel is not None:
                    channel.data.append(data[at + 31 : following])
                    channel.times.append(time)
                    self.waiting += length
                    if self.waiting > BATCH_BYTES:
                        self._flush()
                elif number not in channels:
                    self._find(number, chunk or at)
                    if channels[number] is not None:
                        continue
            elif code == DATA_END and not chunk:
                return -1
            elif code in (SCHEMA, CHANNEL) or (code == CHUNK and not chunk):
                try:
                    self._record(code, data[at + 9 : following], at)
                except RecordError as error:
                    kind = "chunk" if code == CHUNK else "record"
                    self.collector.broken(
                        f"{self.name}: the {kind} at byte {chunk or at} is skipped, {error}"
                    )
            at = following
        return at

    def _record(self, code: int, body: bytes, at: int) -> None:
        if code == SCHEMA:
            number, schema = parse_schema(body)
            self.schemas.setdefault(number, schema)
        elif code == CHANNEL:
            self._channel(body)
        else:
            records = unpack_chunk(body)
            end = self._records(records, 0, len(records), at)
            if end != len(records):
                raise RecordError(f"its records are broken from their byte {end}")

    def _channel(self, body: bytes) -> None:
        record = parse_channel(body)
        if record.number in self.channels:
            return
        schema = self.schemas.get(record.schema, Schema("", "", ""))
        encoding = (
            record.encoding if schema.encoding in ("ros1msg", "ros2msg", "ros2idl", "") else schema.encoding
        )
        self.channels[record.number] = self.collector.channel(
            record.topic, schema.name, encoding, schema.definition, schema.encoding == "ros2idl"
        )

    def _find(self, number: int, at: int) -> None:
        """Looks for a channel whose own record was lost in the summary, which repeats all."""
        start = None if self.has_summary_been_read else summary_start(self.data)
        self.has_summary_been_read = True
        while start is not None and start + 9 <= len(self.data):
            code, length = FRAME.unpack_from(self.data, start)
            if start + 9 + length > len(self.data) or not code:
                break
            if code in (SCHEMA, CHANNEL):
                try:
                    self._record(code, self.data[start + 9 : start + 9 + length], start)
                except RecordError:
                    break
            start += 9 + length
        if number not in self.channels:
            self.channels[number] = None
            self.collector.broken(
                f"{self.name}: messages from byte {at} on are of a channel {number} that is not there"
            )

    def _flush(self) -> None:
        self.waiting = 0
        self.collector.flush()

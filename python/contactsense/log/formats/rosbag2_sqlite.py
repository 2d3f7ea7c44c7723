"""SQLite files of rosbag2, also cut or corrupt ones."""

from __future__ import annotations

from array import array
from pathlib import Path
from typing import Any

from ..._extras import require
from ...errors import InputError
from ..recording import Recording
from .collect import BATCH_BYTES, Channel, Collector
from .mapping import mapped
from .messages import IsWanted
from .sqlite_pages import LEAF, Database
from .sqlite_rows import PageError, record, usual_message


def read(path: Path, is_wanted: IsWanted | None = None) -> Recording:
    """Reads all messages with numbers; `is_wanted(topic, type)` chooses other topics than usual.

    Raises:
        InputError: it is no SQLite file, or none of rosbag2.
        MissingExtraError: rosbags is not installed.
    """
    require("log", "rosbags")
    collector = Collector(is_wanted)
    add(path, collector)
    return collector.recording()


def add(path: Path, collector: Collector) -> None:
    """Reads one part of a bag."""
    with mapped(path, collector.damage) as data:
        try:
            database = Database(data, _log_of(path))
        except PageError:
            raise InputError(f"{path.name}: must be an SQLite file") from None
        _File(path, database, collector).read()


class _File:
    def __init__(self, path: Path, database: Database, collector: Collector) -> None:
        self.path, self.database, self.collector = path, database, collector
        self.channels: dict[int, Channel | None] = {}
        self.rows = array("q")
        self.waiting = 0
        self.size = 0  # bytes of all messages

    def read(self) -> None:
        broken: list[int] = []
        roots = {row[1]: row[3] for _, row in self.database.rows(1, broken) if _is_table(row)}
        if not {"topics", "messages"} & roots.keys() and not (broken or self.database.is_cut):
            raise InputError(
                f"{self.path.name}: must be a bag of rosbag2, with the tables topics and messages"
            )
        self._topics(roots, broken)
        read = set()
        for number in self.database.leaves(roots.get("messages", 0), broken):
            read.add(number)
            self._leaf(number, broken)
        if broken or self.database.is_cut:
            self._lost_leaves(read)
            where = f"page {min(broken)}" if broken else "its last page"
            size = f"{self.database.pages} pages of {self.database.page_size} bytes"
            self.collector.broken(f"{self.path.name}: is cut or broken at {where} ({size})")
        if self.database.is_log_cut:
            self.collector.broken(f"{_log_of(self.path).name}: is cut or broken after its last whole rows")

    def _topics(self, roots: dict[str, int], broken: list[int]) -> None:
        definitions: dict[str, tuple[str, str]] = {}
        for _, row in (
            self.database.rows(roots["message_definitions"], broken) if "message_definitions" in roots else ()
        ):
            if len(row) >= 4 and all(isinstance(value, str) for value in row[1:4]):
                definitions[row[1]] = (row[2], row[3])
        for number, row in self.database.rows(roots.get("topics", 0), broken):
            if len(row) < 4 or not all(isinstance(value, str) for value in row[1:4]):
                continue
            form, definition = definitions.get(row[2], ("", ""))
            self.channels[number] = self.collector.channel(
                row[1], row[2], row[3], definition, form == "ros2idl"
            )

    def _lost_leaves(self, read: set[int]) -> None:
        """Leaf pages that no readable page leads to: their rows tell whether they are messages."""
        rows, self.rows = set(self.rows), array("q")
        for number in range(2, self.database.pages + 1):
            if number not in read and self._is_leaf(number):
                self._leaf(number, [], rows)

    def _is_leaf(self, number: int) -> bool:
        try:
            return self.database.page(number)[0] == LEAF
        except PageError:
            return False

    def _leaf(self, number: int, broken: list[int], known: set[int] | None = None) -> None:
        page, usable, end = self.database.page(number), self.database.usable, self.database.size
        channels, rows = self.channels, self.rows
        for at in self.database.cells(page, 100 if number == 1 else 0):
            try:
                row, topic, time, data = usual_message(page, at, usable) or self._message(page, at)
            except PageError:
                broken.append(number)
                continue
            self.size += len(data)
            if self.size > end:  # rows that share bytes would have no end
                broken.append(number)
                return
            if known is not None and row in known:
                continue
            rows.append(row)
            channel = channels.get(topic)
            if channel is not None:
                channel.data.append(data)
                channel.times.append(time)
                self.waiting += len(data)
                if self.waiting > BATCH_BYTES:
                    self.waiting = 0
                    self.collector.flush()

    def _message(self, page: bytes, at: int) -> tuple[int, int, int, bytes]:
        row, content = self.database.payload(page, at)
        values = record(content)
        if [type(value) for value in values[1:]] != [int, int, bytes]:
            raise PageError("a row is not a message")
        return row, values[1], values[2], values[3]


def _log_of(path: Path) -> Path:
    """Where SQLite keeps the pages that it has not yet written to a file."""
    return path.with_name(path.name + "-wal")


def _is_table(row: list[Any]) -> bool:
    return len(row) >= 5 and row[0] == "table" and isinstance(row[1], str) and isinstance(row[3], int)

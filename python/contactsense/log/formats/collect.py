"""Messages of all topics, gathered into tables batch by batch."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ..recording import Recording, Table
from .layout import Layout, LayoutError
from .mapping import UnpackError, is_zstd, unpack_zstd
from .messages import IsWanted, default_wanted, normal_kind, types_of
from .walk import Types, Walk

BATCH_BYTES = 2**23  # of messages decoded at once: large enough for numpy, small beside a log
MAX_LAYOUTS = 1000  # shapes of one topic: each costs a walk; a topic with more is no stream of measurements
MAX_FAILURES = 200  # messages of one topic that fit no shape; from then on no new shapes are looked for
MAX_FRAMES = 8  # different names of a frame kept of one topic: measurements have one
MAX_MESSAGE = 2**26  # bytes of one unpacked message
MAX_BREAKS = 20  # places of damage that are told one by one

Ints = NDArray[np.int64]


@dataclass
class Rows:
    """Rows of one table, in blocks."""

    names: tuple[str, ...]
    blocks: list[NDArray[np.float64]] = field(default_factory=list)
    times: list[Ints] = field(default_factory=list)
    orders: list[Ints] = field(default_factory=list)
    frames: dict[str, dict[str, None]] = field(default_factory=dict)

    def note_frames(self, layout: Layout, rows: NDArray[np.uint8]) -> None:
        """Which frames the messages name."""
        for frame in layout.frames:
            known = self.frames.setdefault(frame.name, {})
            if len(known) < MAX_FRAMES:
                known.update(dict.fromkeys(frame.names(rows, MAX_FRAMES)))

    def table(self, topic: str, kind: str) -> Table:
        """All rows in the order of reception; empties the blocks."""
        times, orders = np.concatenate(self.times), np.concatenate(self.orders)
        columns = {name: np.concatenate([b[:, i] for b in self.blocks]) for i, name in enumerate(self.names)}
        self.blocks.clear()
        if np.any(np.diff(times) < 0) or np.any(np.diff(orders) < 0):
            by_time = np.lexsort((orders, times))
            columns = {name: column[by_time] for name, column in columns.items()}
            times = times[by_time]
        frames = {name: tuple(known) for name, known in self.frames.items()}
        return Table(topic, kind, columns, np.asarray(times * 1e-9, np.float64), frames)


@dataclass
class Channel:
    """Messages of one publisher that wait to be decoded: append to `data` and `times` [ns] together."""

    topic: str
    kind: str
    encoding: str
    types: Types
    tables: dict[frozenset[str], Rows]
    data: list[bytes] = field(default_factory=list)
    times: list[int] = field(default_factory=list)
    layouts: dict[int, list[Layout]] = field(default_factory=dict)
    found: int = 0
    seen: int = 0
    failures: int = 0
    reason: str = ""

    def flush(self) -> None:
        """Decodes what waits."""
        if not self.data:
            return
        data, times = self.data, np.array(self.times, np.int64)
        self.data, self.times = [], []
        order = np.arange(self.seen, self.seen + len(data))
        self.seen += len(data)
        if self.encoding == "cdr" and any(map(is_zstd, data)):
            data = [self._unpacked(message) for message in data]
        lengths = np.fromiter(map(len, data), np.int64, len(data))
        for length in np.unique(lengths):
            picked = np.flatnonzero(lengths == length)
            some = data if len(picked) == len(data) else [data[i] for i in picked]
            rows = np.frombuffer(b"".join(some), np.uint8).reshape(len(some), int(length))
            self._decode(rows, times[picked], order[picked])

    def _unpacked(self, message: bytes) -> bytes:
        try:
            return unpack_zstd(message, MAX_MESSAGE) if is_zstd(message) else message
        except UnpackError:
            return b""

    def _decode(self, rows: NDArray[np.uint8], times: Ints, order: Ints) -> None:
        known = self.layouts.setdefault(rows.shape[1], [])
        tried = 0
        while len(rows):
            if tried == len(known) and not self._learn(rows[0].tobytes(), known):
                if self.found >= MAX_LAYOUTS or self.failures >= MAX_FAILURES:
                    self.failures += len(rows)
                    return
                self.failures += 1
                rows, times, order = rows[1:], times[1:], order[1:]
                continue
            layout = known[tried]
            tried += 1
            fits = layout.fits(rows)
            if fits.all():
                self._store(layout, rows, times, order)
                return
            if fits.any():
                self._store(layout, rows[fits], times[fits], order[fits])
                rows, times, order = rows[~fits], times[~fits], order[~fits]

    def _learn(self, message: bytes, known: list[Layout]) -> bool:
        if self.found >= MAX_LAYOUTS or self.failures >= MAX_FAILURES:
            return False
        try:
            known.append(Walk(message, self.types, self.encoding).layout(self.kind))
        except LayoutError as error:
            self.reason = self.reason or str(error)
            return False
        self.found += 1
        return True

    def _store(self, layout: Layout, rows: NDArray[np.uint8], times: Ints, order: Ints) -> None:
        if not layout.names:
            return
        numbers = layout.read(rows)
        table = self.tables.setdefault(frozenset(layout.names), Rows(layout.names))
        if table.names != layout.names:
            place = {name: i for i, name in enumerate(layout.names)}
            numbers = numbers[:, [place[name] for name in table.names]]
        table.note_frames(layout, rows)
        table.blocks.append(numbers)
        table.times.append(times)
        table.orders.append(order)


class Collector:
    """Gathers the messages of one file, or of all parts of a bag."""

    def __init__(self, is_wanted: IsWanted | None) -> None:
        self.is_wanted = is_wanted
        self.tables: dict[tuple[str, str], dict[frozenset[str], Rows]] = {}
        self.channels: list[Channel] = []
        self.left_out: dict[str, None] = {}
        self.damage: list[str] = []
        self.breaks = 0

    def channel(
        self, topic: str, kind: str, encoding: str, definition: str, is_idl: bool = False
    ) -> Channel | None:
        """Where messages of a topic go, or None where they are left out."""
        kind = normal_kind(kind)
        if self.is_wanted is not None and not self.is_wanted(topic, kind):
            return self._without(topic, kind, "not wanted")
        if self.is_wanted is None and not default_wanted(kind, None):
            return self._without(topic, kind, "no measurements of joints or forces")
        if encoding not in ("cdr", "ros1"):
            return self._without(topic, kind, f"serialised as {encoding!r}, which is not read")
        types = types_of(kind, encoding, definition, is_idl)
        if types is None:
            return self._without(topic, kind, "no definition of the type")
        if self.is_wanted is None and not default_wanted(kind, types):
            return self._without(topic, kind, "no measurements of joints or forces")
        channel = Channel(topic, kind, encoding, types, self.tables.setdefault((topic, kind), {}))
        self.channels.append(channel)
        return channel

    def _without(self, topic: str, kind: str, reason: str) -> Channel | None:
        self.left_out[f"{topic} ({kind}): {reason}"] = None
        return None

    @property
    def messages(self) -> int:
        """How many messages were read so far."""
        return sum(
            rows.shape[0] for tables in self.tables.values() for t in tables.values() for rows in t.blocks
        )

    def flush(self) -> None:
        """Decodes all that waits."""
        for channel in self.channels:
            channel.flush()

    def broken(self, where: str) -> None:
        """Notes a damage together with how many messages have been read."""
        self.breaks += 1
        if self.breaks <= MAX_BREAKS:
            self.flush()
            self.damage.append(f"{where}; {self.messages} messages were read before")

    def recording(self) -> Recording:
        """All that was gathered."""
        self.flush()
        if self.breaks > MAX_BREAKS:
            self.damage.append(
                f"and {self.breaks - MAX_BREAKS} further places; {self.messages} messages were read"
            )
        for channel in self.channels:
            if channel.failures:
                reason = channel.reason or "they have too many shapes"
                text = f"{channel.failures} of {channel.seen} messages are not read: {reason}"
                self.damage.append(f"{channel.topic} ({channel.kind}): {text}")
        found = [rows.table(*key) for key, tables in self.tables.items() for rows in tables.values()]
        return Recording(tuple(found), tuple(self.left_out), tuple(self.damage))

"""The way over one serialised message by its type, which finds its layout."""

from __future__ import annotations

from typing import Any

import numpy as np

from .layout import Frame, Layout, LayoutError, Read

# A type as rosbags parses it: constants, then the fields by name.
Types = dict[str, Any]

BASE, NAME, ARRAY, SEQUENCE = 1, 2, 3, 4  # rosbags.interfaces.Nodetype
SIZES = {
    "bool": 1,
    "byte": 1,
    "char": 1,
    "int8": 1,
    "uint8": 1,
    "int16": 2,
    "uint16": 2,
    "int32": 4,
    "uint32": 4,
}
SIZES |= {"int64": 8, "uint64": 8, "float32": 4, "float64": 8}
DTYPES = {"bool": "u1", "byte": "i1", "char": "u1"}
DTYPES |= {name: f"{name[0]}{size}" for name, size in SIZES.items() if name not in DTYPES}

# Texts that say in which frame the numbers are.
FRAMES = frozenset({"header.frame_id", "child_frame_id"})
# String sequences by these names label the elements of arrays beside and below them.
LABELS = frozenset({"name", "names", "joint_names", "interface_names"})
# What a type without fields has in ROS 2, where it is sent as one byte, but not in ROS 1.
FILLER = "structure_needs_at_least_one_member"
MAX_COLUMNS = 2048  # of one message: more is no state of a robot, and each costs 8 bytes a message
MAX_ELEMENTS = 512  # of one array of numbers; longer ones are pictures or clouds, and give no columns
MAX_STEPS = 5_000  # fields visited in one message, so that a hostile one cannot hold the reader up
MAX_NAME = 1000  # characters of a field's name with those it is within, which each of its columns repeats
MAX_DEPTH = 32  # of types within types; a type within itself has no end


class Walk:
    """Walks a type over one message; `encoding` is `cdr` or `ros1`."""

    def __init__(self, data: bytes, types: Types, encoding: str) -> None:
        self.data, self.types = data, types
        self.is_cdr = encoding == "cdr"
        self.start = 4 if self.is_cdr else 0
        self.order = "<"
        self.shape: list[tuple[int, int]] = []
        if self.is_cdr:
            if data[:2] not in (b"\0\0", b"\0\1"):
                raise LayoutError("its encapsulation is not plain CDR")
            self.order = "<" if data[1] else ">"
            self.shape.append((0, 2))
        self.at = self.start
        self.steps = 0
        self.names: list[str] = []
        self.reads: list[Read] = []
        self.frames: list[Frame] = []

    def layout(self, kind: str) -> Layout:
        """The layout of the message, which is of the type `kind`."""
        self._message(kind, "", {}, 0)
        if len(self.data) - self.at > (3 if self.is_cdr else 0):  # CDR may be padded to 4 bytes
            raise LayoutError("it is longer than its type")
        spans = [np.arange(first, end) for first, end in self.shape]
        shape = np.concatenate(spans) if spans else np.zeros(0, np.intp)
        if len(set(self.names)) != len(self.names):
            raise LayoutError("two of its numbers have one name")
        return Layout(self.data, shape, tuple(self.names), tuple(self.reads), tuple(self.frames))

    def _take(self, size: int, count: int = 1) -> int:
        if self.is_cdr and count:
            self.at += -(self.at - self.start) % size
        first = self.at
        self.at += size * count
        if self.at > len(self.data):
            raise LayoutError("it is shorter than its type")
        return first

    def _length(self) -> int:
        first = self._take(4)
        self.shape.append((first, first + 4))
        return int.from_bytes(self.data[first : first + 4], "little" if self.order == "<" else "big")

    def _text(self) -> tuple[int, int]:
        length = self._length()
        first = self.at
        self.at += length
        if self.at > len(self.data):
            raise LayoutError("a text in it is longer than the message")
        return first, self.at

    def _label(self) -> str:
        first, end = self._text()
        self.shape.append((first, end))
        return self.data[first:end].rstrip(b"\0").decode("utf-8", "replace")

    def _message(self, kind: str, path: str, labels: dict[int, list[str]], depth: int) -> None:
        fields = self.types.get(kind)
        if fields is None:
            raise LayoutError(f"there is no definition of {kind}")
        if depth > MAX_DEPTH:
            raise LayoutError("its type is nested too deeply")
        if kind in ("builtin_interfaces/msg/Time", "builtin_interfaces/msg/Duration"):
            return self._time(kind.endswith("Duration"), path)
        named = [pair for pair in fields[1] if pair[0] != FILLER]
        if not named and self.is_cdr:
            self._take(1)
        labels = dict(labels)
        for name, description in named:
            self._field(name, description, f"{path}.{name}" if path else name, labels, depth)

    def _time(self, is_duration: bool, path: str) -> None:
        first = self._take(4)
        self._take(4)
        seconds = "i4" if self.is_cdr or is_duration else "u4"
        nanoseconds = "i4" if is_duration and not self.is_cdr else "u4"
        self._column([path], Read(first, self.order + seconds, 1, self.order + nanoseconds))

    def _field(
        self, name: str, description: Any, path: str, labels: dict[int, list[str]], depth: int
    ) -> None:
        self.steps += 1
        if self.steps > MAX_STEPS:
            raise LayoutError("it has too many fields")
        if len(path) > MAX_NAME:
            raise LayoutError("the name of a field in it is too long")
        node, what = int(description[0]), description[1]
        if node == NAME:
            self._message(what, path, labels, depth + 1)
        elif node == BASE:
            self._base(what[0], path)
        elif node == ARRAY:
            self._elements(name, what[0], int(what[1]), path, labels, depth)
        else:
            self._elements(name, what[0], self._length(), path, labels, depth)

    def _base(self, base: str, path: str) -> None:
        if base == "string":
            first, end = self._text()
            if path in FRAMES:
                self.frames.append(Frame(path, first, end))
            return
        if base not in SIZES:
            raise LayoutError(f"{base} is not read")
        first = self._take(SIZES[base])
        self._column([path], Read(first, self.order + DTYPES[base]))

    def _elements(
        self, name: str, element: Any, count: int, path: str, labels: dict[int, list[str]], depth: int
    ) -> None:
        if count > len(self.data):
            raise LayoutError("an array in it is longer than the message")
        node, what = int(element[0]), element[1]
        if node == BASE and what[0] == "string":
            self.steps += count
            if self.steps > MAX_STEPS:
                raise LayoutError("it has too many fields")
            if name not in LABELS:
                for _ in range(count):
                    self._text()
                return
            texts = [self._label() for _ in range(count)]
            if len(set(texts)) == count and all(texts):
                labels.clear()  # the innermost labels are the ones that count
                labels[count] = texts
            return
        marks = labels.get(count) or [str(index) for index in range(min(count, MAX_STEPS))]
        if node == BASE:
            base = what[0]
            if base not in SIZES:
                raise LayoutError(f"{base} is not read")
            first = self._take(SIZES[base], count)
            if 0 < count <= MAX_ELEMENTS:
                self._column(
                    [f"{path}[{mark}]" for mark in marks], Read(first, self.order + DTYPES[base], count)
                )
            return
        if count > MAX_STEPS:
            raise LayoutError("it has too many fields")
        for mark in marks[:count]:
            self._field(name, element, f"{path}[{mark}]", labels, depth)

    def _column(self, names: list[str], read: Read) -> None:
        self.names += names
        self.reads.append(read)
        if len(self.names) > MAX_COLUMNS:
            raise LayoutError(f"it has more than {MAX_COLUMNS} numbers")

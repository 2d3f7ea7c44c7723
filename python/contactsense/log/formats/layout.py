"""Where the numbers of a serialised message lie, so that many messages of one shape are read at once."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray


class LayoutError(Exception):
    """The message does not fit its type, or is too large for a table."""


@dataclass(frozen=True)
class Read:
    """`count` numbers side by side; or one time, if `nanoseconds` gives the type of its second half."""

    offset: int
    dtype: str
    count: int = 1
    nanoseconds: str = ""


@dataclass(frozen=True)
class Frame:
    """Where a message names a frame: the field, and its bytes."""

    name: str
    first: int
    end: int

    def names(self, rows: NDArray[np.uint8], most: int) -> list[str]:
        """The different names in messages of one shape, at most so many."""
        texts = rows[:, self.first : self.end]
        found: list[str] = []
        while len(texts) and len(found) < most:
            found.append(texts[0].tobytes().rstrip(b"\0").decode("utf-8", "replace"))
            texts = texts[(texts != texts[0]).any(axis=1)]
        return found


@dataclass(frozen=True)
class Layout:
    """One shape of a message: the bytes that decide it, and where the numbers are."""

    example: bytes
    shape: NDArray[np.intp]
    names: tuple[str, ...]
    reads: tuple[Read, ...]
    frames: tuple[Frame, ...] = ()

    def fits(self, rows: NDArray[np.uint8]) -> NDArray[np.bool_]:
        """Which of the messages (one a row, of the example's length) have this shape."""
        example = np.frombuffer(self.example, np.uint8)[self.shape]
        same: NDArray[np.bool_] = (rows[:, self.shape] == example).all(axis=1)
        return same

    def read(self, rows: NDArray[np.uint8]) -> NDArray[np.float64]:
        """All columns, `(n, columns)`."""
        out = np.empty((len(rows), len(self.names)))
        column = 0
        for part in self.reads:
            with np.errstate(invalid="ignore"):  # a NaN that signals stays a NaN
                out[:, column : column + part.count] = _numbers(rows, part.offset, part.dtype, part.count)
            if part.nanoseconds:
                out[:, column] += _numbers(rows, part.offset + 4, part.nanoseconds, 1)[:, 0] * 1e-9
            column += part.count
        return out


def _numbers(rows: NDArray[np.uint8], offset: int, dtype: str, count: int) -> NDArray[Any]:
    size = np.dtype(dtype).itemsize * count
    return np.ascontiguousarray(rows[:, offset : offset + size]).view(dtype)

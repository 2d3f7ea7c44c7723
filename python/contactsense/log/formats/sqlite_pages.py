"""Rows of SQLite tables straight from the file's pages, so that a cut or broken file still gives its rows.

Nothing in the file is run (no views, no triggers), and nothing is written next to it.
"""

from __future__ import annotations

import mmap
from collections.abc import Iterator
from pathlib import Path
from struct import unpack_from
from typing import Any

from .sqlite_rows import PageError, record, varint
from .sqlite_wal import WaitingPages, waiting_pages

MAGIC = b"SQLite format 3\0"
INTERIOR, LEAF = 0x05, 0x0D  # pages of tables
MAX_PAYLOAD = 2**28  # bytes of one row; a message of a robot's state has hundreds


class Database:
    """The pages of one file, and those that wait in its write-ahead log."""

    def __init__(self, data: mmap.mmap, log: Path | None = None) -> None:
        self._data = data
        size = int.from_bytes(data[16:18], "big")
        self.page_size = 65536 if size == 1 else size
        if data[:16] != MAGIC or self.page_size < 512 or self.page_size & (self.page_size - 1):
            raise PageError("no head of SQLite")
        self.usable = self.page_size - data[20]
        if self.usable < 480:
            raise PageError("no head of SQLite")
        self._waiting = WaitingPages() if log is None else waiting_pages(log, self.page_size)
        self.is_log_cut = self._waiting.is_cut
        # Bytes of all pages.
        self.size = len(data) + self.page_size * len(self._waiting.pages)
        # Rows are read at most twice; rows that share bytes would have no end.
        self._left = 2 * self.size
        in_file = -(-len(data) // self.page_size)
        self.pages = max(in_file, self._waiting.count)
        head = self.page(1)
        said = int.from_bytes(head[28:32], "big")
        lacks = said > in_file and any(
            number not in self._waiting.pages for number in range(in_file + 1, said + 1)
        )
        is_torn = len(data) % self.page_size != 0 and in_file not in self._waiting.pages
        self.is_cut = is_torn or (lacks and head[24:28] == head[92:96])

    def page(self, number: int) -> bytes:
        """The page, or what is left of it where the cut goes through it."""
        waiting = self._waiting.pages.get(number)
        if waiting is not None:
            return waiting
        page = self._data[(number - 1) * self.page_size : number * self.page_size] if number > 0 else b""
        if not page:
            raise PageError(f"page {number} is not there")
        return page

    def leaves(self, root: int, broken: list[int]) -> Iterator[int]:
        """Leaf pages of a table in the order of its rows; pages that cannot be followed go into `broken`."""
        stack, seen = [root], set()
        while stack:
            number = stack.pop()
            try:
                page = self.page(number)
            except PageError:
                broken.append(number)
                continue
            start = 100 if number == 1 else 0
            kind = page[start] if len(page) > start else 0
            if number in seen or kind not in (INTERIOR, LEAF):
                broken.append(number)
                continue
            seen.add(number)
            if kind == LEAF:
                yield number
                continue
            children = [int.from_bytes(page[at : at + 4], "big") for at in self.cells(page, start)]
            children.append(int.from_bytes(page[start + 8 : start + 12], "big"))
            stack += reversed(children)

    def cells(self, page: bytes, start: int = 0) -> tuple[int, ...]:
        """Where the cells of a page begin."""
        count = int.from_bytes(page[start + 3 : start + 5], "big")
        first = start + (12 if page[start] == INTERIOR else 8)
        return unpack_from(f">{max(0, min(count, (len(page) - first) // 2))}H", page.ljust(first), first)

    def payload(self, page: bytes, at: int) -> tuple[int, bytes]:
        """Row number and content of a leaf's cell, with the pages it flows over into."""
        try:
            size, at = varint(page, at)
            row, at = varint(page, at)
        except IndexError:
            raise PageError("a row begins outside its page") from None
        self._left -= size
        if self._left < 0:
            raise PageError("the rows are larger than the file")
        if size <= self.usable - 35:
            if at + size > len(page):
                raise PageError("a row leaves its page")
            return row, page[at : at + size]
        if size > MAX_PAYLOAD:
            raise PageError("a row is too large")
        least = (self.usable - 12) * 32 // 255 - 23
        local = least + (size - least) % (self.usable - 4)
        local = local if local <= self.usable - 35 else least
        if at + local + 4 > len(page):
            raise PageError("a row leaves its page")
        parts, left = [page[at : at + local]], size - local
        following = int.from_bytes(page[at + local : at + local + 4], "big")
        while left > 0:
            take = min(left, self.usable - 4)
            part = self.page(following)
            if 4 + take > len(part):
                raise PageError("a row goes on in a page that is not there")
            parts.append(part[4 : 4 + take])
            following = int.from_bytes(part[:4], "big")
            left -= take
        return row, b"".join(parts)

    def rows(self, root: int, broken: list[int]) -> Iterator[tuple[int, list[Any]]]:
        """All rows of a small table."""
        for number in self.leaves(root, broken):
            page = self.page(number)
            for at in self.cells(page, 100 if number == 1 else 0):
                try:
                    row, content = self.payload(page, at)
                    yield row, record(content)
                except PageError:
                    broken.append(number)

"""Rows of SQLite tables from their bytes."""

from __future__ import annotations

from typing import Any

_INTEGER_SIZES = (0, 1, 2, 3, 4, 6, 8)  # bytes, by the code of a value


class PageError(Exception):
    """A page or row is not there, or broken."""


def varint(data: bytes, at: int) -> tuple[int, int]:
    """A number of one to nine bytes, and where the next begins."""
    value = 0
    for i in range(8):
        byte = data[at + i]
        value = value << 7 | byte & 0x7F
        if byte < 0x80:
            return value, at + i + 1
    return value << 8 | data[at + 8], at + 9


def record(content: bytes) -> list[Any]:
    """The values of a row: None, int, float (as its bytes), str or bytes."""
    values: list[Any] = []
    try:
        head, at = varint(content, 0)
        body = head
        while at < head:
            code, at = varint(content, at)
            if code >= 12:
                size = (code - 12) // 2
            elif code in (8, 9):
                size = 0
            elif code in (10, 11):
                raise PageError("a row is broken")
            else:
                size = 8 if code == 7 else _INTEGER_SIZES[code]
            value, body = content[body : body + size], body + size
            if body > len(content):
                raise PageError("a row is shorter than it says")
            if code == 0:
                values.append(None)
            elif code >= 12:
                values.append(value.decode("utf-8", "replace") if code & 1 else value)
            elif code == 7:
                values.append(value)
            else:
                values.append(code - 8 if size == 0 else int.from_bytes(value, "big", signed=True))
    except IndexError:
        raise PageError("a row is broken") from None
    return values


def usual_message(page: bytes, at: int, usable: int) -> tuple[int, int, int, bytes] | None:
    """Row, topic, time and data of a message in its usual form, which needs no loop; None for another form.

    That is: less than 2^14 bytes, all on this page; of the four values no row number, a topic of at most one
    byte, a time of eight bytes and a blob.
    """
    try:
        size = page[at]
        at += 1
        if size >= 0x80:
            size = (size & 0x7F) << 7 | page[at]
            if page[at] >= 0x80:
                return None
            at += 1
        byte = page[at]
        row = byte & 0x7F
        at += 1
        for _ in range(4):
            if byte < 0x80:
                break
            byte = page[at]
            row = row << 7 | byte & 0x7F
            at += 1
        head, topic_code = page[at], page[at + 2]
        code = page[at + 4]
        if code >= 0x80:
            code = (code & 0x7F) << 7 | page[at + 5]
            if head != 6 or page[at + 5] >= 0x80:
                return None
        elif head != 5:
            return None
        if byte >= 0x80 or page[at + 1] or page[at + 3] != 6 or code < 12 or code & 1 or size > usable - 35:
            return None
        body = at + head
        if topic_code == 1:
            topic = page[body]
            body += 1
        elif topic_code in (8, 9):
            topic = topic_code - 8
        else:
            return None
    except IndexError:
        return None
    end = body + 8 + (code - 12) // 2
    if end != at + size or end > len(page) or topic >= 0x80:
        return None
    return row, topic, int.from_bytes(page[body : body + 8], "big", signed=True), page[body + 8 : end]

"""How a text file of numbers is written: delimiter, decimal sign, header."""

from __future__ import annotations

import csv
import re
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass

# What stands for no number, in lower case; the last ones as C's printf writes it on Windows.
MISSING = ("", "nan", "null", "none", "na", "n/a", "-nan", "nan(ind)", "-nan(ind)", "1.#qnan", "-1.#ind")
BOOLEAN = {"true": 1.0, "false": 0.0}
# RE2, which the parser has, and Python read it alike.
NUMBER = r"^[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?$|^[+-]?[iI][nN][fF]([iI][nN][iI][tT][yY])?$"
# Any number of blanks between two cells.
BLANKS = " "
# Lines looked at in the beginning, the middle and the end each: enough that a decimal comma is seen.
_SAMPLE_LINES = 100
# Bytes looked at for them at each place [B]: a file without line ends is no table.
_SAMPLE_BYTES = 1 << 20
# By preference where several explain the file equally well. A comma in a quoted cell can be a decimal one.
_DIALECTS = [(",", "."), ("\t", "."), (";", "."), ("|", "."), (BLANKS, "."), (",", ",")]
_DIALECTS += [("\t", ","), (";", ","), ("|", ","), (BLANKS, ",")]
_COMMENTS = ("#", "%")

_number = re.compile(NUMBER).match


@dataclass(frozen=True)
class Dialect:
    """How a file is written.

    Args:
        delimiter: between cells; `BLANKS` for any number of blanks or tabs.
        decimal: the decimal sign.
        names: of the columns, as many as most rows have cells.
        body: index of the byte where the rows begin.
        lines: number of lines before the rows.
        numeric: whether the column has numbers in most of the cells that were looked at.
    """

    delimiter: str
    decimal: str
    names: tuple[str, ...]
    body: int
    lines: int
    numeric: tuple[bool, ...]


def dialect_of(data: bytes) -> Dialect | None:
    """The dialect of a file in UTF-8 with line feeds; None if it has no row."""
    start, lines, comment = _after_comments(data)
    places = [start, *(data.find(b"\n", start + (len(data) - start) * part // 8) + 1 for part in (4, 7))]
    samples = [_lines(data, place) for place in places if place > 0 or place == start]
    sample = [line for some in samples for line in some if line.strip()]
    if not sample:
        return None
    first, rest = sample[0], sample[1:] or sample[:1]
    delimiter, decimal = max(_DIALECTS, key=lambda dialect: _fits(rest, *dialect))
    rows = [split(line, delimiter) for line in rest]
    width = Counter(map(len, rows)).most_common(1)[0][0]
    columns = list(zip(*(row for row in rows if len(row) == width), strict=True))
    numeric = tuple(_mostly_numbers(column, decimal) for column in columns)
    header = split(first, delimiter)
    if _is_header(header, numeric, decimal):
        start, lines = _next_line(data, start), lines + 1
        # Units stand below the names: as many texts as there are columns, and numbers below them.
        units = split(_lines(data, start)[0], delimiter)
        if len(units) == width and any(numeric) and _is_text(units, decimal):
            start, lines = _next_line(data, start), lines + 1
    else:
        header = split(comment, delimiter) if comment else []
        if len(header) != width or any(is_number(cell, decimal) for cell in header):
            header = []
    if len(header) == width - 1 and any(columns[-1]):
        header = ["", *header]  # rows have names, as those that R writes
    return Dialect(delimiter, decimal, _names(header, width), start, lines, numeric)


def split(line: str, delimiter: str) -> list[str]:
    """The cells of a line, stripped."""
    if delimiter == BLANKS:
        line, delimiter = " ".join(line.split()), " "
    try:
        cells = next(csv.reader([line], delimiter=delimiter), [])
    except csv.Error:  # a cell of more than 128 KiB
        cells = line.split(delimiter)
    return [cell.strip() for cell in cells]


def is_number(cell: str, decimal: str) -> bool:
    """Whether a cell has a number or a truth value."""
    if decimal != ".":
        cell = cell.replace(".", "x").replace(decimal, ".")
    return _number(cell) is not None or cell.lower() in BOOLEAN


def unique(names: Iterable[str]) -> list[str]:
    """Names of which no two are equal: of equal ones the second gets `.1`, the third `.2`."""
    taken: dict[str, int] = {}
    for name in names:
        new, count = name, 0
        while new in taken:
            taken[name] = count = taken[name] + 1
            new = f"{name}.{count}"
        taken[new] = 0
    return list(taken)


def _after_comments(data: bytes) -> tuple[int, int, str]:
    """Where comments and empty lines before the header end, how many there are, and the last comment."""
    start, lines, comment = 0, 0, ""
    while start < len(data):
        end = _next_line(data, start)
        line = data[start : min(end, start + _SAMPLE_BYTES)].decode("utf-8", "replace").strip()
        if line and not line.startswith(_COMMENTS):
            break
        comment = line.lstrip("#% ")
        start, lines = end, lines + 1
    return start, lines, comment


def _next_line(data: bytes, start: int) -> int:
    return (data.find(b"\n", start) + 1) or len(data)


def _lines(data: bytes, start: int) -> list[str]:
    """Whole lines from a place on; the last of the file may be cut."""
    piece = data[start : start + _SAMPLE_BYTES]
    lines = piece.decode("utf-8", "replace").split("\n")
    if start + len(piece) < len(data) and len(lines) > 1:
        lines.pop()
    return lines[:_SAMPLE_LINES]


def _fits(lines: list[str], delimiter: str, decimal: str) -> tuple[float, int]:
    """How well a dialect explains lines: share of numbers in rows of the usual width, that width."""
    rows = [split(line, delimiter) for line in lines]
    width, often = Counter(map(len, rows)).most_common(1)[0]
    cells = [cell for row in rows if len(row) == width for cell in row]
    good = sum(is_number(cell, decimal) or cell.lower() in MISSING for cell in cells)
    # Two of a hundred cells do not decide against a delimiter that gives several columns.
    share = round(good / max(len(cells), 1) * often / len(rows) * 50) / 50
    return (share if width > 1 else share / 2, width)


def _mostly_numbers(column: Iterable[str], decimal: str) -> bool:
    given = [cell for cell in column if cell.lower() not in MISSING]
    return 2 * sum(is_number(cell, decimal) for cell in given) >= len(given)


def _is_header(cells: list[str], numeric: tuple[bool, ...], decimal: str) -> bool:
    """Whether the first line has names: text over numbers, or nothing but text."""
    over_numbers = (cell for cell, number in zip(cells, numeric, strict=False) if number)
    return any(_is_text([cell], decimal) for cell in over_numbers) or _is_text(cells, decimal)


def _is_text(cells: list[str], decimal: str) -> bool:
    """Whether no cell has a number or is a missing one."""
    return bool(cells) and not any(cell.lower() in MISSING or is_number(cell, decimal) for cell in cells)


def _names(header: list[str], width: int) -> tuple[str, ...]:
    names = (header + [""] * width)[:width]
    return tuple(unique(name or str(index) for index, name in enumerate(names)))

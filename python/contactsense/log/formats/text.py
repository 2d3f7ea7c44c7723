"""Text files of numbers in columns: CSV and its many dialects."""

from __future__ import annotations

import codecs
import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..._extras import require
from ...errors import InputError
from ..recording import Column, Recording, Table
from .dialect import BLANKS, BOOLEAN, MISSING, NUMBER, Dialect, dialect_of, is_number, split
from .unpack import contents

if TYPE_CHECKING:
    import pyarrow as pa

# Endings that are no part of a table's name.
_PACKED = {".gz", ".bz2", ".xz", ".zst"}
# Longest line [B], which is also what is parsed at a time: 10,000 columns need an eightieth of it.
_LONGEST_LINE = 1 << 24
# Bytes by which text of two bytes a character is told without a mark [B].
_LOOK = 200
# Rows before the last with which its last cell is compared, and where they are at most [B].
_NEIGHBOURS, _NEIGHBOURHOOD = 100, 1 << 20


def read(path: Path) -> Recording:
    """Reads a text file of numbers: any delimiter, decimal sign, line end and encoding; header or none.

    Raises:
        InputError: the file cannot be read, is no text, is too large, or has no row of numbers.
        MissingExtraError: pyarrow is not installed.
    """
    require("log", "pyarrow")
    data, broken = contents(path)
    damage = [broken] if broken else []
    data = _lines_of(path, data)
    dialect = dialect_of(data)
    if dialect is None:
        raise InputError(f"path: {path} has no row of numbers{': ' + broken if broken else ''}")
    data, cut = _without_cut_row(data[dialect.body :], dialect, bool(broken))
    data, unreadable = _without_bad_lines(data, dialect)
    columns, texts, wrong = _parsed(path, data, dialect)
    rows = len(next(iter(columns.values()), ()))
    if not rows:
        raise InputError(f"path: {path} has no row of numbers")
    if unreadable + wrong:
        damage.append(
            f"{unreadable + wrong} lines have not the {len(dialect.names)} cells of the others: left out"
        )
    if cut:
        damage.append(f"line {dialect.lines + cut} is cut: the {rows} rows before it were read")
    left_out = tuple(f"{name}: a column of text" for name in texts)
    name = (path.with_suffix("") if path.suffix in _PACKED else path).stem
    return Recording((Table(name, "", columns),), left_out, tuple(damage))


def _lines_of(path: Path, data: bytes) -> bytes:
    """The text in UTF-8, without a mark, with line feeds only."""
    for mark, encoding in ((codecs.BOM_UTF16_LE, "utf-16-le"), (codecs.BOM_UTF16_BE, "utf-16-be")):
        zeros = data[encoding == "utf-16-le" : _LOOK : 2].count(0)
        if data.startswith(mark) or zeros > 0.4 * min(len(data), _LOOK):
            # A last character of which half is there is none.
            data = codecs.getincrementaldecoder(encoding)("replace").decode(data).encode("utf-8", "replace")
            break
    data = data.removeprefix(codecs.BOM_UTF8).rstrip(
        b"\0"
    )  # zeros at the end: the computer stopped while writing
    if b"\0" in data[:_LOOK]:
        raise InputError(f"path: {path} is no text file")
    try:
        data.decode()
    except UnicodeDecodeError as error:
        # After characters that are UTF-8 it is a broken byte, else the file has an older encoding.
        encoding = "latin-1" if data[: error.start].isascii() else "utf-8"
        data = data.decode(encoding, "replace").encode()
    if b"\r" in data:
        data = data.replace(b"\r\n", b"\n").replace(b"\r", b"\n")
    return data


def _without_cut_row(data: bytes, dialect: Dialect, broken: bool) -> tuple[bytes, int]:
    """The rows without the last if that is cut, and then its number, from 1.

    A row without a line end is complete in many files. It is cut if it has too few cells, or if its last
    cell is no number or shorter than those in the rows before: a number without its last digits is wrong.
    """
    start = data.rfind(b"\n") + 1
    tail = data[start:].decode("utf-8", "replace")
    if not tail.strip():
        return data, 0
    cells = split(tail, dialect.delimiter)
    cut = broken or len(cells) < len(dialect.names)
    if not cut and len(cells) == len(dialect.names) and dialect.numeric[-1]:
        near = data.find(b"\n", start - _NEIGHBOURHOOD, start) + 1 if start > _NEIGHBOURHOOD else 0
        before = data[near:start].decode("utf-8", "replace").split("\n")
        lasts = [split(line, dialect.delimiter)[-1] for line in before[-_NEIGHBOURS:] if line.strip()]
        cut = len(cells[-1]) < min(map(len, lasts), default=0)
        cut = cut or not (is_number(cells[-1], dialect.decimal) or cells[-1].lower() in MISSING)
    return (data[:start], data.count(b"\n", 0, start) + 1) if cut else (data, 0)


def _without_bad_lines(data: bytes, dialect: Dialect) -> tuple[bytes, int]:
    """Lines as the parser needs them, and how many it cannot read: too long, or with a quote left open."""
    if dialect.delimiter == BLANKS:
        data = data.replace(b"\t", b" ")
        while b"  " in data:
            data = data.replace(b"  ", b" ")
        data = data.replace(b"\n ", b"\n").replace(b" \n", b"\n").strip(b" ")
    if b'"' not in data and not _has_long_line(data):
        return data, 0
    sign = re.escape(dialect.delimiter.encode())
    cell = rb'(?: *"(?:[^"]|"")*" *|[^"' + sign + rb"]*)"
    whole = re.compile(cell + rb"(?:" + sign + cell + rb")*").fullmatch
    lines = data.split(b"\n")
    good = [line for line in lines if len(line) < _LONGEST_LINE and (b'"' not in line or whole(line))]
    return b"\n".join(good), len(lines) - len(good)


def _has_long_line(data: bytes) -> bool:
    start = 0
    while len(data) - start > _LONGEST_LINE:
        end = data.rfind(b"\n", start, start + _LONGEST_LINE)
        if end < 0:
            return True
        start = end + 1
    return False


def _parsed(path: Path, data: bytes, dialect: Dialect) -> tuple[dict[str, Column], list[str], int]:
    """Columns of numbers, names of those of text, and the number of rows of another length."""
    import pyarrow as pa

    try:
        try:
            table, wrong = _table(data, dialect, dialect.numeric)
        except pa.ArrowInvalid:  # text somewhere in a column of numbers
            table, wrong = _table(data, dialect, (False,) * len(dialect.names))
        columns = {name: _numbers(table[name], dialect.decimal) for name in dialect.names}
    except (pa.ArrowException, MemoryError) as error:
        raise InputError(f"path: cannot read {path}: {error}") from error
    numbers = {name: column for name, column in columns.items() if column is not None}
    # A delimiter at the end of each line makes an empty column.
    last = dialect.names[-1]
    unnamed = last == str(len(dialect.names) - 1) and last in numbers
    if unnamed and len(numbers) > 1 and np.isnan(numbers[last]).all():
        del numbers[last]
    return numbers, [name for name in dialect.names if columns[name] is None], wrong


def _table(data: bytes, dialect: Dialect, numeric: tuple[bool, ...]) -> tuple[pa.Table, int]:
    import pyarrow as pa
    from pyarrow import csv

    wrong = []

    def skip(row: Any) -> str:
        wrong.append(row.number)
        return "skip"

    table = csv.read_csv(
        pa.BufferReader(data),
        csv.ReadOptions(column_names=list(dialect.names), block_size=_LONGEST_LINE),
        csv.ParseOptions(delimiter=dialect.delimiter, invalid_row_handler=skip),
        csv.ConvertOptions(
            column_types={
                name: pa.float64() if number else pa.string()
                for name, number in zip(dialect.names, numeric, strict=True)
            },
            null_values=[form for word in MISSING for form in {word, word.upper(), "NaN", "None"}],
            decimal_point=dialect.decimal,
        ),
    )
    return table, len(wrong)


def _numbers(column: pa.ChunkedArray, decimal: str) -> Column | None:
    """A column as numbers; None if most of its cells are text."""
    import pyarrow as pa
    import pyarrow.compute as pc

    if pa.types.is_string(column.type):
        cells = pc.utf8_trim_whitespace(column)
        if decimal != ".":
            cells = pc.replace_substring(pc.replace_substring(cells, ".", "x"), decimal, ".")
        small = pc.utf8_lower(cells)
        for word, value in BOOLEAN.items():
            cells = pc.if_else(pc.equal(small, word), str(value), cells)
        given = pc.invert(pc.is_in(small, value_set=pa.array([*MISSING, None])))
        number = pc.match_substring_regex(cells, NUMBER)
        cells = pc.if_else(number, pc.utf8_ltrim(cells, "+"), pa.scalar(None, pa.string()))
        if 2 * (len(cells) - cells.null_count) < (pc.sum(given).as_py() or 0):
            return None
        column = cells.cast(pa.float64())
    return np.ascontiguousarray(column.to_numpy(), dtype=np.float64)

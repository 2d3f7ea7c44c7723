"""Parquet files, and those whose columns are structures or lists."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..._extras import require
from ...errors import InputError
from ..recording import Column, Recording, Table
from .arrays import MOST_COLUMNS, NoColumnsError
from .dialect import unique
from .unpack import MOST_BYTES

if TYPE_CHECKING:
    import pyarrow as pa

_NUMBER = 8  # bytes of one
_MAGIC = b"PAR1"
_PER_SECOND = {"s": 1.0, "ms": 1e3, "us": 1e6, "ns": 1e9}
# What the description of a file may need at most [B]: it is unpacked before anything is known of it.
_MOST_DESCRIPTION = 64 << 20


def read(path: Path) -> Recording:
    """Reads a Parquet file; of times and durations, the seconds.

    Raises:
        InputError: the file cannot be read, is cut or too large, or has no column of numbers.
        MissingExtraError: pyarrow is not installed.
    """
    require("log", "pyarrow")
    import pyarrow as pa

    try:
        with path.open("rb") as file:
            start = file.read(len(_MAGIC))
            file.seek(-min(len(_MAGIC), file.seek(0, 2)), 2)
            end = file.read()
        if start == _MAGIC != end:
            raise InputError(f"path: {path} is cut: what it holds is described at its end, which is missing")
        columns, left_out = _columns(path)
    except (pa.ArrowException, OSError, ValueError, MemoryError) as error:
        raise InputError(f"path: cannot read {path}: {error}") from error
    if not columns:
        raise InputError(f"path: {path} has no column of numbers")
    return Recording((Table(path.stem, "", columns),), tuple(left_out))


def _columns(path: Path) -> tuple[dict[str, Column], list[str]]:
    from pyarrow import parquet

    with parquet.ParquetFile(
        path,
        thrift_string_size_limit=_MOST_DESCRIPTION,
        thrift_container_size_limit=_MOST_DESCRIPTION // _NUMBER,
        page_checksum_verification=True,
    ) as file:
        about = file.metadata
        groups = [about.row_group(k) for k in range(about.num_row_groups)]
        chunks = [group.column(k) for group in groups for k in range(group.num_columns)]
        # Of columns that repeat one number the file has next to nothing, but memory is needed for each row.
        need = max(
            _NUMBER * sum(chunk.num_values for chunk in chunks),
            sum(chunk.total_uncompressed_size for chunk in chunks),
            _NUMBER * about.num_rows,
        )
        if need > MOST_BYTES:
            raise InputError(f"path: {path} needs more than {MOST_BYTES >> 20} MiB of memory; split it")
        table = file.read()
    columns: dict[str, Column] = {}
    left_out = []
    for name, chunked in zip(unique(table.column_names), table.columns, strict=True):
        try:
            columns.update(_flattened(name, chunked.combine_chunks()))
        except NoColumnsError as error:
            left_out.append(f"{name}: {error}")
    return columns, left_out


def _flattened(name: str, array: pa.Array | pa.ChunkedArray) -> Iterator[tuple[str, Column]]:
    """The columns of an array: fields of structures as `name.field`, elements of lists as `name[0]`."""
    import pyarrow as pa
    import pyarrow.compute as pc

    if isinstance(array, pa.ChunkedArray):  # of no chunk, or of those that do not fit into one
        array = pa.concat_arrays(array.chunks) if array.num_chunks else pa.array([], array.type)
    kind = array.type
    if pa.types.is_dictionary(kind):
        yield from _flattened(name, array.dictionary_decode())
    elif pa.types.is_struct(kind):
        for field, child in zip(kind, array.flatten(), strict=True):
            yield from _flattened(f"{name}.{field.name}", child)
    elif pa.types.is_list(kind) or pa.types.is_large_list(kind) or pa.types.is_fixed_size_list(kind):
        lengths = pc.unique(pc.list_value_length(array).drop_null()).to_pylist()
        if len(lengths) != 1:
            raise NoColumnsError("lists of several lengths" if lengths else "no lists")
        if lengths[0] > MOST_COLUMNS:
            raise NoColumnsError(f"more than {MOST_COLUMNS} columns")
        given, elements = array.is_valid().to_numpy(zero_copy_only=False), array.flatten()
        first = np.where(given, (np.cumsum(given) - 1) * lengths[0], 0)
        for k in range(lengths[0]):
            yield from _flattened(f"{name}[{k}]", elements.take(pa.array(first + k, mask=~given)))
    else:
        yield name, _numbers(array)


def _numbers(array: pa.Array) -> Column:
    import pyarrow as pa

    kind, factor = array.type, 1.0
    if pa.types.is_timestamp(kind) or pa.types.is_duration(kind) or pa.types.is_time(kind):
        factor = 1.0 / _PER_SECOND[kind.unit]
        array = array.cast(pa.int32() if pa.types.is_time32(kind) else pa.int64())
    elif pa.types.is_date(kind):
        array = array.cast(pa.timestamp("s")).cast(pa.int64())
    elif pa.types.is_boolean(kind):
        array = array.cast(pa.uint8())
    elif not (
        pa.types.is_integer(kind)
        or pa.types.is_floating(kind)
        or pa.types.is_decimal(kind)
        or pa.types.is_null(kind)
    ):
        raise NoColumnsError(f"a column of type {kind}")
    numbers = array.cast(pa.float64(), safe=False).to_numpy(zero_copy_only=False)
    return np.ascontiguousarray(numbers * factor, dtype=np.float64)

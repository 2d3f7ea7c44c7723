"""Parquet files, and those whose columns are structures or lists."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..._extras import require
from ...errors import InputError
from ..recording import Column, Recording, Table
from .arrays import MOST_COLUMNS
from .dialect import unique
from .unpack import MOST_BYTES

if TYPE_CHECKING:
    import pyarrow as pa

_NUMBER = 8  # bytes of one
_BATCH = 1 << 16  # rows read at a time: lists may be long, of which memory is known only when they are read
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
            raise InputError("it is cut: what it holds is described at its end, which is missing")
        columns, left_out = _columns(path)
    except (pa.ArrowException, OSError, ValueError, MemoryError) as error:
        raise InputError(f"path: cannot read {path}: {error}") from error
    if not columns:
        raise InputError(f"path: {path} has no column of numbers")
    return Recording((Table(path.stem, "", columns),), tuple(left_out))


def _columns(path: Path) -> tuple[dict[str, Column], list[str]]:
    import pyarrow as pa
    from pyarrow import parquet

    with parquet.ParquetFile(
        path,
        thrift_string_size_limit=_MOST_DESCRIPTION,
        thrift_container_size_limit=_MOST_DESCRIPTION // _NUMBER,
        page_checksum_verification=True,
    ) as file:
        about = file.metadata
        # Of columns that repeat one number the file has next to nothing, but memory is needed for each row.
        # What it says of single columns is not asked: if that is broken, the library ends the program.
        need = _NUMBER * about.num_rows * about.num_columns
        batches: list[pa.RecordBatch] = []
        held = 0
        source = file.iter_batches(_BATCH)
        while max(need, held) <= MOST_BYTES and (batch := next(source, None)) is not None:
            batches.append(batch)
            held += batch.nbytes
        if max(need, held) > MOST_BYTES:
            raise InputError(f"it needs more than {MOST_BYTES >> 20} MiB of memory; split it")
        table = pa.Table.from_batches(batches, file.schema_arrow)
    columns: dict[str, Column] = {}
    left_out: list[str] = []
    for name, chunked in zip(unique(table.column_names), table.columns, strict=True):
        columns.update(_flattened(name, chunked.combine_chunks(), left_out))
    return columns, left_out


def _flattened(
    name: str, array: pa.Array | pa.ChunkedArray, left_out: list[str]
) -> Iterator[tuple[str, Column]]:
    """The columns of an array: fields of structures as `name.field`, elements of lists as `name[0]`."""
    import pyarrow as pa
    import pyarrow.compute as pc

    if isinstance(array, pa.ChunkedArray):  # of no chunk, or of those that do not fit into one
        array = pa.concat_arrays(array.chunks) if array.num_chunks else pa.array([], array.type)
    kind = array.type
    if pa.types.is_dictionary(kind):
        yield from _flattened(name, array.dictionary_decode(), left_out)
    elif pa.types.is_struct(kind):
        for field, child in zip(kind, array.flatten(), strict=True):
            yield from _flattened(f"{name}.{field.name}", child, left_out)
    elif pa.types.is_list(kind) or pa.types.is_large_list(kind) or pa.types.is_fixed_size_list(kind):
        lengths = pc.unique(pc.list_value_length(array).drop_null()).to_pylist()
        if len(lengths) != 1 or lengths[0] > MOST_COLUMNS:
            left_out.append(
                f"{name}: lists of {'several lengths' if len(lengths) > 1 else f'length {lengths}'}"
            )
            return
        given, elements = array.is_valid().to_numpy(zero_copy_only=False), array.flatten()
        first = np.where(given, (np.cumsum(given) - 1) * lengths[0], 0)
        for k in range(lengths[0]):
            yield from _flattened(f"{name}[{k}]", elements.take(pa.array(first + k, mask=~given)), left_out)
    elif (numbers := _numbers(array)) is not None:
        yield name, numbers
    else:
        left_out.append(f"{name}: a column of type {kind}")


def _numbers(array: pa.Array) -> Column | None:
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
        return None
    numbers = array.cast(pa.float64(), safe=False).to_numpy(zero_copy_only=False)
    return np.ascontiguousarray(numbers * factor, dtype=np.float64)

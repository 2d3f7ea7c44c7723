"""Arrays of any shape as named columns, and columns as tables."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..recording import Column, Table
from .dialect import unique

# Most columns that one array gives: no robot has as many signals, but pictures have as many pixels.
MOST_COLUMNS = 10_000
_SECONDS = {
    "W": 604_800.0,
    "D": 86_400.0,
    "h": 3600.0,
    "m": 60.0,
    "s": 1.0,
    "ms": 1e-3,
    "us": 1e-6,
    "ns": 1e-9,
}


def flattened(name: str, array: NDArray[Any], left_out: list[str]) -> Iterator[tuple[str, Column]]:
    """The columns of an array whose first axis counts rows, with their names; `left_out` gets what is none.

    Fields are named `name.field`, elements of further axes `name[0]`, `name[1][2]`. Of times, the seconds.
    """
    kind = array.dtype.kind
    if array.ndim == 0:
        left_out.append(f"{name}: a single value")
    elif array.dtype.names is not None:
        for field in array.dtype.names:
            yield from flattened(f"{name}.{field}" if name else field, array[field], left_out)
    elif np.prod(array.shape[1:], dtype=float) > MOST_COLUMNS:
        left_out.append(f"{name}: of shape {array.shape}, more than {MOST_COLUMNS} columns")
    elif kind == "c":
        yield from flattened(f"{name}.real", array.real, left_out)
        yield from flattened(f"{name}.imag", array.imag, left_out)
    elif kind not in "biufmM" or (kind in "mM" and np.datetime_data(array.dtype)[0] not in _SECONDS):
        left_out.append(f"{name}: of type {array.dtype}")
    else:
        for index in np.ndindex(array.shape[1:]):
            column = array[(slice(None), *index)]
            yield "".join([name, *(f"[{k}]" for k in index)]), _numbers(column)


def _numbers(column: NDArray[Any]) -> Column:
    if column.dtype.kind in "mM":
        unit, count = np.datetime_data(column.dtype)
        column = np.where(np.isnat(column), np.nan, column.astype(np.int64) * (_SECONDS[unit] * count))
    with np.errstate(all="ignore"):  # signalling NaN, or a long double that is too large
        return np.ascontiguousarray(column, dtype=np.float64)


def tables(stem: str, columns: Mapping[str, Column]) -> tuple[Table, ...]:
    """One table for each number of rows, the one with most numbers first.

    A single one has the file's name; of several, each has the name of the group that all its columns are in.
    """
    groups: dict[int, dict[str, Column]] = {}
    for name, column in columns.items():
        groups.setdefault(len(column), {})[name] = column
    largest = sorted(groups.values(), key=lambda group: -sum(map(len, group.values())))
    names = [stem] if len(largest) == 1 else unique(_group_name(group) or stem for group in largest)
    return tuple(Table(name, "", group) for name, group in zip(names, largest, strict=True))


def _group_name(names: Iterable[str]) -> str:
    """The dotted beginning that all names have in common."""
    common: list[str] = []
    for parts in zip(*(name.split(".")[:-1] for name in names), strict=False):
        if len(set(parts)) > 1:
            break
        common.append(parts[0])
    return ".".join(common)

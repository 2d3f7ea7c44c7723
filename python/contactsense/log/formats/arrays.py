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
_SECONDS = np.timedelta64(1, "s")


class NoColumnsError(Exception):
    """An array gives no columns of numbers; the message says why."""


def flattened(name: str, array: NDArray[Any]) -> Iterator[tuple[str, Column]]:
    """The columns of an array whose first axis counts rows, with their names.

    Fields are named `name.field`, elements of further axes `name[0]`, `name[1][2]`.

    Raises:
        NoColumnsError: it has no rows, more than `MOST_COLUMNS`, or no numbers.
    """
    if array.ndim == 0:
        raise NoColumnsError("a single value")
    if array.dtype.names is not None:
        for field in array.dtype.names:
            yield from flattened(f"{name}.{field}" if name else field, array[field])
        return
    if np.prod(array.shape[1:], dtype=float) > MOST_COLUMNS:
        raise NoColumnsError(f"of shape {array.shape}: more than {MOST_COLUMNS} columns")
    if array.dtype.kind == "c":
        yield from flattened(f"{name}.real", array.real)
        yield from flattened(f"{name}.imag", array.imag)
        return
    if array.dtype.kind not in "biufmM":
        raise NoColumnsError(f"of type {array.dtype}")
    for index in np.ndindex(array.shape[1:]):
        column = array[(slice(None), *index)]
        yield "".join([name, *(f"[{k}]" for k in index)]), _numbers(column)


def _numbers(column: NDArray[Any]) -> Column:
    if column.dtype.kind in "mM":
        missing = np.isnat(column)
        if column.dtype.kind == "M":
            column = column - np.datetime64(0, np.datetime_data(column.dtype)[0])
        column = np.where(missing, np.nan, column / _SECONDS)
    with np.errstate(all="ignore"):  # what is not a number in the file is none here, and no warning
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

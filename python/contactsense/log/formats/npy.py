"""One array of NumPy's file format, checked before memory is taken for it."""

from __future__ import annotations

import io
import math
from typing import Any

import numpy as np
from numpy.lib import format as npy
from numpy.typing import NDArray

# Longest header [B]: 1,000 fields with their names need half of it; Python evaluates it as a literal.
_LONGEST_HEADER = 100_000


class BadArrayError(Exception):
    """The bytes are no array that can be read; the message says why."""


def array_of(data: bytes) -> tuple[NDArray[Any], str]:
    """The array, and what is missing of it (empty if nothing is): all whole rows are given.

    Raises:
        BadArrayError: it has objects of Python, its header is broken, or asks for more than there is and
            there is no whole row.
    """
    shape, by_columns, dtype, start = _header(data)
    if dtype.hasobject:
        raise BadArrayError("it holds objects of Python, which can run programs; save numbers")
    if dtype.itemsize == 0 or any(not isinstance(length, int) or length < 0 for length in shape):
        raise BadArrayError(f"its header is broken: {dtype} of shape {shape}")
    count, held = math.prod(shape), (len(data) - start) // dtype.itemsize
    damage = ""
    if held < count:
        rows = held // max(math.prod(shape[1:]), 1)
        if not shape or rows == 0 or (by_columns and len(shape) > 1):
            raise BadArrayError(f"it is cut: {held} of {count} numbers are there, and no whole row")
        damage = f"the array is cut: {rows} of {shape[0]} rows were read"
        shape = (rows, *shape[1:])
        count = math.prod(shape)
    try:
        flat = np.frombuffer(data, dtype, count, start) if count else np.empty(0, dtype)
        return flat.reshape(shape, order="F" if by_columns else "C"), damage
    except (ValueError, TypeError, OverflowError) as error:  # such as more than 64 dimensions
        raise BadArrayError(f"its header is broken: {error}") from error


def _header(data: bytes) -> tuple[tuple[int, ...], bool, np.dtype[Any], int]:
    stream = io.BytesIO(data[: _LONGEST_HEADER + 100])  # with the fixed beginning
    try:
        version = npy.read_magic(stream)
        if version == (1, 0):
            header = npy.read_array_header_1_0(stream, max_header_size=_LONGEST_HEADER)
        else:  # version 3 differs from 2 in the encoding of names that are not ASCII
            header = npy.read_array_header_2_0(stream, max_header_size=_LONGEST_HEADER)
    except (
        Exception
    ) as error:  # a header evaluates to anything: NumPy raises errors of many types, and warnings
        raise BadArrayError(f"its header is broken: {error}") from error
    return *header, stream.tell()

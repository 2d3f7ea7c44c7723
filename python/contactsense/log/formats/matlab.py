"""Files of MATLAB, version 7.3: HDF5 with MATLAB's conventions."""

from __future__ import annotations

import io
import json
import struct
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..._extras import require
from ...errors import InputError
from ..recording import Column, Recording
from .arrays import flattened, tables
from .unpack import MOST_BYTES

# What stands at the beginning of files of version 5 to 7, and where HDF5 begins in those of 7.3 [B].
_OLD, _BEGINNINGS = b"MATLAB 5.0 MAT-file", (0, 512)
_HDF5 = b"\x89HDF\r\n\x1a\n"
# Bytes of the block that begins so, and where in it the length of the file is, by the block's version [B].
_SUPERBLOCK, _LENGTH_AT = 52, {0: 40, 1: 44, 2: 28, 3: 28}
# Starts the program that reads with the modules that this process would find, and no others.
_START = (
    "import runpy, sys; "
    "sys.path[:] = sys.argv[1].split('\\n'); runpy.run_path(sys.argv[2], run_name='__main__')"
)
_PROGRAM = Path(__file__).with_name("hdf5_arrays.py")
# It has this time [s]: the largest files take minutes, and broken ones can send HDF5 round in circles.
_PATIENCE = 600


def read(path: Path) -> Recording:
    """Reads a `.mat` file of version 7.3, or a plain HDF5 file with MATLAB's order of axes.

    Structures are named with dots. The rows of a matrix are the axis that is as long as a vector of the file,
    or its first in MATLAB; a matrix `q` gives `q[0]`, `q[1]`, ...

    Raises:
        InputError: the file cannot be read, is of an older version, is broken or cut, refers to other
            files, or has no numbers.
        MissingExtraError: h5py is not installed.
    """
    require("log", "h5py")
    try:
        _check_beginning(path)
        arrays, left_out = _arrays(path)
    except (OSError, ValueError, MemoryError) as error:
        raise InputError(f"path: cannot read {path}: {error}") from error
    columns = _columns(arrays, left_out)
    if not columns:
        raise InputError(f"path: {path} has no column of numbers")
    return Recording(tables(path.stem, columns), tuple(left_out))


def _check_beginning(path: Path) -> None:
    with path.open("rb") as file:
        start = file.read(_BEGINNINGS[-1] + _SUPERBLOCK)
    if start.startswith(_OLD):
        raise InputError("it is of an older version of MATLAB's format; save it with -v7.3")
    begin = next((begin for begin in _BEGINNINGS if start[begin:].startswith(_HDF5)), None)
    if begin is None:
        raise InputError("it is no file of MATLAB 7.3")
    block = start[begin:].ljust(_SUPERBLOCK, b"\0")
    (length,) = struct.unpack_from("<Q", block, _LENGTH_AT.get(block[len(_HDF5)], _LENGTH_AT[0]))
    if path.stat().st_size < length:
        raise InputError(f"it is cut: {path.stat().st_size} of {length} bytes are there; HDF5 needs all")


def _arrays(path: Path) -> tuple[dict[str, NDArray[Any]], list[str]]:
    """All arrays of a file, their axes in MATLAB's order, and what it has besides."""
    command = [sys.executable, "-I", "-c", _START, "\n".join(sys.path), str(_PROGRAM)]
    command += [str(path.absolute()), str(MOST_BYTES)]
    try:
        done = subprocess.run(command, capture_output=True, timeout=_PATIENCE, check=False)
    except subprocess.TimeoutExpired:
        raise InputError(f"it is broken: HDF5 came to no end in {_PATIENCE} s") from None
    if done.returncode:
        last = done.stderr.decode(errors="replace").strip().rpartition("\n")[2]
        raise InputError(f"it is broken: HDF5 ended with {done.returncode} {last}".rstrip())
    arrays: dict[str, NDArray[Any]] = {}
    left_out = []
    stream = io.BytesIO(done.stdout)
    while line := stream.readline():
        ((key, value),) = json.loads(line).items()
        if key == "error":
            raise InputError(value)
        if key == "array":
            arrays[value] = np.lib.format.read_array(stream, allow_pickle=False).T
        else:
            left_out.append(value)
    return arrays, left_out


def _columns(arrays: dict[str, NDArray[Any]], left_out: list[str]) -> dict[str, Column]:
    """Columns of all arrays, each along the axis that counts rows."""
    lengths = {array.size for array in arrays.values() if 1 < array.size == max(array.shape)}
    columns: dict[str, Column] = {}
    for name, array in arrays.items():
        if array.size == 1:
            left_out.append(f"{name}: a single value")
            continue
        if array.size == max(array.shape):
            array = array.reshape(-1)
        elif array.shape[0] not in lengths:
            # Signals in rows, or pages: time runs along another axis.
            axes = [axis for axis, length in enumerate(array.shape) if length in lengths]
            array = np.moveaxis(array, axes[-1], 0) if axes else array
        columns.update(flattened(name, array, left_out))
    return columns

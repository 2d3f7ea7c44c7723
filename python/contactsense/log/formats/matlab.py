"""Files of MATLAB, version 7.3: HDF5 with MATLAB's conventions."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..._extras import require
from ...errors import InputError
from ..recording import Column, Recording
from .arrays import flattened, tables
from .unpack import MOST_BYTES

if TYPE_CHECKING:
    import h5py

# What stands at the beginning of files of version 5 to 7, and where HDF5 begins in those of 7.3 [B].
_OLD, _BEGINNINGS = b"MATLAB 5.0 MAT-file", (0, 512)
_HDF5 = b"\x89HDF\r\n\x1a\n"
# Deflate makes no more than this many bytes of one; an array that claims more is not in the file.
_MOST_UNPACKED = 1100
# Groups inside groups: structures of MATLAB are seldom more than four deep.
_DEEPEST = 32
# Filters that HDF5 itself has: deflate, shuffle, a checksum. For others it would load programs.
_FILTERS = {1, 2, 3}
# Where MATLAB keeps what others refer to: cells, objects.
_HIDDEN = ("#refs#", "#subsystem#")


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
    import h5py

    left_out: list[str] = []
    try:
        _check_beginning(path)
        with h5py.File(path, "r") as file:
            arrays = dict(_Walk(path.stat().st_size, left_out).arrays(file, "", _DEEPEST))
        columns = _columns(arrays, left_out)
    # All that h5py raises of a broken file, and what is found wrong here.
    except (OSError, ValueError, KeyError, RuntimeError, TypeError, OverflowError, MemoryError) as error:
        raise InputError(f"path: cannot read {path}: {error}") from error
    if not columns:
        raise InputError(f"path: {path} has no column of numbers")
    return Recording(tables(path.stem, columns), tuple(left_out))


def _check_beginning(path: Path) -> None:
    with path.open("rb") as file:
        start = file.read(_BEGINNINGS[-1] + len(_HDF5))
    if start.startswith(_OLD):
        raise InputError("it is of an older version of MATLAB's format; save it with -v7.3")
    if not any(start[begin:].startswith(_HDF5) for begin in _BEGINNINGS):
        raise InputError("it is no file of MATLAB 7.3")


class _Walk:
    """Goes through a file's groups; takes arrays of numbers that are in the file itself."""

    def __init__(self, size: int, left_out: list[str]) -> None:
        self._size, self._left_out = size, left_out
        self._memory = MOST_BYTES
        self._seen: set[int] = set()

    def arrays(self, group: h5py.Group, prefix: str, depth: int) -> Iterator[tuple[str, NDArray[Any]]]:
        """All arrays in a group and those inside, their axes in MATLAB's order."""
        import h5py

        address = h5py.h5o.get_info(group.id).addr
        if depth == 0 or address in self._seen:
            raise InputError(f"{prefix}: groups are in a circle, or more than {_DEEPEST} deep")
        self._seen.add(address)
        for key in group:
            name = prefix + key
            if key in _HIDDEN:
                continue
            link = group.get(key, getlink=True)
            if isinstance(link, h5py.ExternalLink):
                raise InputError(f"{name}: refers to another file, which is not opened")
            if not isinstance(link, h5py.HardLink):
                self._left_out.append(f"{name}: refers to another place")
                continue
            node = group[key]
            if isinstance(node, h5py.Group):
                yield from self.arrays(node, f"{name}.", depth - 1)
            elif isinstance(node, h5py.Dataset):
                if why := self._why_not(node, name):
                    self._left_out.append(f"{name}: {why}")
                else:
                    yield name, node[()].T

    def _why_not(self, data: h5py.Dataset, name: str) -> str:
        """Why a dataset is no array of numbers; empty if it is one, of a size that can be in the file."""
        if data.external or data.is_virtual:
            raise InputError(f"{name}: its numbers are in another file, which is not opened")
        if data.shape is None or data.size == 0 or "MATLAB_empty" in data.attrs:
            return "empty"
        kind = data.attrs.get("MATLAB_class", b"")
        if kind in (b"char", b"cell", b"string"):
            return f"of MATLAB's class {kind.decode()}"
        if data.dtype.hasobject or data.dtype.kind not in "biufcV":
            return f"of type {data.dtype}"
        settings = data.id.get_create_plist()
        filters = {settings.get_filter(k)[0] for k in range(settings.get_nfilters())}
        if filters - _FILTERS:
            return f"packed by filters with the numbers {sorted(filters - _FILTERS)}"
        stored = data.id.get_storage_size() * (_MOST_UNPACKED if filters else 1)
        needed = data.size * data.dtype.itemsize
        if needed > min(stored, self._size * _MOST_UNPACKED):
            return f"its {needed} bytes are not in the file"
        self._memory -= needed
        if self._memory < 0:
            raise InputError(f"{name}: the file needs more than {MOST_BYTES >> 20} MiB of memory; split it")
        return ""


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

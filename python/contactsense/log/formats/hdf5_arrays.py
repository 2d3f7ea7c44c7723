"""Takes the arrays out of an HDF5 file: a program of its own, as HDF5 ends the process on some broken files.

Writes to the standard output a line of JSON for each array and each thing left out, and the arrays. It needs
nothing of this package, which takes longer to load than most files.
"""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Iterator
from typing import Any, BinaryIO

import h5py
from numpy.lib import format as npy
from numpy.typing import NDArray

# Deflate makes no more than this many bytes of one; an array that claims more is not in the file.
_MOST_UNPACKED = 1100
# Groups inside groups: structures of MATLAB are seldom more than four deep.
_DEEPEST = 32
# Filters that HDF5 itself has: deflate, shuffle, a checksum. For others it would load programs.
_FILTERS = {1, 2, 3}
# Where MATLAB keeps what others refer to: cells, objects.
_HIDDEN = ("#refs#", "#subsystem#")


def write_arrays(path: str, most: int, to: BinaryIO) -> None:
    """Writes all arrays of a file that together need no more than `most` [B], or what is wrong with it."""

    def tell(key: str, value: str) -> None:
        to.write(json.dumps({key: value}).encode() + b"\n")

    try:
        walk = _Walk(os.stat(path).st_size, most)
        with h5py.File(path, "r") as file:
            for name, array in walk.arrays(file, "", _DEEPEST):
                tell("array", name)
                # Not `write_array`, which writes past the buffer of a file, and so before the line above.
                npy.write_array_header_1_0(to, npy.header_data_from_array_1_0(array))
                to.write(array.tobytes())
        for line in walk.left_out:
            tell("left_out", line)
    # All that h5py raises of a broken file, and what is found wrong here.
    except (OSError, ValueError, LookupError, RuntimeError, TypeError, ArithmeticError, MemoryError) as error:
        tell("error", str(error) or type(error).__name__)
    to.flush()


class _Walk:
    """Goes through a file's groups; takes arrays of numbers that are in the file itself."""

    def __init__(self, size: int, most: int) -> None:
        self.left_out: list[str] = []
        self._size, self._most, self._memory = size, most, most
        self._seen: set[int] = set()

    def arrays(self, group: h5py.Group, prefix: str, depth: int) -> Iterator[tuple[str, NDArray[Any]]]:
        """All arrays in a group and those inside, their axes in HDF5's order."""
        address = h5py.h5o.get_info(group.id).addr
        if depth == 0 or address in self._seen:
            raise ValueError(f"{prefix}: groups are in a circle, or more than {_DEEPEST} deep")
        self._seen.add(address)
        for key in group:
            name = prefix + key
            if key in _HIDDEN:
                continue
            link = group.get(key, getlink=True)
            if isinstance(link, h5py.ExternalLink):
                raise ValueError(f"{name}: refers to another file, which is not opened")
            if not isinstance(link, h5py.HardLink):
                self.left_out.append(f"{name}: refers to another place")
                continue
            node = group[key]
            if isinstance(node, h5py.Group):
                yield from self.arrays(node, f"{name}.", depth - 1)
            elif isinstance(node, h5py.Dataset):
                if why := self._why_not(node, name):
                    self.left_out.append(f"{name}: {why}")
                else:
                    yield name, node[()]

    def _why_not(self, data: h5py.Dataset, name: str) -> str:
        """Why a dataset is no array of numbers; empty if it is one, of a size that can be in the file."""
        if data.external or data.is_virtual:
            raise ValueError(f"{name}: its numbers are in another file, which is not opened")
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
            raise ValueError(f"{name}: the file needs more than {self._most >> 20} MiB of memory; split it")
        return ""


if __name__ == "__main__":
    write_arrays(sys.argv[-2], int(sys.argv[-1]), sys.stdout.buffer)

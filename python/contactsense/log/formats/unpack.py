"""The bytes of a file, unpacked where it is compressed, within a bound on memory."""

from __future__ import annotations

import bz2
import lzma
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any, BinaryIO

from ..._extras import require
from ...errors import InputError

# Most bytes a reader holds of one file [B]: a day of 30 signals at 100 Hz as text is 3 GB, and a computer
# that works with logs has this memory. A small file that unpacks to more is made to fill the memory.
MOST_BYTES = 4 << 30
# Read and unpacked at a time [B]: the bound is exceeded by no more than this.
_PIECE = 1 << 20
# The same where nothing is unpacked: most files are one piece, which need not be joined.
_PLAIN_PIECE = 256 << 20

_GZIP, _BZIP2, _XZ, _ZSTD = b"\x1f\x8b", b"BZh", b"\xfd7zXZ\x00", b"\x28\xb5\x2f\xfd"


def contents(path: Path) -> tuple[bytes, str]:
    """All bytes, and what is broken of the compression (empty if nothing is): what unpacks before is given.

    Raises:
        InputError: the file cannot be read, or is larger than `MOST_BYTES`.
    """
    try:
        with path.open("rb") as file:
            start = file.read(len(_XZ))
            file.seek(0)
            return _gathered(_pieces(file, start))
    except (OSError, ValueError) as error:  # no file; a name that cannot be one; too large
        raise InputError(f"path: cannot read {path}: {error}") from error


def _gathered(pieces: Iterator[bytes]) -> tuple[bytes, str]:
    gathered: list[bytes] = []
    size, damage = 0, ""
    try:
        for piece in pieces:
            gathered.append(piece)
            size += len(piece)
            if size > MOST_BYTES:
                raise InputError(f"it has more than {MOST_BYTES >> 20} MiB; split it")
    except (EOFError, zlib.error, lzma.LZMAError, _BrokenError) as error:
        damage = f"the compressed file is broken or cut ({error}): {size} bytes could be unpacked"
    except MemoryError as error:
        raise InputError("it does not fit into memory") from error
    return b"".join(gathered), damage


class _BrokenError(Exception):
    """The compressed data are broken."""


def _pieces(file: BinaryIO, start: bytes) -> Iterator[bytes]:
    if start.startswith(_ZSTD):
        return _zstd(file)
    if start.startswith(_GZIP):
        return _members(file, lambda: zlib.decompressobj(wbits=31))  # 31: with gzip's header and checksum
    if start.startswith(_BZIP2):
        return _members(file, bz2.BZ2Decompressor)
    if start.startswith(_XZ):
        return _members(file, lzma.LZMADecompressor)
    return iter(lambda: file.read(_PLAIN_PIECE), b"")


def _members(file: BinaryIO, new: Any) -> Iterator[bytes]:
    """Unpacks members one after another, as files of `cat a.gz b.gz` have them."""
    unpacker, packed = new(), file.read(_PIECE)
    while packed or not unpacker.eof:
        try:
            piece = unpacker.decompress(packed, _PIECE)
        except (OSError, ValueError) as error:  # as bz2 raises
            raise _BrokenError(str(error)) from error
        if piece:
            yield piece
        if unpacker.eof:
            packed = unpacker.unused_data or file.read(_PIECE)
            if not packed.strip(b"\0"):  # zeros fill up the last block on tapes
                return
            unpacker = new()
            continue
        packed = getattr(unpacker, "unconsumed_tail", b"")  # zlib gives back what others keep
        if not packed and (not piece or getattr(unpacker, "needs_input", True)):
            packed = file.read(_PIECE)
            if not packed and not piece:
                raise EOFError("it ends early")


def _zstd(file: BinaryIO) -> Iterator[bytes]:
    require("log", "pyarrow")
    import pyarrow as pa

    try:
        with pa.CompressedInputStream(pa.PythonFile(file, mode="r"), "zstd") as stream:
            while piece := stream.read(_PIECE):
                yield piece
    except (pa.ArrowException, OSError) as error:
        raise _BrokenError(str(error)) from error

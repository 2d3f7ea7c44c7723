"""Files mapped into memory, and decompression that a hostile size cannot blow up."""

from __future__ import annotations

import mmap
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, BinaryIO

from ...errors import InputError

ZSTD_MAGIC = b"\x28\xb5\x2f\xfd"
ZSTD_ENDINGS = (".zstd", ".zst")
MAX_UNPACKED_FILE = 2**34  # bytes of a whole file after decompression: 16 GiB, hours of any robot
MAX_ZSTD_WINDOW = 2**27  # bytes of history a frame may ask for: what `zstd` itself grants
COPY_BYTES = 2**20  # unpacked at once


class UnpackError(Exception):
    """Compressed bytes are broken, or more than is allowed."""


def is_zstd(data: bytes) -> bool:
    """Whether a message is compressed; none that is not begins like this."""
    return data[:4] == ZSTD_MAGIC


def unpack_zstd(data: bytes, limit: int) -> bytes:
    """One frame, of at most `limit` bytes unpacked."""
    import zstandard

    try:
        if zstandard.frame_content_size(data) > limit:
            raise UnpackError("unpacked it is too large")
        return zstandard.ZstdDecompressor(max_window_size=MAX_ZSTD_WINDOW).decompress(
            data, max_output_size=limit
        )
    except zstandard.ZstdError as error:
        raise UnpackError("its zstd data is broken") from error


def unpack_lz4(data: bytes, limit: int) -> bytes:
    """One frame, of at most `limit` bytes unpacked."""
    import lz4.frame  # type: ignore[import-untyped]

    return _unpacked(lz4.frame.LZ4FrameDecompressor(), data, limit, "lz4")


def unpack_bz2(data: bytes, limit: int) -> bytes:
    """One stream, of at most `limit` bytes unpacked."""
    import bz2

    return _unpacked(bz2.BZ2Decompressor(), data, limit, "bz2")


def _unpacked(unpacker: Any, data: bytes, limit: int, name: str) -> bytes:
    try:
        out: bytes = unpacker.decompress(data, limit)
        if not unpacker.eof:  # the end mark may still wait
            out += unpacker.decompress(b"", 1)
    except (RuntimeError, OSError, EOFError, ValueError, MemoryError) as error:
        raise UnpackError(f"its {name} data is broken") from error
    if len(out) > limit:
        raise UnpackError("unpacked it is too large")
    return out


@contextmanager
def mapped(path: Path, damage: list[str]) -> Iterator[mmap.mmap]:
    """The bytes of a file, read only; those of a `.zstd` file from an unpacked copy."""
    with path.open("rb") as file:
        if path.suffix.lower() in ZSTD_ENDINGS:
            with tempfile.TemporaryFile() as copy:
                _unpack_file(file, copy, path, damage)
                with _map(copy, path) as data:
                    yield data
        else:
            with _map(file, path) as data:
                yield data


def _map(file: Any, path: Path) -> mmap.mmap:
    file.seek(0, 2)
    if not file.tell():
        raise InputError(f"{path.name}: must not be empty")
    return mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ)


def _unpack_file(file: BinaryIO, copy: Any, path: Path, damage: list[str]) -> None:
    import zstandard

    size = 0
    try:
        with zstandard.ZstdDecompressor(max_window_size=MAX_ZSTD_WINDOW).stream_reader(
            file, read_across_frames=True, closefd=False
        ) as reader:
            while block := reader.read(COPY_BYTES):
                size += len(block)
                if size > MAX_UNPACKED_FILE:
                    raise InputError(
                        f"{path.name}: must have at most {MAX_UNPACKED_FILE} bytes when unpacked"
                    )
                copy.write(block)
    except zstandard.ZstdError:
        damage.append(
            f"{path.name}: the zstd data is broken near its byte {file.tell()}; {size} bytes were unpacked"
        )
    copy.flush()

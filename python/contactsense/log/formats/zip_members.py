"""The members of a ZIP archive, also of one whose end is missing."""

from __future__ import annotations

import io
import struct
import zipfile
import zlib
from collections.abc import Iterator

# Of a member: signature, version, flags, method, time, date, checksum, sizes packed and unpacked, lengths of
# name and further fields.
_LOCAL = struct.Struct("<4sHHHHHIIIHH")
_SIGNATURE = b"PK\x03\x04"
_STORED, _DEFLATED = 0, 8
# Sizes that do not fit into 32 bits stand in a further field with this number.
_LARGE, _LARGE_FIELD = 0xFFFFFFFF, 1
_CUT = "it is cut"


def members(data: bytes, most: int) -> Iterator[tuple[str, bytes | str]]:
    """Names and contents of the members; in place of contents that cannot be unpacked, why.

    Args:
        data: of the archive.
        most: what all contents may have together [B].

    Raises:
        OverflowError: they have more.
        ValueError: this is no archive.
    """
    try:
        archive = zipfile.ZipFile(io.BytesIO(data))
    except (zipfile.BadZipFile, OSError, ValueError, NotImplementedError, struct.error):
        yield from _without_directory(data, most)
        return
    for info in archive.infolist():
        most -= info.file_size
        if most < 0:
            raise OverflowError
        try:
            with archive.open(info) as member:
                content = member.read(info.file_size)
                if member.read(1) or len(content) < info.file_size:
                    raise zipfile.BadZipFile("it has another size than the archive says")
        # All that a broken archive makes zipfile raise, one that asks for a password among it.
        except (
            zipfile.BadZipFile,
            OSError,
            ValueError,
            EOFError,
            RuntimeError,
            zlib.error,
            struct.error,
        ) as error:
            yield info.filename, str(error)
            continue
        yield info.filename, content


def _without_directory(data: bytes, most: int) -> Iterator[tuple[str, bytes | str]]:
    """The same from what stands before each member, for an archive that was cut."""
    if not data.startswith(_SIGNATURE):
        raise ValueError("it is no archive")
    start = 0
    while data[start : start + len(_SIGNATURE)] == _SIGNATURE and len(data) - start >= _LOCAL.size:
        _, _, flags, method, _, _, checksum, packed, size, name_length, further = _LOCAL.unpack_from(
            data, start
        )
        start += _LOCAL.size
        name = data[start : start + name_length].decode("utf-8", "replace")
        start += name_length
        if size == _LARGE or packed == _LARGE:
            size, packed = _large_sizes(data[start : start + further], size, packed)
        start += further
        if start > len(data):
            break
        if flags & 0b1001:  # encrypted, or the sizes stand behind the content
            yield name, "the end of the archive is missing"
            return
        most -= size
        if most < 0:
            raise OverflowError
        content = data[start : start + packed]
        start += packed
        yield name, _unpacked(content, method, size, checksum) if len(content) == packed else _CUT
    yield "the end of the archive", "it is missing"


def _unpacked(content: bytes, method: int, size: int, checksum: int) -> bytes | str:
    try:
        if method == _DEFLATED:
            content = zlib.decompressobj(wbits=-15).decompress(content, size)  # -15: without header
        elif method != _STORED:
            return f"it is packed by method {method}"
    except zlib.error as error:
        return str(error)
    whole = len(content) == size and zlib.crc32(content) == checksum
    return content if whole else "its checksum is wrong"


def _large_sizes(fields: bytes, size: int, packed: int) -> tuple[int, int]:
    while len(fields) >= 4:
        number, length = struct.unpack_from("<HH", fields)
        if number == _LARGE_FIELD and length >= 16 and len(fields) >= 20:
            large: tuple[int, int] = struct.unpack_from("<QQ", fields, 4)
            return large
        fields = fields[4 + length :]
    return size, packed

"""Files broken at random, for readers that must not break with them."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import numpy as np

from contactsense.errors import InputError
from contactsense.log.recording import Recording

# Broken files a reader is given; more by CONTACTSENSE_FUZZ=10000.
CASES = int(os.environ.get("CONTACTSENSE_FUZZ", "300"))


def broken(data: bytes, random: np.random.Generator) -> bytes:
    """The bytes with one to eight changes: bits flipped, bytes inserted, left out or copied."""
    changed = bytearray(data)
    for _ in range(random.integers(1, 9)):
        at, length = int(random.integers(len(changed) + 1)), int(2 ** random.uniform(0, 8))
        match random.integers(4):
            case 0 if at < len(changed):
                changed[at] ^= 1 << int(random.integers(8))
            case 1:
                changed[at:at] = random.bytes(length)
            case 2:
                del changed[at : at + length]
            case _:
                other = int(random.integers(len(changed) + 1))
                changed[at : at + length] = changed[other : other + length]
    return bytes(changed)


def outcome(read: Callable[[Path], Recording], path: Path, data: bytes) -> Recording | InputError:
    """What the reader makes of the bytes: a consistent recording or an input error, and nothing else."""
    path.write_bytes(data)
    try:
        recording = read(path)
    except InputError as error:
        return error
    for table in recording.tables:
        for column in table.columns.values():
            assert column.dtype == np.float64
            assert column.shape == (table.rows,)
            assert column.flags.c_contiguous
    return recording


def check_broken(
    read: Callable[[Path], Recording], path: Path, whole: list[bytes], seed: int, cases: int = CASES
) -> None:
    """Gives the reader broken files made from whole ones; at least one of each outcome must occur."""
    random = np.random.default_rng(seed)
    kinds = [type(outcome(read, path, broken(whole[k % len(whole)], random))) for k in range(cases)]
    assert set(kinds) == {Recording, InputError}


def cuts(data: bytes, seed: int, count: int = 100) -> list[int]:
    """Places where a file is cut, among them the very beginning and the last byte."""
    return [0, len(data) - 1, *map(int, np.random.default_rng(seed).integers(0, len(data), count - 2))]

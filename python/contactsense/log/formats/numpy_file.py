"""Files of NumPy: one array, or an archive of named ones."""

from __future__ import annotations

from pathlib import Path

from ...errors import InputError
from ..recording import Column, Recording, Table
from . import unpack
from .arrays import flattened, tables
from .npy import BadArrayError, array_of
from .zip_members import members

_ARRAY = b"\x93NUMPY"
_ENDING = ".npy"


def read(path: Path) -> Recording:
    """Reads a `.npy` or `.npz` file; never objects of Python.

    The columns of a single array are named by field, or `0`, `1`, ..., those of an archive by array.

    Raises:
        InputError: the file cannot be read, is broken or too large, or has no numbers.
    """
    data, broken = unpack.contents(path)
    recording = _single(path, data) if data.startswith(_ARRAY) else _archive(path, data)
    if not recording.tables:
        why = "; ".join(recording.left_out + recording.damage)
        raise InputError(f"path: {path} has no column of numbers ({why})")
    damage = (broken, *recording.damage) if broken else recording.damage
    return Recording(recording.tables, recording.left_out, damage)


def _single(path: Path, data: bytes) -> Recording:
    left_out: list[str] = []
    try:
        array, damage = array_of(data)
        columns = dict(flattened("", array, left_out))
    except (BadArrayError, MemoryError) as error:
        raise InputError(f"path: cannot read {path}: {error}") from error
    if array.ndim <= 2 and array.dtype.kind in "biufmM":
        columns = {str(index): column for index, column in enumerate(columns.values())}
    named = {name.lstrip("."): column for name, column in columns.items()}
    table = (Table(path.stem, "", named),) if named else ()
    return Recording(table, tuple(left_out), (damage,) if damage else ())


def _archive(path: Path, data: bytes) -> Recording:
    columns: dict[str, Column] = {}
    left_out: list[str] = []
    damage = []
    try:
        for file, content in members(data, unpack.MOST_BYTES):
            name = file.removesuffix(_ENDING)
            if isinstance(content, str):
                damage.append(f"{name} cannot be read: {content}")
                continue
            if not content.startswith(_ARRAY):
                left_out.append(f"{file}: no array")
                continue
            try:
                array, missing = array_of(content)
                columns.update(flattened(name, array, left_out))
            except BadArrayError as error:
                left_out.append(f"{name}: {error}")
                continue
            if missing:
                damage.append(f"{name}: {missing}")
    except OverflowError as error:
        raise InputError(f"path: {path} has more than {unpack.MOST_BYTES >> 20} MiB; split it") from error
    except (ValueError, MemoryError) as error:
        raise InputError(f"path: cannot read {path}: {error}") from error
    return Recording(tables(path.stem, columns), tuple(left_out), tuple(damage))

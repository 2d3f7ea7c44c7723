"""Files and pickles of `ContactMemory`; loaded when they are needed."""

from __future__ import annotations

from os import PathLike
from typing import Any
from zipfile import BadZipFile

import numpy as np

from ._core import ContactMemory, Robot
from ._paths import path_of
from .errors import InputError

_OPTIONS = ("resolution", "prior", "free_error", "contact_error", "max_voxels")


def save(memory: ContactMemory, path: str | PathLike[str]) -> None:
    """Writes all that is known as arrays of NumPy."""
    file = path_of(path)
    indices, log_odds = memory._voxels()
    arrays: dict[str, Any] = _options(memory)
    arrays |= {"indices": indices.astype(np.int32), "log_odds": log_odds}
    try:
        with file.open("wb") as opened:
            np.savez_compressed(opened, **arrays)
    except (OSError, ValueError) as cause:
        raise InputError(f"path: {path!r} cannot be written ({cause})") from cause


def load(path: str | PathLike[str], robot: Robot) -> ContactMemory:
    """The memory that `save` wrote."""
    try:
        with np.load(path_of(path), allow_pickle=False) as arrays:
            options: dict[str, Any] = {name: arrays[name].item() for name in _OPTIONS}
            indices, log_odds = arrays["indices"], arrays["log_odds"]
    except (OSError, KeyError, TypeError, ValueError, BadZipFile) as cause:
        raise InputError(f"path: {path!r} is no file of ContactMemory.save ({cause})") from cause
    return restored(robot, options, indices, log_odds)


def reduced(memory: ContactMemory) -> tuple[Any, ...]:
    """For `pickle`."""
    return restored, (memory.robot, _options(memory), *memory._voxels())


def restored(robot: Robot, options: dict[str, Any], indices: Any, log_odds: Any) -> ContactMemory:
    """From all that is known."""
    memory = ContactMemory(robot, **options)
    memory._set_voxels(np.asarray(indices, dtype=np.float64).reshape(-1, 3), log_odds)
    return memory


def _options(memory: ContactMemory) -> dict[str, Any]:
    return {name: getattr(memory, name) for name in _OPTIONS}

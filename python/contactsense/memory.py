"""`ContactMemory` with its files."""

from __future__ import annotations

from os import PathLike
from typing import Any

import numpy as np

from ._core import ContactMemory as _ContactMemory
from ._core import Robot as _Robot
from .errors import InputError

_OPTIONS = ("resolution", "prior", "free_error", "contact_error", "max_voxels")


class ContactMemory(_ContactMemory):  # noqa: D101 - the docstring is that of the base
    __doc__ = _ContactMemory.__doc__

    def save(self, path: str | PathLike[str]) -> None:
        """Writes all that is known as arrays of NumPy: `indices` (n, 3), `log_odds` (n,), and the options.

        A voxel spans from `indices * resolution` to `(indices + 1) * resolution` in the world frame [m].

        Args:
            path: A file, which should end in ".npz".

        Raises:
            InputError: The file cannot be written.
        """
        indices, log_odds = self._voxels()
        arrays: dict[str, Any] = {name: getattr(self, name) for name in _OPTIONS}
        arrays |= {"indices": indices.astype(np.int32), "log_odds": log_odds}
        try:
            with open(path, "wb") as file:
                np.savez_compressed(file, **arrays)
        except OSError as cause:
            raise InputError(f"path: '{path}' cannot be written ({cause})") from cause

    @classmethod
    def load(cls, path: str | PathLike[str], robot: _Robot) -> ContactMemory:
        """The memory that `save` wrote.

        Args:
            path: The file.
            robot: The robot whose body and contacts are added from here on.

        Raises:
            InputError: The file cannot be read, or is none of `save`.
        """
        from zipfile import BadZipFile

        try:
            with np.load(path, allow_pickle=False) as arrays:
                options: dict[str, Any] = {name: arrays[name].item() for name in _OPTIONS}
                indices, log_odds = arrays["indices"], arrays["log_odds"]
        except (OSError, KeyError, ValueError, BadZipFile) as cause:
            raise InputError(f"path: '{path}' is no file of ContactMemory.save ({cause})") from cause
        return _restored(cls, robot, options, indices, log_odds)

    def __reduce__(self) -> Any:
        options = {name: getattr(self, name) for name in _OPTIONS}
        return _restored, (type(self), self.robot, options, *self._voxels())


def _restored(
    cls: type[ContactMemory], robot: _Robot, options: dict[str, Any], indices: Any, log_odds: Any
) -> ContactMemory:
    memory = cls(robot, **options)
    memory._set_voxels(np.asarray(indices, dtype=np.float64).reshape(-1, 3), log_odds)
    return memory


ContactMemory.__module__ = "contactsense"

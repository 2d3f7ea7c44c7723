"""A recorded run: what an arm in contact measured, and what was true."""

from __future__ import annotations

import json
import os
import zipfile
from dataclasses import dataclass
from typing import Any

import numpy as np

from contactsense.errors import InputError

from ._arrays import FloatArray

_NUMBERS = ("time", "q", "v", "tau", "external_torque", "true_external_torque", "point", "normal", "force")
_FORMAT = "contactsense.ContactRun 1"


@dataclass(frozen=True, eq=False)
class ContactRun:
    """`T` samples of an arm that touches an obstacle. Forces act on the robot; world frame.

    Where nothing touches, `link` is "", `force` is zero, and `point` and `normal` are NaN.
    """

    time: FloatArray  # (T,) [s]
    q: FloatArray  # (T, nq)
    v: FloatArray  # (T, nv)
    tau: FloatArray  # (T, nv) measured motor torque, with noise and bias [Nm]
    external_torque: FloatArray  # (T, nv) what a filter is fed: with noise, bias and model error [Nm]
    true_external_torque: FloatArray  # (T, nv)
    link: tuple[str, ...]  # T, of the deepest contact
    point: FloatArray  # (T, 3) on the robot's surface [m]
    normal: FloatArray  # (T, 3) unit, outward of the robot
    force: FloatArray  # (T, 3) [N]
    settings: dict[str, Any]  # plain values: robot, obstacle, stiffness, friction, noise, seed...

    def __post_init__(self) -> None:
        count = np.shape(self.time)[0] if np.ndim(self.time) == 1 else -1
        for name in _NUMBERS:
            value = np.ascontiguousarray(getattr(self, name), dtype=np.float64)
            width = 3 if name in ("point", "normal", "force") else None
            if value.ndim != (1 if name == "time" else 2) or value.shape[0] != count:
                raise InputError(f"{name} must have one row for each of the {max(count, 0)} times")
            if width is not None and value.shape[1] != width:
                raise InputError(f"{name} must have shape ({count}, 3), not {value.shape}")
            free = name in ("point", "normal")
            if not (np.isfinite(value) | (free & np.isnan(value))).all():
                raise InputError(f"{name} must be finite")
            object.__setattr__(self, name, value)
        for name in ("tau", "external_torque", "true_external_torque"):
            if getattr(self, name).shape != self.v.shape:
                raise InputError(f"{name} must have the shape of v, {self.v.shape}")
        object.__setattr__(self, "link", tuple(str(name) for name in self.link))
        if len(self.link) != count:
            raise InputError(f"link must have {count} names, not {len(self.link)}")

    def __len__(self) -> int:
        return len(self.time)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write one compressed NumPy archive (.npz), without pickled objects.

        Raises:
            InputError: the settings are not plain values.
        """
        try:
            settings = json.dumps(self.settings, allow_nan=False)
        except (TypeError, ValueError) as cause:
            raise InputError(f"settings must be plain values that JSON can hold: {cause}") from cause
        arrays: dict[str, Any] = {name: getattr(self, name) for name in _NUMBERS}
        text = {"format": _FORMAT, "settings": settings}
        arrays |= {name: np.array(value, dtype=np.str_) for name, value in text.items()}
        arrays["link"] = np.array(self.link, dtype=np.str_)
        with open(path, "wb") as file:
            np.savez_compressed(file, **arrays)

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> ContactRun:
        """Read what `save` wrote.

        Raises:
            InputError: the file is not such a record, or is damaged; says what is wrong.
        """
        name = os.fspath(path)
        try:
            with open(path, "rb") as file, np.lib.npyio.NpzFile(file, allow_pickle=False) as archive:
                arrays = {key: archive[key] for key in archive.files}
        except (OSError, ValueError, EOFError, KeyError, zipfile.BadZipFile) as cause:
            raise InputError(f"path: '{name}' cannot be read as a recorded run: {cause}") from cause
        missing = {*_NUMBERS, "format", "settings", "link"} - set(arrays)
        if missing:
            raise InputError(f"path: '{name}' is not a recorded run, it lacks {', '.join(sorted(missing))}")
        if str(arrays["format"]) != _FORMAT:
            raise InputError(f"path: '{name}' has format {str(arrays['format'])!r}, not {_FORMAT!r}")
        try:
            settings = json.loads(str(arrays["settings"]))
            numbers = {key: arrays[key].astype(np.float64) for key in _NUMBERS}
        except (TypeError, ValueError) as cause:
            raise InputError(f"path: '{name}' is damaged: {cause}") from cause
        if not isinstance(settings, dict) or arrays["link"].ndim != 1:
            raise InputError(f"path: '{name}' is damaged: its settings or links have another form")
        try:
            return cls(**numbers, link=tuple(arrays["link"].tolist()), settings=settings)
        except InputError as cause:
            raise InputError(f"path: '{name}' is damaged: {cause}") from cause

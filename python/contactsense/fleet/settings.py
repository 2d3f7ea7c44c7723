"""What all logs of one robot have in common when they are replayed."""

from __future__ import annotations

import hashlib
import json
import pickle
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from .. import _core


@dataclass(frozen=True, eq=False)
class Settings:
    """Settings of a task; pickled once a task, or once for all.

    Args:
        folder: of the data set.
        name: of the robot in the data set.
        robot: its model.
        reading: arguments of `read_log`.
        monitor: arguments of `ContactMonitor`.
        classifier: arguments of `ContactClassifier`; None if contacts are not classified.
        ticks: whether the data set has the table of all ticks.
    """

    folder: Path
    name: str
    robot: _core.Robot
    reading: Mapping[str, Any]
    monitor: Mapping[str, Any]
    classifier: Mapping[str, Any] | None
    ticks: bool

    def input_of(self, log: Path) -> str:
        """A fingerprint of all that the results of a log follow from.

        Files are told apart by size and time of change, since reading them would take as long as replaying.
        """
        files = sorted(path for path in log.rglob("*") if path.is_file()) if log.is_dir() else [log]
        states = [(path.name, path.stat().st_size, path.stat().st_mtime_ns) for path in files]
        return _digest(f"{self._digest} {states}".encode())

    @cached_property
    def _digest(self) -> str:
        parts = [_core.__version__, self.name, self.robot, self.reading, self.monitor, self.ticks]
        if self.classifier is not None:
            parts.append(self.classifier)
        return _digest(json.dumps(_plain(parts)).encode())


def _plain(value: Any) -> Any:
    """Equal for equal settings; robots, calibrations and sensors are what they are pickled as."""
    if value is None or isinstance(value, bool | int | float | str):
        return value
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    if isinstance(value, Mapping):
        return sorted(([_plain(key), _plain(each)] for key, each in value.items()), key=str)
    if isinstance(value, list | tuple):
        return [_plain(each) for each in value]
    return str(value) if isinstance(value, Path) else _digest(pickle.dumps(value))


def _digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()

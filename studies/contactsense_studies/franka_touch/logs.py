"""Reading the logs: what `contactsense.read_log` makes of them, and the labels beside it."""

from __future__ import annotations

import os
import re
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import contactsense
from contactsense import InputError, Log, Robot
from contactsense.log.files import read_recording

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]

JOINTS = 7
# a is the last link; the letters count towards the base.
LINK_OF_LETTER = dict(zip("abcdefg", range(7, 0, -1), strict=True))
FILE_NAME = re.compile(r"([a-g]\d+)\.csv(\.gz)?")
VECTORS = ("q", "dq", "tau_J", "tau_ext")
COLUMNS = ("time", *(f"{name}{joint}" for name in VECTORS for joint in range(JOINTS)), "label")


@dataclass(frozen=True)
class TouchLog:
    """One file; n rows."""

    name: str
    measured: Log  # with the torques of the motors
    vendor: Log  # with the vendor's external torque, acting on the robot, in their place
    label: BoolArray  # (n,) whether a person touches

    @property
    def link(self) -> int:
        """Number of the link touched."""
        return LINK_OF_LETTER[self.name[0]]

    @property
    def time(self) -> FloatArray:
        """`(n,)`, from the first row on [s]."""
        return self.measured.time

    @property
    def dt(self) -> float:
        """Time between two rows [s], as `contactsense replay` takes it."""
        return float(np.median(np.diff(self.time)))

    @cached_property
    def touches(self) -> list[tuple[int, int]]:
        """First row and last row of every touch."""
        edges = np.flatnonzero(np.diff(np.concatenate([[0], self.label.astype(int), [0]])))
        return [(int(first), int(end) - 1) for first, end in zip(edges[::2], edges[1::2], strict=True)]

    @property
    def repeated(self) -> float:
        """Share of rows that repeat the row before: the robot had sent nothing new."""
        parts = (self.measured.q, self.measured.v, self.measured.tau, self.vendor.external_torque)
        state = np.hstack([part for part in parts if part is not None])
        return float(np.mean(np.all(state[1:] == state[:-1], axis=1)))


def log_files(folder: str | os.PathLike[str]) -> list[Path]:
    """The logs of a folder, by name.

    Raises:
        InputError: there is no such folder, or no log in it.
    """
    path = Path(folder)
    if not path.is_dir():
        raise InputError(f"data: there is no folder '{path}'; it should hold a4.csv.gz and the like")
    files = sorted(file for file in path.iterdir() if FILE_NAME.fullmatch(file.name))
    if not files:
        raise InputError(
            f"data: no logs in '{path}'; a name is the letter of the link, a to g, and a number: a4.csv.gz"
        )
    names = [file.name.partition(".")[0] for file in files]
    if len(set(names)) < len(names):
        raise InputError(f"data: '{path}' has a log twice, as .csv and .csv.gz")
    return files


def read_log(path: Path, robot: Robot) -> TouchLog:
    """One log.

    Raises:
        InputError: names the file and column.
    """
    table = read_table(path)
    measured = contactsense.read_log(path, robot)
    # The vendor's sign is that of the measured torque: what the robot exerts.
    vendor = contactsense.read_log(path, robot, external=True, torque_constants=-1.0)
    # Rows with the time of the row before are left out of a log.
    kept = np.diff(table[:, 0], prepend=-np.inf) > 0.0
    return TouchLog(path.name.partition(".")[0], measured, vendor, table[kept, -1] == 1)


def read_table(path: Path) -> FloatArray:
    """The rows of a file, ordered as `COLUMNS`; the file may have more columns, in any order.

    Raises:
        InputError: a column or value cannot be used; names the file and column.
    """
    try:
        tables = read_recording([path]).tables
    except (OSError, InputError) as cause:
        raise InputError(f"data: '{path}' cannot be read as a table of numbers: {cause}") from cause
    columns = tables[0].columns
    missing = [name for name in COLUMNS if name not in columns]
    if missing:
        raise InputError(f"data: '{path}' lacks the column {missing[0]}; wanted: {', '.join(COLUMNS)}")
    table = np.column_stack([columns[name] for name in COLUMNS])
    _check(table, path)
    return table


def _check(table: FloatArray, path: Path) -> None:
    if len(table) < 2:
        raise InputError(f"data: '{path}' has {len(table)} rows; at least 2 are wanted")
    bad = np.argwhere(~np.isfinite(table))
    if len(bad):
        row, column = bad[0]
        raise InputError(f"data: '{path}', row {row + 1}, column {COLUMNS[column]}: must be finite")
    time, label = table[:, 0], table[:, -1]
    if np.any(np.diff(time) < 0) or time[-1] <= time[0]:
        raise InputError(f"data: '{path}', column time: must not decrease, and must advance")
    if not np.all((label == 0) | (label == 1)):
        raise InputError(f"data: '{path}', column label: must be 0 or 1")
    if not np.any(label == 1):
        raise InputError(f"data: '{path}', column label: no contact in this log")

"""Reading the logs."""

from __future__ import annotations

import gzip
import os
import re
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from contactsense import InputError

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
    time: FloatArray  # (n,) [s]
    q: FloatArray  # (n, 7) [rad]
    dq: FloatArray  # (n, 7) [rad/s]
    tau: FloatArray  # (n, 7) measured joint torques [Nm]
    vendor: FloatArray  # (n, 7) the vendor's external torque, acting on the robot [Nm]
    label: BoolArray  # (n,) whether a person touches

    @property
    def link(self) -> int:
        """Number of the link touched."""
        return LINK_OF_LETTER[self.name[0]]

    @property
    def dt(self) -> float:
        """Mean time between two rows [s]."""
        return float((self.time[-1] - self.time[0]) / (len(self.time) - 1))

    @cached_property
    def touches(self) -> list[tuple[int, int]]:
        """First row and last row of every touch."""
        edges = np.flatnonzero(np.diff(np.concatenate([[0], self.label.astype(int), [0]])))
        return [(int(first), int(end) - 1) for first, end in zip(edges[::2], edges[1::2], strict=True)]

    @property
    def repeated(self) -> float:
        """Share of rows that repeat the row before: the robot had sent nothing new."""
        state = np.hstack([self.q, self.dq, self.tau, self.vendor])
        return float(np.mean(np.all(state[1:] == state[:-1], axis=1)))


def read_logs(folder: str | os.PathLike[str]) -> list[TouchLog]:
    """All logs of a folder, by name.

    Raises:
        InputError: there is no such folder, no log in it, or a log cannot be used; names the file and column.
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
    return [read_log(file) for file in files]


def read_log(path: Path) -> TouchLog:
    """One log.

    Raises:
        InputError: names the file and column.
    """
    return log_of_table(path.name.partition(".")[0], read_columns(path), str(path))


def read_columns(path: Path) -> FloatArray:
    """The rows of a CSV file, ordered as `COLUMNS`; the file may have more columns, in any order.

    Raises:
        InputError: names the file and column.
    """
    try:
        with gzip.open(path, "rt") if path.suffix == ".gz" else path.open() as file:
            header = [name.strip() for name in file.readline().split(",")]
            missing = [name for name in COLUMNS if name not in header]
            if missing:
                wanted = ", ".join(COLUMNS)
                raise InputError(f"data: '{path}' lacks the column {missing[0]}; wanted: {wanted}")
            lines = file.readlines()
            used = [header.index(name) for name in COLUMNS]
            # No lines would be a warning of NumPy's.
            return np.loadtxt(lines, delimiter=",", ndmin=2, usecols=used) if lines else np.empty((0, 0))
    except InputError:
        raise
    except (OSError, EOFError, ValueError) as cause:
        raise InputError(f"data: '{path}' cannot be read as a table of numbers: {cause}") from cause


def log_of_table(name: str, table: FloatArray, origin: str) -> TouchLog:
    """A log of rows ordered as `COLUMNS`; `origin` names it in errors.

    Raises:
        InputError: a value cannot be used.
    """
    if len(table) < 2:
        raise InputError(f"data: '{origin}' has {len(table)} rows; at least 2 are wanted")
    bad = np.argwhere(~np.isfinite(table))
    if len(bad):
        row, column = bad[0]
        raise InputError(f"data: '{origin}', row {row + 1}, column {COLUMNS[column]}: must be finite")
    time, label = table[:, 0], table[:, -1]
    if np.any(np.diff(time) < 0) or time[-1] <= time[0]:
        raise InputError(f"data: '{origin}', column time: must not decrease, and must advance")
    if not np.all((label == 0) | (label == 1)):
        raise InputError(f"data: '{origin}', column label: must be 0 or 1")
    if not np.any(label == 1):
        raise InputError(f"data: '{origin}', column label: no contact in this log")
    q, dq, tau, vendor = np.split(table[:, 1:-1], len(VECTORS), axis=1)
    # The vendor's sign is that of the measured torque: what the robot exerts.
    return TouchLog(name, time, q.copy(), dq.copy(), tau.copy(), -vendor, label == 1)

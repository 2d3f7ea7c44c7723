"""Velocities from positions, and rows at equal steps."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from .quaternions import slerp
from .time_axis import ROUNDING

Rows = NDArray[np.float64]

# The values that are quaternions.
QUATERNION = "base quaternion"
# Of the differences that replace missing velocities [s]: encoders of 17 bits at 1 kHz then err by 2 mrad/s.
SPAN = 0.02
# A log of more rows than this is a wrong rate.
_MOST_ROWS = 100_000_000


def neighbours(time: Rows) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """The rows before and after each that are `SPAN` apart, or next to it where those are farther apart."""
    rows, half = np.arange(len(time)), 0.5 * SPAN + ROUNDING
    before = np.minimum(np.searchsorted(time, time - half), np.maximum(rows - 1, 0))
    after = np.maximum(np.searchsorted(time, time + half, side="right") - 1, np.minimum(rows + 1, rows[-1]))
    return before, after


def differences(time: Rows, position: Rows) -> Rows:
    """Central differences between neighbours."""
    before, after = neighbours(time)
    velocity: Rows = (position[after] - position[before]) / (time[after] - time[before])[:, None]
    return velocity


def at_rate(time: Rows, values: Mapping[str, Rows], rate: float) -> tuple[Rows, dict[str, Rows]]:
    """Rows at equal steps, by linear interpolation; of quaternions on the shortest arc.

    Raises:
        InputError: so many rows are no log.
    """
    count = int((time[-1] - time[0]) * rate) + 1
    if not 2 <= count <= _MOST_ROWS:
        raise InputError(f"rate: {rate:g} rows a second of {time[-1] - time[0]:.3f} s are {count} rows")
    even = time[0] + np.arange(count) / rate
    columns = {
        name: slerp(time, rows, even)
        if name == QUATERNION
        else np.column_stack([np.interp(even, time, rows[:, k]) for k in range(rows.shape[1])])
        for name, rows in values.items()
    }
    return even, columns

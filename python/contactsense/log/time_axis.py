"""The time of a table's rows: which column has it, in which unit, and what is wrong with it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from .joint_names import words
from .recording import Column, Recording, Table, listing

# In this order.
_NAMES = (
    *("time", "t", "timestamp", "time s", "timestamp s", "stamp"),
    *("time ns", "time us", "time ms", "timestamp ns", "timestamp us", "timestamp ms"),
    *("stamp s", "stamp ns", "stamp us", "stamp ms"),
    *("sec", "secs", "seconds", "rosbag timestamp", "robot time", "clock"),
)
_UNITS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}
# Median steps up to these are in seconds, milliseconds, microseconds, where the name has no unit: robots
# measure at 5 Hz to 5 kHz.
_STEPS = (("s", 0.2), ("ms", 200.0), ("us", 2e5), ("ns", np.inf))
# A message that is late arrives within so many others; a clock that was set back stays behind for longer.
_LATE_ROWS = 10
# A step of so many median ones is a gap.
GAP = 5.0
# No clock shows more [s]: 30,000 years.
_LATEST = 1e12
# Stamps since 1970 are rounded to this [s].
ROUNDING = 1e-6


@dataclass(frozen=True)
class TimeAxis:
    """The rows to keep, in order, with their time from the first on [s]; and what was done."""

    rows: NDArray[np.intp]
    time: Column
    start: float
    chosen: str
    mended: tuple[str, ...]


def time_of(recording: Recording, table: Table, column: str | None) -> TimeAxis:
    """The time axis of a table; `column` names the column of its time.

    Raises:
        InputError: there is no time, or none of its rows can be used.
    """
    name, seconds, offset = _seconds(recording, table, column)
    rows = np.flatnonzero(np.abs(seconds) < _LATEST)
    missing = len(seconds) - len(rows)
    if len(rows) < 2:
        raise InputError(f"columns: {table.name} has {len(rows)} rows with a time; at least 2 are wanted")
    start = float(seconds[rows[0]])
    time = seconds[rows] - start
    time, jumps = _without_jumps(time)
    order = np.argsort(time, kind="stable")
    late = int(np.count_nonzero(time < np.maximum.accumulate(time)))
    time, rows = time[order], rows[order]
    kept = np.concatenate([[True], np.diff(time) > 0.0])
    repeated = int(np.count_nonzero(~kept))
    time, rows = time[kept], rows[kept]
    steps = np.diff(time)
    gaps = steps[steps > GAP * np.median(steps)] if len(steps) else steps
    notes = [
        (missing, f"{missing} rows without a time left out"),
        (jumps, f"the clock was set back {jumps} times; later rows follow on"),
        (late, f"{late} rows out of order, put in order"),
        (repeated, f"{repeated} rows with the time of the row before left out"),
        (len(gaps), f"{len(gaps)} gaps, the longest {gaps.max() if len(gaps) else 0.0:.3f} s"),
    ]
    rate = 1.0 / float(np.median(steps)) if len(steps) else 0.0
    chosen = f"time from {name}: {len(time)} rows, {time[-1] - time[0]:.3f} s, {rate:.4g} rows a second"
    return TimeAxis(
        rows, time - time[0], offset + start, chosen, tuple(text for count, text in notes if count)
    )


def _seconds(recording: Recording, table: Table, column: str | None) -> tuple[str, Column, float]:
    """Where the time is from; the time after an offset, and the offset [s]."""
    if column is not None:
        if column not in table.columns:
            raise InputError(
                f"columns: {table.name} has no column {column!r}; there are {listing(recording)}"
            )
        return _scaled(column, table.columns[column])
    stamp = table.columns.get("header.stamp")
    if stamp is not None and len(stamp) > 1 and np.nanmax(stamp) > np.nanmin(stamp):
        return "header.stamp", stamp, 0.0
    if table.received is not None:
        return "when messages were received", table.received, 0.0
    by_words = {words(name): name for name in reversed(list(table.columns))}
    named = [by_words[words(known)] for known in _NAMES if words(known) in by_words]
    advancing = [name for name in named if np.any(table.columns[name][1:] > table.columns[name][:-1])]
    if advancing:
        best = min(advancing, key=lambda name: _faults(table.columns[name]))
        return _scaled(best, table.columns[best])
    raise InputError(
        f"columns: {table.name} has no column of time; name it with columns={{'time': ...}} "
        f"(--column time=...); there are {listing(recording)}"
    )


def _faults(values: Column) -> tuple[bool, bool]:
    """Whether values are missing, and whether it is only a counter of rows: other columns are better."""
    finite = values[np.abs(values) < _LATEST / _UNITS["ns"]]
    return len(finite) < len(values), bool(np.all(np.diff(finite) == 1.0))


def _scaled(name: str, values: Column) -> tuple[str, Column, float]:
    values = np.where(np.abs(values) < _LATEST / _UNITS["ns"], values, np.nan)
    steps = np.diff(values[np.isfinite(values)])
    steps = steps[steps > 0.0]
    median = float(np.median(steps)) if len(steps) else 0.0
    last = words(name)[-1:]
    unit = last[0] if last and last[0] in _UNITS else next(unit for unit, most in _STEPS if median <= most)
    # Differences first: nanoseconds since 1970 have as many digits as a number can hold.
    first = values[np.isfinite(values)][:1]
    offset = float(first[0]) if len(first) else 0.0
    return f"'{name}' [{unit}]", (values - offset) * _UNITS[unit], offset * _UNITS[unit]


def _without_jumps(time: Column) -> tuple[Column, int]:
    """Rows after the clock was set back follow on one median step later."""
    steps = np.diff(time)
    forward = steps[steps > 0.0]
    median = float(np.median(forward)) if len(forward) else 0.0
    shifts = np.zeros(len(time))
    jumps = 0
    for row in np.flatnonzero(steps < 0.0).tolist():
        following = time[row + 1 : row + 1 + _LATE_ROWS]
        if len(following) == _LATE_ROWS and np.all(following < time[row]):
            shifts[row + 1] = time[row] + median - time[row + 1]
            jumps += 1
    return time + np.cumsum(shifts), jumps


def held(time: Column, table_time: Column) -> NDArray[np.intp]:
    """For each time the row of another table that was the last by then; -1 before its first."""
    return np.searchsorted(table_time, time + ROUNDING, side="right") - 1

"""Values of a topic of its own rate at the times of the joints."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from .blocks import Block
from .recording import Recording
from .time_axis import GAP, TimeAxis, held, time_of

Rows = NDArray[np.float64]

# No measurement is as large as this, in whatever unit: what is there is a broken file.
LARGEST = 1e12


@dataclass(frozen=True)
class Series:
    """The complete rows of a block.

    Args:
        start: when its time begins, on the clock of the file [s].
        time: `(n,)`, from then on [s].
        values: `(n, components)`.
        missing: how many rows lack a value.
    """

    start: float
    time: Rows
    values: Rows
    missing: int

    def at(self, axis: TimeAxis | Series) -> tuple[Rows, NDArray[np.bool_]]:
        """The last values by each time of an axis, and where there were any."""
        if not len(self.time):
            return np.zeros((len(axis.time), self.values.shape[1])), np.zeros(len(axis.time), dtype=bool)
        last = held(axis.time + (axis.start - self.start), self.time)
        return self.values[np.maximum(last, 0)], last >= 0


def series_of(recording: Recording, block: Block, time_column: str | None) -> Series:
    """The rows of a block in the order of time."""
    own = time_of(recording, block.table, time_column if time_column in block.table.columns else None)
    values = np.column_stack([block.table.columns[name][own.rows] for name in block.columns])
    whole = np.all(np.abs(values) < LARGEST, axis=1)  # a NaN is not less than anything
    return Series(own.start, own.time[whole], values[whole], int(np.count_nonzero(~whole)))


@dataclass
class Extra:
    """What a log has beside the joints.

    Args:
        values: `(n, .)` each, by name, at the times of the joints.
        known: which rows have all of them.
        chosen: lines of `Reading`.
        mended: lines of `Reading`.
        left_out: lines of `Reading`.
    """

    values: dict[str, Rows]
    known: NDArray[np.bool_]
    chosen: list[str]
    mended: list[str]
    left_out: list[str]

    @classmethod
    def none(cls, axis: TimeAxis) -> Extra:
        """Nothing yet."""
        return cls({}, np.ones(len(axis.time), dtype=bool), [], [], [])

    def hold(self, series: Series, axis: TimeAxis, what: str, argument: str) -> Rows:
        """The last values by each row of the joints; notes what is missing.

        Raises:
            InputError: there are none at the time of the joints.
        """
        values, present = series.at(axis)
        if not np.any(present):
            raise InputError(f"{argument}: the log has no {what} by the last row of the joints")
        end = series.start + series.time[-1]
        if end < axis.start:
            raise InputError(
                f"{argument}: {what} ends {axis.start - end:.3f} s before the joints begin; are their clocks "
                "the same?"
            )
        self.known &= present
        if series.missing:
            self.mended.append(f"{series.missing} rows without {what}; the last one before is kept")
        steps = np.diff(series.time)
        most = GAP * float(np.median(steps)) if len(steps) else np.inf
        gaps = steps[steps > most]
        if len(gaps):
            longest = f"the longest {gaps.max():.3f} s"
            self.mended.append(f"{len(gaps)} gaps in {what}, {longest}; the last one before is kept")
        late = float(axis.start + axis.time[-1] - end)
        if late > most:
            self.mended.append(f"{what} ends {late:.3f} s before the joints; the last one is kept")
        return values

    def add(self, other: Extra) -> None:
        """Takes in another."""
        self.values |= other.values
        self.known &= other.known
        self.chosen += other.chosen
        self.mended += other.mended
        self.left_out += other.left_out

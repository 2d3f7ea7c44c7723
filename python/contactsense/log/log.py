"""Measurements of one robot over time, as plain arrays."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import InputError
from .reading import Reading

_COLUMNS = ("time", "q", "v", "tau", "wrenches", "external_torque")
_NEEDED = ("time", "q", "v")


@dataclass(frozen=True, eq=False, repr=False)
class Log:
    """What one robot measured over time; `n` rows in the order of time, not necessarily at equal distances.

    Args:
        time: `(n,)`, strictly increasing [s].
        q: `(n, nq)`, positions [rad; m for sliding joints]; a floating base first, as in `Robot`.
        v: `(n, nv)`, velocities [rad/s; m/s for sliding joints].
        tau: `(n, nv)`, or `(n, nv - 6)` for a floating base: torques of the motors [Nm; N for sliding
            joints]; none where only an external torque was recorded.
        wrenches: `(n, sensors, 6)`, readings of force/torque sensors, force first, in their frames [N, Nm].
        external_torque: `(n, nv)`, the external torque as the robot's vendor estimates it [Nm].
        reading: how it was read from a file; None for a log of arrays.

    Raises:
        InputError: an array has the wrong shape or a number that is not finite, the time does not increase,
            or there is neither `tau` nor `external_torque`.

    Example:
        >>> import contactsense as cs
        >>> import numpy as np
        >>> robot = cs.Robot.named("iiwa14")
        >>> log = cs.Log([0.0, 0.001], [robot.neutral()] * 2, np.zeros((2, 7)), np.zeros((2, 7)))
        >>> len(log)
        2
    """

    time: NDArray[np.float64]
    q: NDArray[np.float64]
    v: NDArray[np.float64]
    tau: NDArray[np.float64] | None
    wrenches: NDArray[np.float64] | None
    external_torque: NDArray[np.float64] | None
    reading: Reading | None

    def __init__(
        self,
        time: ArrayLike,
        q: ArrayLike,
        v: ArrayLike,
        tau: ArrayLike | None = None,
        *,
        wrenches: ArrayLike | None = None,
        external_torque: ArrayLike | None = None,
        reading: Reading | None = None,
    ) -> None:
        given = dict(time=time, q=q, v=v, tau=tau, wrenches=wrenches, external_torque=external_torque)
        if tau is None and external_torque is None:
            raise InputError("tau: a log needs tau, or external_torque where the motors' torque is unknown")
        dimensions = {"time": 1, "wrenches": 3}
        rows: int | None = None
        for name, value in given.items():
            left_out = value is None and name not in _NEEDED
            array = None if left_out else _checked(name, value, dimensions.get(name, 2), rows)
            rows = rows if array is None else len(array)
            object.__setattr__(self, name, array)
        object.__setattr__(self, "reading", reading)
        if np.any(np.diff(self.time) <= 0.0):
            row = int(np.flatnonzero(np.diff(self.time) <= 0.0)[0]) + 1
            raise InputError(f"time: must increase from row to row [s]; row {row} does not")
        if self.wrenches is not None and self.wrenches.shape[2] != 6:
            raise InputError(f"wrenches: must be (n, sensors, 6), not {self.wrenches.shape}")

    def __len__(self) -> int:
        return len(self.time)

    def __repr__(self) -> str:
        seconds = float(self.time[-1] - self.time[0]) if len(self) else 0.0
        has = [name for name in _COLUMNS if getattr(self, name) is not None]
        return f"Log({len(self)} rows, {seconds:.3f} s: {', '.join(has)})"

    def __getitem__(self, rows: slice) -> Log:
        """The log of some rows."""
        if not isinstance(rows, slice):
            raise InputError(f"rows: must be a slice, not {type(rows).__name__}")
        columns = (getattr(self, name) for name in _COLUMNS)
        parts = [None if column is None else column[rows] for column in columns]
        return _restore(*parts, self.reading)

    def __reduce__(self) -> tuple[Any, ...]:
        return _restore, tuple(getattr(self, field.name) for field in fields(self))


def _restore(*columns: Any) -> Log:
    time, q, v, tau, wrenches, external_torque, reading = columns
    return Log(time, q, v, tau, wrenches=wrenches, external_torque=external_torque, reading=reading)


def _checked(name: str, value: ArrayLike | None, dimensions: int, rows: int | None) -> NDArray[np.float64]:
    try:
        array = np.array(value, dtype=np.float64, order="C")
    except OverflowError:
        raise InputError(f"{name}: has a number that is too large") from None
    except (TypeError, ValueError):
        raise InputError(f"{name}: must be an array of numbers") from None
    if array.ndim != dimensions:
        raise InputError(f"{name}: must have {dimensions} dimensions, not {array.ndim}")
    if rows is not None and len(array) != rows:
        raise InputError(f"{name}: must have as many rows as time, {rows}, not {len(array)}")
    if not np.all(np.isfinite(array)):
        row = int(np.argwhere(~np.isfinite(array))[0][0])
        raise InputError(f"{name}: must be finite; row {row} is not")
    array.setflags(write=False)
    return array

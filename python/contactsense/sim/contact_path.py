"""Poses that an arm is to go through, and at what pace."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contactsense.errors import InputError

from ._arrays import FloatArray, positive


@dataclass(frozen=True)
class PathPoint:
    """Where a path is at one time."""

    q: FloatArray  # (nq,)
    v: FloatArray  # (nv,)
    external_torque: FloatArray  # (nv,) [Nm]


@dataclass(frozen=True, eq=False)
class ContactPath:
    """Poses that an arm goes through in contact, `T` knots."""

    time: FloatArray  # (T,) [s]
    q: FloatArray  # (T, nq)
    external_torque: FloatArray  # (T, nv) what the contact is planned to put on the joints [Nm]

    def __len__(self) -> int:
        return len(self.time)

    def at(self, time: float) -> PathPoint:
        """Where the path is at `time` [s]: a cubic through the knots; at rest before and after."""
        k = int(np.clip(np.searchsorted(self.time, time, side="right") - 1, 0, len(self.time) - 2))
        length = float(self.time[k + 1] - self.time[k])
        share = float(np.clip((time - self.time[k]) / length, 0.0, 1.0))
        moving = 0.0 <= time <= self.time[-1]
        start, end = self.q[k], self.q[k + 1]
        first, last = length * self._velocity(k), length * self._velocity(k + 1)
        rise = end - start
        square, cube = 3.0 * rise - 2.0 * first - last, first + last - 2.0 * rise
        q = start + share * (first + share * (square + share * cube))
        v = (first + share * (2.0 * square + 3.0 * share * cube)) / length if moving else np.zeros_like(q)
        torque = self.external_torque[k] + share * (self.external_torque[k + 1] - self.external_torque[k])
        return PathPoint(q, v, torque)

    def _velocity(self, k: int) -> FloatArray:
        """Of knot `k`, by central differences."""
        if k == 0 or k == len(self.time) - 1:
            return np.zeros(self.q.shape[1])
        slope: FloatArray = (self.q[k + 1] - self.q[k - 1]) / (self.time[k + 1] - self.time[k - 1])
        return slope


@dataclass(frozen=True)
class Pace:
    """How many motions, how long, and how finely planned."""

    motions: int = 40
    duration: float = 0.25  # of one motion [s]; starts and ends at rest
    rate: float = 50.0  # of the knots [Hz]

    def __post_init__(self) -> None:
        if self.motions < 1:
            raise InputError(f"motions must be 1 or more, not {self.motions}")
        positive("duration", self.duration)
        if positive("rate", self.rate) * self.duration < 1.0:
            raise InputError("rate must give at least one knot a motion")

"""How a move of length 1 in time 1 covers its way."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from contactsense.errors import InputError

from ._arrays import FloatArray


@dataclass(frozen=True)
class MoveProfile:
    """Position, speed and acceleration over `x`, the share of the move's time, each of the shape of `x`."""

    position: Callable[[FloatArray], FloatArray]  # from 0 to 1
    speed: Callable[[FloatArray], FloatArray]
    acceleration: Callable[[FloatArray], FloatArray]
    peak_speed: float
    peak_acceleration: float


# Smooth: no speed and no acceleration at either end.
_QUINTIC = MoveProfile(
    position=lambda x: x**3 * (10.0 + x * (-15.0 + 6.0 * x)),
    speed=lambda x: 30.0 * (x * (1.0 - x)) ** 2,
    acceleration=lambda x: 60.0 * x * (1.0 - x) * (1.0 - 2.0 * x),
    peak_speed=1.875,
    peak_acceleration=5.7735,
)
# A third of the time each: constant acceleration, constant speed, constant deceleration.
_THIRD, _CRUISE, _RISE = 1.0 / 3.0, 1.5, 4.5


def _trapezoidal_position(x: FloatArray) -> FloatArray:
    up = 0.5 * _RISE * np.minimum(x, _THIRD) ** 2
    along = _CRUISE * np.clip(x - _THIRD, 0.0, _THIRD)
    last = np.maximum(x - 2.0 * _THIRD, 0.0)
    return np.asarray(up + along + last * (_CRUISE - 0.5 * _RISE * last))


def _trapezoidal_acceleration(x: FloatArray) -> FloatArray:
    starts = (x > 0.0) & (x <= _THIRD)
    brakes = (x > 2.0 * _THIRD) & (x < 1.0)
    return _RISE * (starts.astype(np.float64) - brakes)


_TRAPEZOIDAL = MoveProfile(
    position=_trapezoidal_position,
    speed=lambda x: _RISE * np.minimum(np.minimum(x, _THIRD), 1.0 - x),
    acceleration=_trapezoidal_acceleration,
    peak_speed=_CRUISE,
    peak_acceleration=_RISE,
)
_PROFILES: dict[str, MoveProfile] = {"quintic": _QUINTIC, "trapezoidal": _TRAPEZOIDAL}


def profile_of(name: str) -> MoveProfile:
    """The profile of that name.

    Raises:
        InputError: there is none.
    """
    if name not in _PROFILES:
        raise InputError(f"profile: must be one of {', '.join(map(repr, _PROFILES))}, not {name!r}")
    return _PROFILES[name]

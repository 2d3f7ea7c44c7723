"""From the units of a log to radians, newton metres, metres and newtons."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from .choice import Group
from .joint_names import words
from .quantities import CURRENT, EXTERNAL, POSITION, TORQUE, VELOCITY

Rows = NDArray[np.float64]

_DEGREE = np.pi / 180.0
UNITS = {
    POSITION: {"rad": 1.0, "deg": _DEGREE},
    VELOCITY: {"rad/s": 1.0, "deg/s": _DEGREE},
    TORQUE: {"Nm": 1.0, "mNm": 1e-3},
    EXTERNAL: {"Nm": 1.0, "mNm": 1e-3},
    CURRENT: {"A": 1.0, "mA": 1e-3},
}
# Half of an arm's joints do not turn farther [rad]; in degrees it is little.
_FARTHEST = 2.0 * np.pi
# Degrees differ from radians by a factor of 57: velocities tell by their ratio to differences of positions.
_BETWEEN = 57.3**0.5
# Differences of slower positions are the encoders' noise [rad/s].
_MOVING = 0.02


def check_units(units: Mapping[str, str]) -> None:
    """Refuses what is no quantity or unit.

    Raises:
        InputError: names what there is.
    """
    for quantity, unit in units.items():
        if quantity not in UNITS or unit not in UNITS[quantity]:
            known = "; ".join(f"{name}: {', '.join(them)}" for name, them in UNITS.items())
            raise InputError(f"units: there is no {quantity!r} in {unit!r}; there are {known}")


def unit_of(group: Group, values: Rows, turns: Sequence[bool], given: Mapping[str, str]) -> str:
    """The unit of a group: as given, as its names say, else by the size of joints that turn."""
    names = list(UNITS[group.quantity])
    if group.quantity in given:
        return given[group.quantity]
    in_names = {word for column in group.columns.values() for word in words(column)}
    if group.quantity in (POSITION, VELOCITY) and {"deg", "degree", "degrees"} & in_names:
        return names[1]
    if group.quantity == CURRENT and "ma" in in_names:
        return "mA"
    farthest = np.abs(values[:, np.asarray(turns)]).max(axis=0, initial=0.0)
    if group.quantity == POSITION and len(farthest) and np.median(farthest) > _FARTHEST:
        return "deg"
    return names[0]


def velocity_unit(unit: str, velocity: Rows, position: Rows, time: Rows, turns: Sequence[bool]) -> str:
    """Of velocities whose names tell no unit: that of the differences of positions [rad], if they tell it."""
    turning = np.asarray(turns)
    slope = np.abs(np.diff(position[:, turning], axis=0) / np.diff(time)[:, None])
    told = 0.5 * np.abs(velocity[1:, turning] + velocity[:-1, turning])
    size, expected = float(told.mean()) if told.size else 0.0, float(slope.mean()) if slope.size else 0.0
    return "deg/s" if expected > _MOVING and size > _BETWEEN * expected else unit


def scale(group: Group, unit: str) -> float:
    """What values in a unit are to be multiplied by."""
    return UNITS[group.quantity][unit]

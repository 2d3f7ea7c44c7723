"""Checks of array arguments."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from contactsense.errors import InputError

FloatArray: TypeAlias = NDArray[np.float64]


def vector(name: str, value: ArrayLike, size: int) -> FloatArray:
    """A fresh finite float64 vector of `size` entries, or `InputError` naming the argument."""
    try:
        array = np.array(value, dtype=np.float64)
    except (TypeError, ValueError, OverflowError) as error:
        raise InputError(f"{name} must be {size} numbers") from error
    if array.shape != (size,):
        raise InputError(f"{name} must have shape ({size},), not {array.shape}")
    if not np.isfinite(array).all():
        raise InputError(f"{name} must be finite, but entry {int(np.argmin(np.isfinite(array)))} is not")
    return array


def unit_vector(name: str, value: ArrayLike) -> FloatArray:
    """`value` (3,) scaled to length one."""
    array = vector(name, value, 3)
    length = float(np.linalg.norm(array))
    if length < 1e-12:
        raise InputError(f"{name} must not be zero")
    return array / length


def tangents(normal: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Two unit vectors (3,) across the unit vector `normal` (3,) and across each other."""
    first = np.cross(normal, np.eye(3)[int(np.argmin(np.abs(normal)))])
    first /= np.linalg.norm(first)
    return first, np.cross(normal, first)


def symmetric(upper: FloatArray) -> FloatArray:
    """The symmetric matrix (n, n) of its upper triangle, which is all that Pinocchio writes."""
    full: FloatArray = np.triu(upper) + np.triu(upper, 1).T
    return full


def positive(name: str, value: float) -> float:
    """A finite number above zero."""
    if not (np.isfinite(value) and value > 0):
        raise InputError(f"{name} must be a positive number, not {value}")
    return float(value)


def not_negative(name: str, value: float) -> float:
    """A finite number, zero or above."""
    if not (np.isfinite(value) and value >= 0):
        raise InputError(f"{name} must be zero or a positive number, not {value}")
    return float(value)


def whole(name: str, value: int) -> int:
    """A whole number, zero or above."""
    if isinstance(value, bool) or not isinstance(value, int | np.integer) or value < 0:
        raise InputError(f"{name} must be a whole number, zero or above, not {value!r}")
    return int(value)


def gains(name: str, value: ArrayLike, size: int) -> FloatArray:
    """One gain for all, or one for each of `size`; zero or above."""
    array = vector(name, np.broadcast_to(np.asarray(value, dtype=np.float64), (size,)), size)
    if (array < 0).any():
        raise InputError(f"{name} must not be negative")
    return array

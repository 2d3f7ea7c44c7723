"""Settings that are one number for all joints or one for each."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias

import numpy as np

from contactsense.errors import InputError

from ._arrays import FloatArray

PerJoint: TypeAlias = float | Sequence[float] | FloatArray


def kept(name: str, value: PerJoint, *, lowest: float = -np.inf) -> float | tuple[float, ...]:
    """`value` as plain numbers, which compare and hash.

    Raises:
        InputError: no finite number or (nv,) of them, or one below `lowest`.
    """
    try:
        array = np.array(value, dtype=np.float64)
    except (TypeError, ValueError):
        raise InputError(f"{name}: must be a number or one for each joint") from None
    if array.ndim > 1 or array.size == 0:
        raise InputError(f"{name}: must be a number or of shape (nv,), not {array.shape}")
    if not np.isfinite(array).all():
        raise InputError(f"{name}: must be finite")
    if (array < lowest).any():
        raise InputError(f"{name}: must be at least {lowest:g}, not {array.min():g}")
    return float(array) if array.ndim == 0 else tuple(array.tolist())


def spread(name: str, value: PerJoint, nv: int) -> FloatArray:
    """(nv,) a fresh array of what `kept` kept.

    Raises:
        InputError: `value` is of another number of joints.
    """
    array = np.array(value, dtype=np.float64)
    if array.ndim == 1 and array.size != nv:
        raise InputError(f"{name}: must be a number or of shape ({nv},), not ({array.size},)")
    return np.array(np.broadcast_to(array, (nv,)))

"""Torque for each unit of what a log has of the motors."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import InputError


def check_constants(
    given: ArrayLike | Mapping[str, float] | None, joints: Sequence[str]
) -> NDArray[np.float64] | None:
    """One constant a joint [Nm/A].

    Raises:
        InputError: a joint lacks one, or a number cannot be used.
    """
    if given is None:
        return None
    if isinstance(given, Mapping):
        unknown = [name for name in given if name not in joints]
        missing = [name for name in joints if name not in given]
        if unknown or missing:
            raise InputError(
                f"torque_constants: needs one for each of {', '.join(joints)}; "
                f"unknown: {', '.join(unknown) or 'none'}; missing: {', '.join(missing) or 'none'}"
            )
        given = [given[name] for name in joints]
    try:
        constants = np.broadcast_to(np.asarray(given, dtype=np.float64), (len(joints),)).copy()
    except (TypeError, ValueError, OverflowError):
        raise InputError(f"torque_constants: must be one number or {len(joints)} [Nm/A]") from None
    if not np.all(np.isfinite(constants)) or np.any(constants == 0.0):
        raise InputError("torque_constants: must be finite and not zero [Nm/A]")
    return constants

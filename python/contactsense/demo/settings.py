"""Observer gain and thresholds from the noise that the sensors are said to have."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError

FloatArray = NDArray[np.float64]

DT = 0.001  # control tick [s]
# [1/s] without and with noise: a half-sine of 40 ms loses 1 % and 5 % of its peak.
GAIN, GAIN_WITH_NOISE = 500.0, 250.0
# Standard deviations of the observed torque: a false alarm in a day or so at 1 kHz and seven joints.
DEVIATIONS = 6.0


@dataclass(frozen=True)
class Settings:
    """What the monitor is given."""

    observer_gain: float  # [1/s]
    torque_threshold: FloatArray  # (nv,) [N, Nm]
    wrench_threshold: FloatArray = field(default_factory=lambda: np.zeros((0, 6)))  # (sensors, 6) [N, Nm]


def choose_gain(wanted: float | None, exact: bool) -> float:
    """The observer gain [1/s] that is wanted, or that suits exact sensors or noisy ones.

    Raises:
        InputError: the wanted one is not positive.
    """
    gain = (GAIN if exact else GAIN_WITH_NOISE) if wanted is None else wanted
    if not (np.isfinite(gain) and gain > 0.0):
        raise InputError(f"gain: must be positive [1/s], not {gain}")
    return gain


def noise_passed(gain: float) -> float:
    """Deviation of the observer's output for white noise of deviation one on its torque.

    The observer is `r = a r + (1 - a) (n + n_before) / 2` in the noise `n`, with `a = exp(-gain dt)`.
    """
    a = float(np.exp(-gain * DT))
    return float(np.sqrt((1.0 - a) ** 2 * (0.5 + 0.5 * a) / (1.0 - a * a)))

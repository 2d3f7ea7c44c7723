"""Observer gain and thresholds from the noise that the torque sensors are said to have."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError

FloatArray = NDArray[np.float64]

# [1/s] without and with noise: a half-sine of 40 ms loses 1 % and 5 % of its peak.
GAIN, GAIN_WITH_NOISE = 500.0, 250.0
# [Nm] what the observer's lag leaves of a fast contact on the joints behind it.
FLOOR = 0.05
# Standard deviations of the observed torque: a false alarm in a day or so at 1 kHz and seven joints.
DEVIATIONS = 6.0


@dataclass(frozen=True)
class Noise:
    """Standard deviation of a measured torque: a share of the torque, and a part that is always there."""

    percent: float = 0.0
    newton_metres: float = 0.0

    def __post_init__(self) -> None:
        for name, value in (("percent", self.percent), ("newton_metres", self.newton_metres)):
            if not (np.isfinite(value) and value >= 0.0):
                raise InputError(f"noise: {name} must be zero or positive, not {value}")

    @property
    def none(self) -> bool:
        return self.percent == 0.0 and self.newton_metres == 0.0

    def deviation(self, torque: FloatArray) -> FloatArray:
        """Standard deviation [Nm] at `torque` [Nm], same shape."""
        return np.hypot(0.01 * self.percent * torque, self.newton_metres)


@dataclass(frozen=True)
class Settings:
    """What the monitor is given."""

    observer_gain: float  # [1/s]
    torque_threshold: FloatArray  # (nv,) [Nm]


def choose(noise: Noise, largest_torque: FloatArray, dt: float, gain: float | None = None) -> Settings:
    """Thresholds `max(FLOOR, DEVIATIONS s)`, `s` the deviation of the observed torque.

    Noise in percent counts at the largest torque of the motion.

    Args:
        largest_torque: (nv,) that the planned motion needs [Nm].
        dt: control tick [s].
        gain: in place of the chosen one [1/s].
    """
    if gain is None:
        gain = GAIN if noise.none else GAIN_WITH_NOISE
    if not (np.isfinite(gain) and gain > 0.0):
        raise InputError(f"gain: must be positive [1/s], not {gain}")
    observed = noise_passed(gain, dt) * noise.deviation(largest_torque)
    return Settings(gain, np.maximum(FLOOR, DEVIATIONS * observed))


def noise_passed(gain: float, dt: float) -> float:
    """Deviation of the observer's output for white noise of deviation one on its torque.

    The observer is `r = a r + (1 - a) (n + n_before) / 2` in the noise `n`, with `a = exp(-gain dt)`.
    """
    a = float(np.exp(-gain * dt))
    return float(np.sqrt((1.0 - a) ** 2 * (0.5 + 0.5 * a) / (1.0 - a * a)))

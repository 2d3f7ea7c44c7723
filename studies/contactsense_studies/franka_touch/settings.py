"""What the monitor was set to, and where that comes from."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from .logs import FloatArray

# Momentum observer on measured torques; the external torque that the vendor computes; that, calibrated.
Source = Literal["measured", "vendor", "calibrated"]

# The marks farthest from the base and nearest to it. Settings come from these alone; the rest is held out.
TUNING_FILES = ("a4", "f2")
# The vendor's torque goes through no observer: the monitor's default [1/s].
UNUSED_GAIN = 50.0


@dataclass(frozen=True)
class Settings:
    """Settings for all files and touches alike."""

    source: Source
    noise: tuple[float, ...]  # (7,) standard deviation of the external torque of an untouched arm [Nm]
    observer_gain: float  # [1/s]
    detection_factor: float  # threshold of detection / noise
    isolation_factor: float  # threshold of isolation, on a mean over a part of a touch / noise
    hold_time: float  # [s]
    bias_time_constant: float  # [s]

    @property
    def detection_threshold(self) -> FloatArray:
        """`(7,)` [Nm]."""
        return self.detection_factor * np.array(self.noise)

    @property
    def isolation_threshold(self) -> FloatArray:
        """`(7,)` [Nm]."""
        return self.isolation_factor * np.array(self.noise)


# As `choose_settings` finds them on the tuning files.
MEASURED = Settings(
    source="measured",
    noise=(0.059, 0.056, 0.044, 0.032, 0.0028, 0.0056, 0.013),
    observer_gain=30.0,
    detection_factor=15.0,
    isolation_factor=2.5,
    hold_time=0.02,
    bias_time_constant=1.0,
)
VENDOR = Settings(
    source="vendor",
    noise=(0.0094, 0.011, 0.007, 0.008, 0.00086, 0.0013, 0.0016),
    observer_gain=UNUSED_GAIN,
    detection_factor=60.0,
    isolation_factor=4.0,
    hold_time=0.02,
    bias_time_constant=0.5,
)
# Nothing is chosen: defaults, and the thresholds of each log's calibration in place of the noise.
CALIBRATED = Settings(
    source="calibrated",
    noise=(0.0,) * 7,
    observer_gain=UNUSED_GAIN,
    detection_factor=1.0,
    isolation_factor=1.0,
    hold_time=0.02,
    bias_time_constant=3.0,
)

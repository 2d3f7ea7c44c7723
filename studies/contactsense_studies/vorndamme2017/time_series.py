"""A short hit over time, and what an isolation says of it (VI-D, Fig. 10)."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from contactsense.sim._arrays import FloatArray

from .instruments import Method
from .scenes import Scene

DURATION = 0.02  # [s]
STEP = 0.001  # [s]
GAIN = 500.0  # [1/s]
SHIFTS = np.arange(0.0, 0.01, 2e-5)  # [s]


@dataclass(frozen=True)
class Signal:
    """What an isolation says over time; NaN where it locates nothing."""

    force: FloatArray  # (n, 3) [N]
    point_error: FloatArray  # (n,) [m]

    def right(self, tolerance: float) -> NDArray[np.bool_]:
        """Whether the point is right, per sample."""
        right: NDArray[np.bool_] = np.nan_to_num(self.point_error, nan=np.inf) <= tolerance
        return right


@dataclass(frozen=True)
class Series:
    """One hit."""

    scene: Scene  # its force: at the peak
    time: FloatArray  # (n,) [s]
    force: FloatArray  # (n, 3) [N]
    signals: dict[Method, Signal]
    tolerance: float  # [m], a point counts as right

    def delay(self, method: Method) -> float:
        """Shift [s] of the half sine that fits the force found best; NaN if nothing is found."""
        found = np.nan_to_num(self.signals[method].force) @ self.direction
        if not found.any():
            return np.nan
        shifted = half_sine(self.time[None] - SHIFTS[:, None])
        fit = shifted @ found / np.linalg.norm(shifted, axis=1)
        return float(SHIFTS[np.argmax(fit)])

    def peak_delay(self, method: Method) -> float:
        """From the true peak to the greatest force found [s]."""
        found = np.nan_to_num(self.signals[method].force) @ self.direction
        return float(self.time[np.argmax(found)] - DURATION / 2) if found.any() else np.nan

    def first_right(self, method: Method) -> int | None:
        """Number of the first sample under force (from 1) whose point is right."""
        right = self.time[self.signals[method].right(self.tolerance) & (self.time > 0.0)]
        return round(right[0] / STEP) if len(right) else None

    def right_share(self, method: Method) -> float:
        """Share of samples with the right point, of those under force from the second on."""
        under = (self.time > 1.5 * STEP) & (self.time < DURATION - 0.5 * STEP)
        return float(self.signals[method].right(self.tolerance)[under].mean())

    def point_error(self, method: Method) -> float:
        """Worst distance of a located point from the truth [m]; NaN if none is located."""
        errors = self.signals[method].point_error
        return float(np.nanmax(errors)) if np.isfinite(errors).any() else np.nan

    @property
    def amplitude(self) -> float:
        """Greatest force [N]."""
        return float(np.linalg.norm(self.scene.touches[0].force))

    @cached_property
    def direction(self) -> FloatArray:
        """Of the force, a unit vector `(3,)`."""
        force = self.scene.touches[0].force
        return force / np.linalg.norm(force)


def half_sine(time: FloatArray) -> FloatArray:
    """Unit force over time [s]: one half wave from 0 to `DURATION`."""
    inside = (time > 0.0) & (time < DURATION)
    return np.where(inside, np.sin(np.pi * time / DURATION), 0.0)


def filtered_half_sine(time: FloatArray, gain: float = GAIN) -> FloatArray:
    """What the observer makes of `half_sine`: the exact answer of its first-order dynamics (6)."""
    rate = np.pi / DURATION

    def during(t: FloatArray) -> FloatArray:
        wave = gain * np.sin(rate * t) - rate * np.cos(rate * t) + rate * np.exp(-gain * t)
        answer: FloatArray = gain * wave / (gain**2 + rate**2)
        return answer

    end = during(np.array([DURATION]))[0]
    after = end * np.exp(-gain * np.clip(time - DURATION, 0.0, None))
    return np.where(time < DURATION, during(np.clip(time, 0.0, DURATION)), after)

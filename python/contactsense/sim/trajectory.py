"""Fast, smooth joint motion that excites the whole dynamics."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from contactsense.errors import InputError

from ._arrays import FloatArray, positive, vector

# Sines a joint, and the band of their frequencies [Hz].
_SINES = 3
_BAND = (0.1, 0.6)
# Share of the joint's range that the motion may fill.
_RANGE = 0.9


@dataclass(frozen=True)
class TrajectoryPoint:
    """Where the motion is at one time: position [rad or m], velocity and acceleration, each (n,)."""

    q: FloatArray
    v: FloatArray
    a: FloatArray


class SineTrajectory:
    """Each joint a sum of sines about a centre, faded in so that it starts at rest without a jerk in torque.

    `q(t) = centre + s(t) sum_k A_k sin(w_k t + phi_k)`, with `s` rising from 0 to 1 by a polynomial whose
    first and second derivatives vanish at both ends. Each joint comes to its own peak speed within `horizon`,
    unless its limits are in the way.

    Args:
        lower, upper: (n,) position limits [rad or m]; where infinite, one turn about zero.
        peak_speed: of the fastest joints [rad/s or m/s].
        speed_limits: (n,) a lower peak for some joints; none by default.
        centre: (n,) middle of the motion; by default drawn from the middle third of the range.
        ramp: time of the fading in [s].
        horizon: time over which the peak is taken and limits hold [s].
        seed: same seed, same motion.
    """

    def __init__(
        self,
        lower: ArrayLike,
        upper: ArrayLike,
        *,
        peak_speed: float = 1.0,
        speed_limits: ArrayLike | None = None,
        centre: ArrayLike | None = None,
        ramp: float = 2.0,
        horizon: float = 60.0,
        seed: int = 0,
    ) -> None:
        low, high = np.array(lower, dtype=np.float64), np.array(upper, dtype=np.float64)
        low, high = np.where(np.isfinite(low), low, -np.pi), np.where(np.isfinite(high), high, np.pi)
        if low.ndim != 1 or low.shape != high.shape or not (low < high).all():
            raise InputError("lower and upper must be of one shape (n,), with lower < upper throughout")
        n = low.size
        generator = np.random.default_rng(seed)
        middle = 0.5 * (low + high) + (high - low) * generator.uniform(-1 / 6, 1 / 6, n)
        self.centre = middle if centre is None else vector("centre", centre, n)
        self.ramp = positive("ramp", ramp)
        self.horizon = positive("horizon", horizon)
        speed = np.full(n, positive("peak_speed", peak_speed))
        if speed_limits is not None:
            speed = np.minimum(speed, np.array(speed_limits, dtype=np.float64))
        reach = _RANGE * np.minimum(self.centre - low, high - self.centre)
        if not (reach > 0).all() or not (speed > 0).all():
            raise InputError("centre must lie between the limits, and speed_limits be positive")
        self._frequency = 2 * np.pi * generator.uniform(*_BAND, (n, _SINES))
        self._phase = generator.uniform(0, 2 * np.pi, (n, _SINES))
        self._amplitude = generator.uniform(0.3, 1.0, (n, _SINES))
        self._scale(reach, speed)

    @classmethod
    def for_model(
        cls,
        model: pin.Model,
        *,
        peak_speed: float = 1.0,
        centre: ArrayLike | None = None,
        seed: int = 0,
        ramp: float = 2.0,
        horizon: float = 60.0,
    ) -> SineTrajectory:
        """Within the position and speed limits of a Pinocchio model whose joints have one coordinate each.

        Raises:
            InputError: a free base or continuous joints; give `lower` and `upper` of the others instead.
        """
        if model.nq != model.nv:
            raise InputError("model: a free base or continuous joints have no limits to move within")
        speeds = np.where(model.velocityLimit > 0, model.velocityLimit, np.inf)
        return cls(
            model.lowerPositionLimit,
            model.upperPositionLimit,
            peak_speed=peak_speed,
            speed_limits=speeds,
            centre=centre,
            ramp=ramp,
            horizon=horizon,
            seed=seed,
        )

    def at(self, time: float) -> TrajectoryPoint:
        """Position, velocity and acceleration at `time` [s], analytically; at rest before zero."""
        q, v, a = self._evaluate(np.array([max(time, 0.0)]))
        return TrajectoryPoint(q[0], v[0], a[0])

    def _evaluate(self, time: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Each (len(time), n)."""
        s, ds, dds = (column[:, None] for column in _fade(time, self.ramp))
        angle = time[:, None, None] * self._frequency + self._phase
        sine, cosine = self._amplitude * np.sin(angle), self._amplitude * np.cos(angle)
        f = sine.sum(axis=2)
        df = (cosine * self._frequency).sum(axis=2)
        ddf = -(sine * self._frequency**2).sum(axis=2)
        return self.centre + s * f, ds * f + s * df, dds * f + 2 * ds * df + s * ddf

    def _scale(self, reach: FloatArray, speed: FloatArray) -> None:
        # Motion is linear in the amplitudes: measure once at a rate far above the band, then scale.
        q, v, _ = self._evaluate(np.arange(0.0, self.horizon, 0.005))
        by_reach = reach / np.abs(q - self.centre).max(axis=0)
        by_speed = speed / np.abs(v).max(axis=0)
        self._amplitude *= np.minimum(by_reach, by_speed)[:, None]


def _fade(time: FloatArray, ramp: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Quintic rise from 0 to 1 over `ramp`, with first and second derivative."""
    x = np.clip(time / ramp, 0.0, 1.0)
    value = x**3 * (10 + x * (-15 + 6 * x))
    first = 30 * x**2 * (1 - x) ** 2 / ramp
    second = 60 * x * (1 - x) * (1 - 2 * x) / ramp**2
    return value, first, second

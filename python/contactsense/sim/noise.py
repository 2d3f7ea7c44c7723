"""Noise of what joints and force/torque sensors measure."""

from __future__ import annotations

import numpy as np

from ._arrays import FloatArray, not_negative


class TorqueNoise:
    """Gaussian error of measured torques, new at every sample, repeatable by seed.

    Args:
        percent: standard deviation in percent of the present torque of the joint.
        newton_metres: standard deviation that is there at any torque [Nm; N for a sliding joint].
        seed: of the generator.
    """

    def __init__(self, *, percent: float = 0.0, newton_metres: float = 0.0, seed: int = 0) -> None:
        self.percent = not_negative("percent", percent)
        self.newton_metres = not_negative("newton_metres", newton_metres)
        self._generator = np.random.default_rng(seed)

    @property
    def none(self) -> bool:
        """Whether torques are measured without an error."""
        return self.percent == 0.0 and self.newton_metres == 0.0

    def deviation(self, tau: FloatArray) -> FloatArray:
        """Standard deviation [Nm] at `tau` [Nm], same shape."""
        return np.hypot(0.01 * self.percent * tau, self.newton_metres)

    def measure(self, tau: FloatArray) -> FloatArray:
        """`tau` (n,) as a sensor would read it."""
        relative, absolute = self._generator.standard_normal((2, tau.size))
        measured: FloatArray = tau * (1.0 + 0.01 * self.percent * relative) + self.newton_metres * absolute
        return measured


class WrenchNoise:
    """Gaussian error of measured wrenches, new at every sample, repeatable by seed.

    Args:
        newtons: standard deviation of each force component [N].
        newton_metres: standard deviation of each moment component [Nm].
        seed: of the generator.
    """

    def __init__(self, *, newtons: float = 0.0, newton_metres: float = 0.0, seed: int = 0) -> None:
        self.newtons = not_negative("newtons", newtons)
        self.newton_metres = not_negative("newton_metres", newton_metres)
        self._generator = np.random.default_rng(seed)

    @property
    def none(self) -> bool:
        """Whether wrenches are measured without an error."""
        return self.newtons == 0.0 and self.newton_metres == 0.0

    @property
    def deviation(self) -> FloatArray:
        """(6,) standard deviation of a wrench [N, Nm]."""
        return np.repeat(np.array([self.newtons, self.newton_metres]), 3)

    def measure(self, wrenches: FloatArray) -> FloatArray:
        """`wrenches` (n, 6) as sensors would read them."""
        measured: FloatArray = wrenches + self.deviation * self._generator.standard_normal(wrenches.shape)
        return measured

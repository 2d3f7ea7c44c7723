"""Noise on torques and wrenches."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contactsense.sim._arrays import FloatArray

LESS, MORE = 1.0, 3.0  # times the relative noise of the options: the first two cases
# What good sensors err by beside a share of what they measure.
FLOOR_TORQUE = 0.01  # [Nm, N], of joints and of the base
FLOOR_FORCE, FLOOR_MOMENT = 0.05, 0.005  # [N], [Nm], of force/torque sensors
# What usual sensors err by at any load.
ABSOLUTE_TORQUE = 0.1  # [Nm, N]
ABSOLUTE_FORCE, ABSOLUTE_MOMENT = 0.5, 0.05  # [N], [Nm]


@dataclass(frozen=True)
class Noise:
    """Standard deviations of what is added to every component."""

    relative: float = 0.0  # share of the component
    torque: float = 0.0  # [Nm, N], of joints and of the base
    force: float = 0.0  # [N], of force/torque sensors
    moment: float = 0.0  # [Nm]

    def on_torques(self, tau: FloatArray) -> FloatArray:
        """Standard deviations for torques of this size."""
        deviations: FloatArray = np.hypot(self.relative * tau, self.torque)
        return deviations

    def on_wrenches(self, wrenches: FloatArray) -> FloatArray:
        """Standard deviations for wrenches of this size `(..., 6)`."""
        floor = np.repeat([self.force, self.moment], 3)
        deviations: FloatArray = np.hypot(self.relative * wrenches, floor)
        return deviations


NONE = Noise()


def noise_cases(relative: float) -> tuple[Noise, ...]:
    """Relative noise with a small floor, three times of it, and absolute noise."""
    floors = FLOOR_TORQUE, FLOOR_FORCE, FLOOR_MOMENT
    return (
        Noise(LESS * relative, *floors),
        Noise(MORE * relative, *floors),
        Noise(0.0, ABSOLUTE_TORQUE, ABSOLUTE_FORCE, ABSOLUTE_MOMENT),
    )

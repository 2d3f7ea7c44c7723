"""Atlas's sensors; observer gain and thresholds from what torque and force/torque sensors are said to err."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ... import ForceTorqueSensor, Robot
from ...errors import InputError
from ...sim.atlas import FEET
from ..settings import DEVIATIONS, GAIN, GAIN_WITH_NOISE, FloatArray, Noise, noise_passed
from .plan import FORCE_RANGE

# Hands, feet, before the first joints of arms and legs, behind those of the back; named after their links.
SENSORS = tuple(
    ForceTorqueSensor(link, link)
    for link in (
        *("l_hand", "r_hand", "l_foot", "r_foot"),
        *("l_clav", "r_clav", "l_uglut", "r_uglut", "utorso"),
    )
)
# The next sensors behind a sensor, whose wrenches are taken out of its own.
BEHIND = {
    "l_clav": ("l_hand",),
    "r_clav": ("r_hand",),
    "l_uglut": ("l_foot",),
    "r_uglut": ("r_foot",),
    "utorso": ("l_clav", "r_clav"),
}
# What fast pushes and the edges of feet that come and go within a tick leave, without noise: of forces [N],
# and of moments [Nm] at the base, of joints, and at sensors.
FORCE_FLOOR, MOMENT_FLOOR, JOINT_FLOOR, SENSOR_FLOOR = 3.0, 3.0, 1.0, 0.5
# The ground answers a push at the chest by moments in each leg with this lever [m].
_LEG_LEVER = 0.65


@dataclass(frozen=True)
class SensorNoise:
    """Standard deviations of a measured wrench's components."""

    newtons: float = 0.0
    newton_metres: float = 0.0

    def __post_init__(self) -> None:
        for name, value in (("newtons", self.newtons), ("newton_metres", self.newton_metres)):
            if not (np.isfinite(value) and value >= 0.0):
                raise InputError(f"sensor_noise: {name} must be zero or positive, not {value}")

    @property
    def none(self) -> bool:
        return self.newtons == 0.0 and self.newton_metres == 0.0

    @property
    def deviation(self) -> FloatArray:
        """(6,) [N, Nm]"""
        return np.repeat(np.array([self.newtons, self.newton_metres], dtype=np.float64), 3)


@dataclass(frozen=True)
class StandingSettings:
    """What the monitor is given."""

    observer_gain: float  # [1/s]
    torque_threshold: FloatArray  # (nv,) [N, Nm]
    wrench_threshold: FloatArray  # (sensors, 6) [N, Nm]


def choose(
    robot: Robot,
    q: FloatArray,
    torque: FloatArray,
    noise: Noise,
    sensor_noise: SensorNoise,
    dt: float,
    gain: float | None = None,
) -> StandingSettings:
    """Thresholds `max(floor, DEVIATIONS s)`, `s` the deviation of the observed torque or wrench.

    Sensors take out the torques of the ground on the feet; their noise thus comes to all joints before them.

    Args:
        q: (nq,) posture.
        torque: (nv - 6,) of the motors in it [Nm].
        dt: control tick [s].
        gain: in place of the chosen one [1/s].
    """
    if gain is None:
        gain = GAIN if noise.none and sensor_noise.none else GAIN_WITH_NOISE
    if not (np.isfinite(gain) and gain > 0.0):
        raise InputError(f"gain: must be positive [1/s], not {gain}")
    feet = np.vstack([robot.jacobian(q, foot) for foot in FEET])
    variance = (feet**2).T @ np.tile(sensor_noise.deviation**2, len(FEET))
    variance[6:] += noise.deviation(np.abs(torque) + _push_torque(feet)) ** 2
    floor = np.concatenate([np.repeat([FORCE_FLOOR, MOMENT_FLOOR], 3), np.full(torque.size, JOINT_FLOOR)])
    scale = DEVIATIONS * noise_passed(gain, dt)
    return StandingSettings(
        gain,
        np.maximum(floor, scale * np.sqrt(variance)),
        np.maximum(
            np.repeat([FORCE_FLOOR, SENSOR_FLOOR], 3),
            # Without a low-pass a wrench is the mean of two readings.
            (scale if gain * dt < 0.5 else DEVIATIONS * np.sqrt(0.5))
            * np.sqrt(_wrench_variance(robot, q, sensor_noise)),
        ),
    )


def _wrench_variance(robot: Robot, q: FloatArray, noise: SensorNoise) -> FloatArray:
    """(sensors, 6) of a wrench less those of the next sensors behind, moved to the sensor's origin."""
    force, moment = noise.newtons**2, noise.newton_metres**2
    variance = np.tile(noise.deviation**2, (len(SENSORS), 1))
    for row, sensor in zip(variance, SENSORS, strict=True):
        for other in BEHIND.get(sensor.name, ()):
            arm = robot.link_pose(q, other)[:3, 3] - robot.link_pose(q, sensor.link)[:3, 3]
            row += np.concatenate([np.full(3, force), moment + force * (arm @ arm - arm**2)])
    return variance


def _push_torque(feet: FloatArray) -> FloatArray:
    """(nv - 6,) what a push may add to the motors' torque, by which noise in percent counts [Nm]."""
    in_leg = feet[:, 6:].any(axis=0)
    return np.where(in_leg, FORCE_RANGE[1] * _LEG_LEVER, 0.0)

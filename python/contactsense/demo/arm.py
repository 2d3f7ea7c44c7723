"""An arm that is hit while it moves fast: its motion, the hits, both drawn at random, and its settings."""

from __future__ import annotations

import numpy as np

from .. import ContactMonitor, Robot
from ..errors import InputError
from ..sim import ComputedTorqueController, Push, SimulatedRobot, SineTrajectory, TorqueNoise, WrenchNoise
from .loop import Setup, free_push
from .settings import DEVIATIONS, DT, FloatArray, Settings, choose_gain, noise_passed

NAME = "iiwa14"
END = 8.0  # [s]
PEAK_SPEED = 1.9  # [rad/s] of the joints whose limits allow it
# Links 7 and 6 have six joints or more before them: a force's line of action follows. Link 4 has four.
LINKS = ("iiwa_link_7", "iiwa_link_4", "iiwa_link_6")
ROUNDS = 3
_FIRST, _SPACING, _LATER = 1.6, 0.7, 0.05  # [s]; a hit may be later than its turn by up to the last
# Ranges that hits are drawn from.
FORCE_RANGE = (30.0, 80.0)  # [N]
_DURATION = (0.02, 0.06)  # [s]
# The middle of the motion: hand before the arm, at table height [rad], and how far from it a seed may be.
_POSTURE = (0.0, 0.5, 0.0, -1.4, 0.0, 0.9, 0.0)
_SPREAD = 0.3
# A stiff position control, critically damped.
_KP, _KD = 2500.0, 100.0
# [Nm] what the observer's lag leaves of a fast contact on the joints behind it.
FLOOR = 0.05


def prepare(seed: int, noise: TorqueNoise, sensor_noise: WrenchNoise, gain: float | None) -> Setup:
    """The arm at the start of its motion.

    Raises:
        InputError: there is noise of sensors that it does not have, or the gain is not positive.
    """
    if not sensor_noise.none:
        raise InputError(f"sensor_noise: '{NAME}' has no force/torque sensors; leave it at zero")
    robot = Robot.named(NAME)
    motion = plan_motion(robot, seed)
    speed, largest_torque = motion_figures(robot, motion)
    settings = choose(noise, largest_torque, gain)
    arm = SimulatedRobot(robot.model, dt=DT, noise=noise)
    arm.reset(motion.at(0.0).q)
    controller = ComputedTorqueController(robot.model, kp=_KP, kd=_KD)
    return Setup(
        name=NAME,
        robot=robot,
        simulated=arm,
        monitor=ContactMonitor(
            robot, dt=DT, observer_gain=settings.observer_gain, torque_threshold=settings.torque_threshold
        ),
        settings=settings,
        pushes=plan_hits(robot, motion, seed),
        end=END,
        control=lambda time: controller.torque(arm.q, arm.v, motion.at(time)),
        planned=lambda time: motion.at(time).q,
        speed=speed,
    )


def choose(noise: TorqueNoise, largest_torque: FloatArray, gain: float | None = None) -> Settings:
    """Thresholds `max(FLOOR, DEVIATIONS s)`, `s` the deviation of the observed torque.

    Noise in percent counts at the largest torque of the motion.

    Args:
        noise: of the measured torques.
        largest_torque: (nv,) that the planned motion needs [Nm].
        gain: in place of the chosen one [1/s].
    """
    gain = choose_gain(gain, noise.none)
    observed = noise_passed(gain) * noise.deviation(largest_torque)
    return Settings(gain, np.maximum(FLOOR, DEVIATIONS * observed))


def plan_motion(robot: Robot, seed: int) -> SineTrajectory:
    """A motion about the working posture, at rest at first, fast within a second."""
    generator, model = np.random.default_rng([seed, 0]), robot.model
    return SineTrajectory.for_model(
        model,
        peak_speed=PEAK_SPEED,
        centre=np.array(_POSTURE) + generator.uniform(-_SPREAD, _SPREAD, model.nv),
        ramp=1.0,
        horizon=END,
        seed=seed,
    )


def motion_figures(robot: Robot, motion: SineTrajectory) -> tuple[float, FloatArray]:
    """Fastest joint [rad/s], and (nv,) largest torques [Nm], of the planned motion."""
    points = [motion.at(float(time)) for time in np.arange(0.0, END, 0.01)]
    speed = max(float(np.abs(point.v).max()) for point in points)
    torques = [np.abs(robot.inverse_dynamics(point.q, point.v, point.a)) for point in points]
    return speed, np.max(torques, axis=0)


def plan_hits(robot: Robot, motion: SineTrajectory, seed: int) -> tuple[Push, ...]:
    """Free pushes on `LINKS` in turn, half-sines."""
    generator = np.random.default_rng([seed, 1])
    hits = []
    for number, link in enumerate(LINKS * ROUNDS):
        duration, force = generator.uniform(*_DURATION), generator.uniform(*FORCE_RANGE)
        start = _FIRST + _SPACING * number + generator.uniform(0.0, _LATER)
        q = motion.at(start + 0.5 * duration).q
        hits.append(
            free_push(robot, q, link, start=start, duration=duration, force=force, generator=generator)
        )
    return tuple(hits)

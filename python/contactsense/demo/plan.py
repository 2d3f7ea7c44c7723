"""The motion and the hits, drawn at random."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from .. import Robot
from ..errors import ContactSenseError
from ..sim import Push, SineTrajectory, random_push
from ..sim.sampling import blocked
from .settings import FloatArray

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
_TRIES = 1000


def plan_motion(model: pin.Model, seed: int) -> SineTrajectory:
    """A motion about the working posture, at rest at first, fast within a second."""
    generator = np.random.default_rng([seed, 0])
    return SineTrajectory(
        model.lowerPositionLimit,
        model.upperPositionLimit,
        peak_speed=PEAK_SPEED,
        speed_limits=model.velocityLimit,
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
    """Hits on `LINKS` in turn: half-sines at random points, random directions within 30 degrees of inward.

    What hits comes along a straight line: points whose line of force is barred by the arm itself are redrawn.
    """
    generator = np.random.default_rng([seed, 1])
    return tuple(
        _free_hit(robot, motion, link, _FIRST + _SPACING * number, generator)
        for number, link in enumerate(LINKS * ROUNDS)
    )


def _free_hit(
    robot: Robot, motion: SineTrajectory, link: str, start: float, generator: np.random.Generator
) -> Push:
    duration, force = generator.uniform(*_DURATION), generator.uniform(*FORCE_RANGE)
    start += generator.uniform(0.0, _LATER)
    middle = start + 0.5 * duration
    q = motion.at(middle).q
    pose = robot.link_pose(q, link)
    for _ in range(_TRIES):
        seed = int(generator.integers(2**31))
        surface = robot.surface(link)
        hit = random_push(link, surface, peak_force=force, start=start, duration=duration, seed=seed)
        point, push = hit.force_at(middle, pose)
        if not blocked(robot, q, link, point[None], push[None] / np.linalg.norm(push))[0]:
            return hit
    raise ContactSenseError(
        f"seed: '{link}' cannot be hit at {start:.1f} s along a free line; try another seed"
    )

"""Moves from pose to pose, with rests between them."""

from __future__ import annotations

from typing import Literal

import numpy as np

from contactsense import Robot
from contactsense.errors import InputError

from ._arrays import FloatArray, positive, whole
from .clearance import Clearance
from .joint_motion import JointAngles, JointMotion
from .move_profile import profile_of

# Arms reach their top speed in about this time [s].
_SPEED_UP = 0.4
# A move of a slow arm goes less far, so that there are several in a scene [s].
_LONGEST_MOVE = 4.0
# Where a description gives no limit of the speed [rad/s; m/s].
_SPEED = 2.0
# Share of the range that is kept free at either end, and the longest way of a joint in a move [rad; m]: arms
# reach from one place to the next, not across all of their range.
_MARGIN, _LONGEST = 0.05, 0.5 * np.pi
# Targets tried for a move, each nearer than the one before; and poses checked along one [rad; m apart].
_TRIES, _SPACING = 30, 0.15


def random_moves(
    robot: Robot,
    seconds: float,
    *,
    dt: float = 1e-3,
    speed: tuple[float, float] = (0.15, 0.6),
    rest: tuple[float, float] = (0.2, 3.0),
    floor: float | None = 0.0,
    profile: Literal["quintic", "trapezoidal"] = "quintic",
    seed: int = 0,
) -> JointMotion:
    """Point-to-point moves, all joints in step, and rests between them.

    Poses are within the position limits; the arm touches neither itself nor the floor, as far as convex hulls
    at poses along the way tell.

    Args:
        robot: with a fixed base.
        seconds: in all [s].
        dt: between rows [s].
        speed: of a move, as a share of the velocity limits; uniform between the two.
        rest: after a move [s]; uniform between the two.
        floor: height of the ground [m]; None: there is none.
        profile: of the speed over a move. "quintic": smooth, without acceleration at either end.
            "trapezoidal": constant acceleration, constant speed, constant deceleration, a third of the time
            each, as many industrial controllers plan; the acceleration jumps four times a move.
        seed: same seed, same motion.

    Raises:
        InputError: names the argument; also if no pose is free.
    """
    positive("seconds", seconds)
    positive("dt", dt)
    whole("seed", seed)
    ordered("speed", speed, 1.0)
    ordered("rest", rest, np.inf, zero=True)
    shape = profile_of(profile)
    if seconds < 2.0 * dt:
        raise InputError(f"seconds: must be two ticks or more, not {seconds}")
    rng = np.random.default_rng([seed, 2])
    angles_of = JointAngles(robot.model)
    clearance = Clearance(robot, floor)
    low, high = _range(robot, angles_of)
    limits = np.array(robot.model.velocityLimit)
    limits = np.where(np.isfinite(limits) & (limits > 0.0), limits, _SPEED)
    time = dt * np.arange(round(seconds / dt) + 1)
    angles, v, a = (np.empty((len(time), robot.nv)) for _ in range(3))
    here = _first_pose(rng, angles_of, clearance, low, high)
    row = 0
    while row < len(time):
        way = _way(rng, angles_of, clearance, here, low, high)
        share = rng.uniform(*speed)
        at_full_speed = np.abs(way) / (share * limits)
        way *= min(1.0, _LONGEST_MOVE / max(shape.peak_speed * float(at_full_speed.max()), dt))
        at_full_speed = np.abs(way) / (share * limits)
        duration = max(
            shape.peak_speed * float(at_full_speed.max()),
            float(np.sqrt(shape.peak_acceleration * _SPEED_UP * at_full_speed.max())),
        )
        # A move and the rest after it; a way of zero is a rest as well.
        rows = slice(row, row + max(2, round((duration + rng.uniform(*rest)) / dt)))
        x = np.clip((time[rows] - time[row]) / max(duration, dt), 0.0, 1.0)[:, None]
        angles[rows] = here + way * shape.position(x)
        v[rows] = way * shape.speed(x) / max(duration, dt)
        a[rows] = way * shape.acceleration(x) / max(duration, dt) ** 2
        here = here + way
        row = rows.stop
    return JointMotion(time, angles_of.write(angles), v, a)


def _range(robot: Robot, angles_of: JointAngles) -> tuple[FloatArray, FloatArray]:
    """(nv,) each: limits less a margin, infinite where a joint turns without limit."""
    limits = np.full((robot.nv, 2), (-np.inf, np.inf))
    for joint in angles_of.joints:
        if not joint.unbounded:
            limits[joint.v] = robot.position_limits[joint.q]
    low, high = limits[:, 0], limits[:, 1]
    bounded = np.isfinite(high - low)
    margin = np.where(bounded, _MARGIN * (np.where(bounded, high, 0.0) - np.where(bounded, low, 0.0)), 0.0)
    return low + margin, high - margin


def _first_pose(
    rng: np.random.Generator, angles_of: JointAngles, clearance: Clearance, low: FloatArray, high: FloatArray
) -> FloatArray:
    for _ in range(100 * _TRIES):
        # Joints that turn further than once begin within their first turn.
        pose = rng.uniform(
            np.maximum(low, np.minimum(-np.pi, high - np.pi)),
            np.minimum(high, np.maximum(np.pi, low + np.pi)),
        )
        if clearance.free(angles_of.write(pose[None])):
            return pose
    raise InputError("robot: touches itself or the floor in every pose that was tried; see `floor`")


def _way(
    rng: np.random.Generator,
    angles_of: JointAngles,
    clearance: Clearance,
    here: FloatArray,
    low: FloatArray,
    high: FloatArray,
) -> FloatArray:
    """(nv,) to the next pose; zero where none is found that is free all the way."""
    for attempt in range(_TRIES):
        target = rng.uniform(np.maximum(low, here - _LONGEST), np.minimum(high, here + _LONGEST))
        way: FloatArray = (target - here) * (1.0 - attempt / _TRIES)
        steps = 1 + int(np.abs(way).max() / _SPACING)
        along = here + np.linspace(1.0 / steps, 1.0, steps)[:, None] * way
        if clearance.free(angles_of.write(along)):
            return way
    return np.zeros_like(here)


def ordered(name: str, value: tuple[float, float], highest: float, *, zero: bool = False) -> None:
    """Refuses what is no range of (positive) numbers."""
    low, high = value
    if not ((low >= 0.0 if zero else low > 0.0) and low <= high and high <= highest and np.isfinite(high)):
        kind = "numbers" if zero else "positive numbers"
        most = "" if highest == np.inf else f" up to {highest:g}"
        raise InputError(f"{name}: must be two {kind}{most}, the lower first, not {value}")

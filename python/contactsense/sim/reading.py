"""What an imperfect arm reports of what its joints do."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from contactsense import Robot

from ._arrays import FloatArray
from .encoder import delayed, differenced, low_pass, quantised
from .hysteresis import with_hysteresis
from .imperfect_arm import ImperfectArm
from .joint_motion import JointAngles, JointMotion
from .joint_size import rated_torque

# Time stamps stay in order, whatever the jitter [ticks].
_LARGEST_JITTER = 0.4


def torque_reading(
    robot: Robot, arm: ImperfectArm, time: FloatArray, torque: FloatArray, rng: np.random.Generator
) -> FloatArray:
    """(n, nv) what is measured of `torque` (n, nv) [Nm]."""
    nv = robot.nv
    share = arm.per_joint("hysteresis", nv)
    through_gear = with_hysteresis(torque, share, rated_torque(robot)) if share.any() else torque
    late = delayed(time, through_gear, arm.per_joint("torque_delay", nv))
    noise = arm.per_joint("torque_noise", nv) * rng.standard_normal(torque.shape)
    reading: FloatArray = arm.per_joint("torque_scale", nv) * late + arm.per_joint("torque_bias", nv) + noise
    return reading


def motion_reading(
    arm: ImperfectArm, angles_of: JointAngles, motion: JointMotion, angles: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """(n, nq) positions and (n, nv) velocities as reported; `angles` are those of the motion."""
    counted = quantised(angles, arm.encoder_bits, angles_of.sliding)
    q = motion.q if arm.encoder_bits is None else angles_of.write(counted)
    v = motion.v
    if arm.velocity_cutoff is not None:
        v = low_pass(motion.time, differenced(motion.time, counted), arm.velocity_cutoff, arm.velocity_order)
    return q, delayed(motion.time, v, arm.per_joint("velocity_delay", angles_of.nv))


def kept_rows(arm: ImperfectArm, time: FloatArray, rng: np.random.Generator) -> NDArray[np.bool_]:
    """Which rows are not lost: gaps of random length, never the first row nor the last."""
    kept = np.ones(len(time), dtype=bool)
    if arm.dropped_ticks > 0.0:
        length = max(1.0, arm.drop_length / float(np.median(np.diff(time))))
        # Of the time between gaps, so that the share comes out as asked.
        pause = length * (1.0 - arm.dropped_ticks) / arm.dropped_ticks
        row = 1 + int(rng.exponential(pause))
        while row < len(time) - 1:
            gap = int(rng.geometric(1.0 / length))
            kept[row : min(row + gap, len(time) - 1)] = False
            row += gap + 1 + int(rng.exponential(pause))
    return kept


def time_reading(arm: ImperfectArm, time: FloatArray, rng: np.random.Generator) -> FloatArray:
    """(n,) time stamps with jitter, in order [s]."""
    largest = _LARGEST_JITTER * float(np.diff(time).min())
    stamps: FloatArray = time + np.clip(arm.jitter * rng.standard_normal(len(time)), -largest, largest)
    return stamps

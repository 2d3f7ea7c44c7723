"""What one arm records: motion to calibrate with, motion to judge false onsets on, and contacts."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contactsense import Robot, exciting_motion
from contactsense.log import Log
from contactsense.sim import ImperfectArm, ImperfectRun, JointMotion, PersonScene, record_imperfect

from .options import Options

DT = 1e-3  # [s]
# Of a person [N; s], and the coefficient of friction between hand and arm.
FORCE = (5.0, 40.0)
DURATION = (0.1, 1.0)
FRICTION = 0.5
# Speed of the moves as a share of the velocity limits, and rests between them [s].
SPEED = (0.15, 0.6)
REST = (0.2, 3.0)
# Time for each contact with the pause after it, and before the first [s].
PER_CONTACT, BEFORE_CONTACTS = 3.5, 2.0


@dataclass(frozen=True, eq=False)
class Records:
    """Of one arm. Monitors get the logs alone."""

    arm: ImperfectArm
    exciting: Log  # planned for calibration
    everyday: Log  # moves like those that are judged, to choose thresholds from
    free: ImperfectRun
    contacts: ImperfectRun


def record(robot: Robot, arm: ImperfectArm, options: Options, seed: int) -> Records:
    """All that `arm` records in a trial; `robot` is its description."""
    seeds = [int(word) for word in np.random.SeedSequence([seed, 1]).generate_state(4)]
    plan = exciting_motion(robot, float(options.calibration_seconds), dt=DT, seed=seeds[0])
    motion = JointMotion(plan.time, plan.q, plan.v, plan.a)
    everyday = scene(float(options.calibration_seconds), 0, seeds[1])
    free = scene(float(options.free_seconds), 0, seeds[2])
    touched = scene(BEFORE_CONTACTS + PER_CONTACT * options.contacts, options.contacts, seeds[3])
    return Records(
        arm=arm,
        exciting=record_imperfect(robot, arm, motion, seed=seeds[0]).log,
        everyday=everyday.record(robot, arm).log,
        free=free.record(robot, arm),
        contacts=touched.record(robot, arm),
    )


def scene(seconds: float, contacts: int, seed: int) -> PersonScene:
    """Moves and rests, with or without a person."""
    return PersonScene(
        seconds=seconds,
        contacts=contacts,
        contact_free=BEFORE_CONTACTS,
        force=FORCE,
        duration=DURATION,
        friction=FRICTION,
        speed=SPEED,
        rest=REST,
        dt=DT,
        seed=seed,
    )

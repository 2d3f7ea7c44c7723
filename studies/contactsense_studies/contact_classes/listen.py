"""What monitor and classifier say of an episode. No truth in here."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contactsense import Calibration, ContactClass, ContactClassifier, ContactMonitor, Robot
from contactsense.sim import ImperfectArm, JointMotion
from contactsense.sim.joint_motion import JointAngles
from contactsense.sim.reading import motion_reading, torque_reading

from .episode import DT, Episode

# Ages at which a running contact is read [s].
AGES = (0.02, 0.05, 0.1, 0.14, 0.2, 0.3, 0.5, 0.8, 1.2, 1.8)


@dataclass(frozen=True)
class Said:
    """What was said of one contact at an age; at its end, the age is None."""

    since: float  # [s]
    duration: float  # [s]
    age: float | None  # [s]
    answer: ContactClass


def listen(
    robot: Robot, arm: ImperfectArm, calibration: Calibration, episode: Episode, rng: np.random.Generator
) -> list[Said]:
    """All contacts, each at several ages and at its end."""
    friction = arm.friction.share_seen(robot.nv) * arm.friction.torque(episode.q, episode.v)
    tau = torque_reading(robot, arm, episode.time, episode.tau + friction, rng)
    motion = JointMotion(episode.time, episode.q, episode.v, np.zeros_like(episode.v))
    q, v = motion_reading(arm, JointAngles(robot.model), motion, episode.q)
    monitor = ContactMonitor(robot, dt=DT, calibration=calibration)
    classifier = ContactClassifier(robot, dt=DT)
    said: list[Said] = []
    read: dict[float, int] = {}
    last: tuple[ContactClass, ...] = ()
    for row in range(len(q)):
        last = classifier.update(q[row], v[row], monitor.update(q[row], v[row], tau[row]))
        for each in last:
            number = read.get(each.since, 0)
            if not each.running:
                said.append(Said(each.since, each.duration, None, each))
            elif number < len(AGES) and each.duration >= AGES[number] - 1e-9:
                said.append(Said(each.since, each.duration, AGES[number], each))
                read[each.since] = number + 1
    return said

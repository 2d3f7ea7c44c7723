"""All arms in one run."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from contactsense import Robot, calibrate, exciting_motion
from contactsense.sim import ImperfectArm, JointMotion, rated_torque, record_imperfect

from ..example_robots import available
from ..harness import Report, silent
from ..parallel import run_trials
from .arms import JUDGED, described
from .episode import DT, simulate
from .judge import Judged, judge
from .listen import listen
from .options import Options
from .scenes import MOTION_SECONDS, draw, way_of
from .truth import truth_of

# Scenes of one arm with errors of its own, and its motion to calibrate with [s].
PER_ARM, CALIBRATION_SECONDS = 65, 30.0

# Arm, seed, number of the trial, scenes in it.
Item: TypeAlias = tuple[str, int, int, int]


@dataclass(frozen=True, eq=False)
class Study:
    """All contacts."""

    options: Options
    arms: tuple[str, ...]
    skipped: dict[str, str]  # arms that are not installed, and what is missing
    judged: list[Judged]
    complete: bool = True  # Ctrl-C did not end it early

    def of(self, arm: str) -> list[Judged]:
        """The contacts of an arm."""
        return [each for each in self.judged if each.arm == arm]


def run(options: Options | None = None, *, processes: int | None = None, progress: Report = silent) -> Study:
    """Runs the study; `progress` is told the stage, and how much of it is done.

    The answer depends on the options alone. Arms that are not installed are skipped, unless `options` names
    them.

    Raises:
        MissingExtraError: an arm that `options` names is not installed.
    """
    options = options or Options()
    arms, skipped = available(options.arms, JUDGED, described)
    items = []
    for arm in arms:
        for number, first in enumerate(range(0, options.scenes, PER_ARM)):
            items.append((arm, options.seed, number, min(PER_ARM, options.scenes - first)))
    found, complete = run_trials(_trial, items, "scenes", processes, progress, weight=lambda item: item[3])
    return Study(options, arms, skipped, [each for part in found for each in part], complete)


def _trial(item: Item) -> list[Judged]:
    name, seed, number, scenes = item
    entropy = np.random.SeedSequence([seed, number, *name.encode()])
    return contacts_of(name, described(name), np.random.default_rng(entropy), scenes)


def contacts_of(
    name: str, robot: Robot, rng: np.random.Generator, scenes: int, motion_seconds: float = MOTION_SECONDS
) -> list[Judged]:
    """Scenes of one arm with errors of its own, less those without contact or unstable."""
    seed = int(rng.integers(1 << 30))
    arm = ImperfectArm.typical(robot, seed)
    true, rated = arm.true_robot(robot), rated_torque(robot)
    plan = exciting_motion(robot, CALIBRATION_SECONDS, dt=DT, seed=seed)
    free = record_imperfect(robot, arm, JointMotion(plan.time, plan.q, plan.v, plan.a), seed=seed)
    calibration = calibrate(robot, free.log)
    way = way_of(robot, seed, motion_seconds)
    judged = []
    for _ in range(scenes):
        scene = draw(way, rng)
        episode = simulate(robot, true, rated, scene)
        truth = None if episode is None else truth_of(scene, episode)
        if episode is not None and truth is not None:
            judged.append(judge(name, truth, listen(robot, arm, calibration, episode, rng)))
    return judged

"""All arms in one run."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import TypeAlias

import numpy as np

from contactsense import exciting_motion
from contactsense.sim import ImperfectArm, JointMotion

from ..example_robots import available
from ..harness import Report, silent
from ..parallel import run_trials
from .arms import KINDS, USUAL, described
from .options import Options
from .recover import Recovery, linear, loaded, recover

# The motion that every arm is calibrated with [s].
SECONDS, DT = 30.0, 5e-3

# Robot, kind, seed and number of the run.
Item: TypeAlias = tuple[str, str, int, int]


@dataclass(frozen=True, eq=False)
class Study:
    """All calibrations."""

    options: Options
    robots: tuple[str, ...]
    skipped: dict[str, str]  # robots that are not installed, and what is missing
    found: dict[tuple[str, str], list[Recovery]]  # by robot and kind
    complete: bool = True  # Ctrl-C did not end it early


def run(options: Options | None = None, *, processes: int | None = None, progress: Report = silent) -> Study:
    """Runs the study; `progress` is told the stage, and how much of it is done.

    The answer depends on the options alone. Robots that are not installed are skipped, unless `options` names
    them.

    Raises:
        MissingExtraError: a robot that `options` names is not installed.
    """
    options = options or Options()
    robots, skipped = available(options.robots, USUAL, described)
    items = [
        (robot, kind, options.seed, number)
        for robot in robots
        for kind in KINDS
        for number in range(options.runs)
    ]
    results, complete = run_trials(_trial, items, "arms", processes, progress)
    found: dict[tuple[str, str], list[Recovery]] = {}
    for (robot, kind, _, _), recovery in zip(items, results, strict=False):
        found.setdefault((robot, kind), []).append(recovery)
    return Study(options, robots, skipped, found, complete)


def _trial(item: Item) -> Recovery:
    name, kind, seed, number = item
    robot = described(name)
    # Both kinds have the same errors otherwise.
    drawn = int(np.random.SeedSequence([seed, number, *name.encode()]).generate_state(1)[0])
    arm = ImperfectArm.typical(robot, drawn)
    arm = loaded(robot, linear(arm) if kind == "linear" else arm, drawn)
    return recover(robot, arm, _motion(name), drawn)


@lru_cache(maxsize=2)
def _motion(name: str) -> JointMotion:
    planned = exciting_motion(described(name), SECONDS, dt=DT)
    return JointMotion(planned.time, planned.q, planned.v, planned.a)

"""All arms in one run."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np

from contactsense import calibrate
from contactsense.sim import ImperfectArm

from ..example_robots import available
from ..harness import Report, silent
from ..parallel import run_trials
from .arms import ARMS, described
from .judge import FreeMotion, JudgedContact, judge_contacts, judge_free
from .monitors import hear, settings
from .options import Options
from .records import record
from .stretch import Stretch, cut

# Arm, number of the trial.
Item: TypeAlias = tuple[Options, str, int]


@dataclass(frozen=True, eq=False)
class Trial:
    """One arm with errors of its own, and what each monitor made of its records."""

    arm: str
    number: int
    errors: ImperfectArm
    thresholds: tuple[float, ...]  # (nv,) that were chosen from its own motion [Nm]
    free: dict[str, FreeMotion]  # by monitor
    contacts: tuple[JudgedContact, ...]
    stretch: Stretch | None  # of the first trial of each arm


@dataclass(frozen=True, eq=False)
class Study:
    """All trials."""

    options: Options
    arms: tuple[str, ...]
    skipped: dict[str, str]  # arms that are not installed, and what is missing
    trials: list[Trial]
    complete: bool = True  # Ctrl-C did not end it early

    def of(self, arm: str | None) -> list[Trial]:
        """The trials of an arm, or all."""
        return [trial for trial in self.trials if arm in (None, trial.arm)]


def run(options: Options | None = None, *, processes: int | None = None, progress: Report = silent) -> Study:
    """Runs the study; `progress` is told the stage, and how much of it is done.

    The answer depends on the options alone, not on `processes` (default: one a core). Ctrl-C ends it early,
    with the trials that are finished. Arms that are not installed are skipped, unless `options` names them.

    Raises:
        MissingExtraError: an arm that `options` names is not installed.
        ModelError, GeometryError: a robot cannot be used.
    """
    options = options or Options()
    arms, skipped = available(options.arms, ARMS, described)
    items = [(options, name, number) for number in range(options.trials) for name in arms]
    trials, complete = run_trials(_trial, items, "trials", processes, progress)
    return Study(options, arms, skipped, trials, complete)


def _trial(item: Item) -> Trial:
    options, name, number = item
    robot, seed = described(name), trial_seed(options, name, number)
    arm = ARMS[name].errors(robot, seed)
    records = record(robot, arm, options, seed)
    monitors: dict[str, Any] = settings(robot, records.everyday, calibrate(robot, records.exciting))
    heard_free = {each: hear(robot, records.free.log, **given) for each, given in monitors.items()}
    touched = [each.rows for each in records.contacts.truth.contacts]
    heard = {each: hear(robot, records.contacts.log, touched, **given) for each, given in monitors.items()}
    free = {
        each: judge_free(records.free, heard_free[each], records.contacts, heard[each]) for each in monitors
    }
    return Trial(
        arm=name,
        number=number,
        errors=arm,
        thresholds=tuple(monitors["thresholds"]["torque_threshold"].tolist()),
        free=free,
        contacts=judge_contacts(records.contacts, heard),
        stretch=None if number else cut(records.contacts, heard),
    )


def trial_seed(options: Options, arm: str, number: int) -> int:
    """Every trial has its own."""
    entropy = [options.seed, number, *arm.encode()]
    return int(np.random.SeedSequence(entropy).generate_state(1)[0])

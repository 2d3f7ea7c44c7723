"""All runs."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TypeAlias

from contactsense import InputError

from ..bimbo2019.arm import load_arm
from ..bimbo2019.experiments import BY_NAME
from ..bimbo2019.study import trial_seed
from ..bimbo2019.trials import record
from ..harness import Report, silent
from ..parallel import run_trials
from .calibrated import record_calibrated
from .methods import METHODS, Found, locate
from .options import Options

# Runs at random poses and points, with random motions against a sphere.
EXPERIMENT = "random"

# Link and number of the trial.
Item: TypeAlias = tuple[Options, str, int]


@dataclass(frozen=True)
class Trial:
    """One recorded run and what was found, by method and noise."""

    link: str
    number: int
    found: dict[tuple[str, float], Found]  # empty: no such contact was found


@dataclass(frozen=True)
class Study:
    """All trials."""

    options: Options
    links: tuple[str, ...]
    trials: list[Trial]
    complete: bool = True  # Ctrl-C did not end it early

    def found(self, method: str, noise: float, link: str) -> list[Found]:
        """Of all trials on a link."""
        return [trial.found[method, noise] for trial in self.trials if trial.found and trial.link == link]


def run(options: Options | None = None, *, processes: int | None = None, progress: Report = silent) -> Study:
    """Runs the study; `progress` is told the stage, and how much of it is done.

    The answer depends on the options alone, not on `processes` (default: one a core).
    Ctrl-C ends it early, with the trials that are finished.

    Raises:
        InputError: an option cannot be used.
        ModelError, GeometryError: the robot cannot be used.
    """
    options = options or Options()
    arm = load_arm(options)
    items = [(options, link, number) for number in range(options.trials) for link in arm.links]
    trials, complete = run_trials(_trial, items, "trials", processes, progress)
    return Study(options, arm.links, trials, complete)


def _trial(item: Item) -> Trial:
    options, link, number = item
    arm = load_arm(options)
    seed = trial_seed(options.seed, EXPERIMENT, link, number)
    calibration = None
    try:
        if options.imperfect:
            recorded, calibration = record_calibrated(arm.robot, link, options.friction, seed)
        else:
            experiment = replace(BY_NAME[EXPERIMENT], friction=options.friction)
            recorded = record(arm, experiment, link, number, seed)
    except InputError:
        return Trial(link, number, {})
    found = {
        (method.name, noise): locate(
            arm.robot, recorded, method, noise, replace(options, seed=seed), calibration
        )
        for method in METHODS
        for noise in options.noises()
    }
    return Trial(link, number, found)

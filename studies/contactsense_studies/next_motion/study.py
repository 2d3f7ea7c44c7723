"""All trials."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from contactsense import InputError

from ..bimbo2019.arm import load_arm
from ..harness import Report, silent
from ..memory.methods import METHODS, Method
from ..parallel import run_trials
from .options import Options
from .trial import WAYS, Outcome, Way, locate

SCENES = 10  # that are tried for a trial

# Link and number of the trial.
Item: TypeAlias = tuple[Options, str, int]


@dataclass(frozen=True)
class Trial:
    """One contact, and what became of it by method and way."""

    link: str
    number: int
    outcomes: dict[tuple[str, Way], Outcome]  # empty: no such contact was found


@dataclass(frozen=True)
class Study:
    """All trials."""

    options: Options
    links: tuple[str, ...]
    trials: list[Trial]
    complete: bool = True  # Ctrl-C did not end it early

    def outcomes(self, link: str, method: str, way: Way) -> list[Outcome]:
        """Of all trials on a link."""
        return [trial.outcomes[method, way] for trial in self.trials if trial.outcomes and trial.link == link]


def wanted(options: Options) -> list[Method]:
    """The methods that are asked for."""
    return [method for method in METHODS if method.name in options.methods]


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
    of_link = [options.seed, number, arm.robot.link_names.index(link)]
    for chance in np.random.SeedSequence(of_link).generate_state(SCENES).tolist():
        try:
            outcomes = {
                (method.name, way): locate(arm.robot, link, method, way, options, chance)
                for method in wanted(options)
                for way in WAYS
            }
        except InputError:
            continue  # such a contact was not found
        return Trial(link, number, outcomes)
    return Trial(link, number, {})

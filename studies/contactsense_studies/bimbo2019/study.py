"""All experiments in one run."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from contactsense import InputError

from ..harness import Report, silent
from ..parallel import run_trials
from .arm import load_arm
from .experiments import BY_NAME, Experiment, Filter
from .options import Options
from .score import Outcome
from .tracking import track
from .trials import record

# Experiment, link, number of the trial.
Item: TypeAlias = tuple[Options, str, str, int]


@dataclass(frozen=True)
class Trial:
    """One recorded run and what each filter made of it, in the experiment's order."""

    experiment: str
    link: str
    number: int
    outcomes: tuple[Outcome, ...]  # empty: no such contact was found


@dataclass(frozen=True)
class Study:
    """All trials."""

    options: Options
    links: tuple[str, ...]
    trials: list[Trial]
    complete: bool = True  # Ctrl-C did not end it early

    def outcomes(self, experiment: Experiment, kind: Filter, link: str | None = None) -> list[Outcome]:
        """Of all trials with one filter, on one link or on all."""
        place = experiment.filters.index(kind)
        return [
            trial.outcomes[place]
            for trial in self.trials
            if trial.outcomes and trial.experiment == experiment.name and link in (None, trial.link)
        ]

    def short(self, link: str) -> str:
        """The link's name without a first word that all names share."""
        shared = len({each.partition("_")[0] for each in self.links}) == 1
        return link.partition("_")[2] or link if shared else link

    def recorded(self, experiment: str, near: int) -> Trial | None:
        """The first trial of an experiment that could be recorded, on the link nearest to number `near`."""
        trials = [each for each in self.trials if each.experiment == experiment and each.outcomes]
        return min(trials, key=lambda each: abs(self.links.index(each.link) - near), default=None)


def run(
    options: Options | None = None,
    *,
    processes: int | None = None,
    progress: Report = silent,
) -> Study:
    """Runs the study; `progress` is told the stage, and how much of it is done.

    The answer depends on the options alone, not on `processes` (default: one a core).
    Ctrl-C ends it early, with the trials that are finished.

    Raises:
        InputError: an option cannot be used.
        ModelError, GeometryError: the robot cannot be used.
    """
    options = options or Options()
    arm = load_arm(options)
    items = [
        (options, experiment.name, link, number)
        for experiment in options.chosen()
        for number in range(options.trials)
        for link in arm.links
    ]
    trials, complete = run_trials(_trial, items, "trials", processes, progress)
    return Study(options, arm.links, trials, complete)


def _trial(item: Item) -> Trial:
    options, name, link, number = item
    arm, experiment = load_arm(options), BY_NAME[name]
    seed = trial_seed(options.seed, name, link, number)
    try:
        recorded = record(arm, experiment, link, number, seed)
    except InputError:
        return Trial(name, link, number, ())
    outcomes = [track(arm, recorded, kind, options, seed) for kind in experiment.filters]
    return Trial(name, link, number, tuple(outcomes))


def trial_seed(seed: int, experiment: str, link: str, number: int) -> int:
    """Every trial has its own."""
    entropy = [seed, number, *f"{experiment}/{link}".encode()]
    return int(np.random.SeedSequence(entropy).generate_state(1)[0])

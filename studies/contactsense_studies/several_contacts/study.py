"""All trials."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from contactsense import ContactParticleFilter, InputError, Robot, StaticObstacleSampler
from contactsense.sim import TorqueNoise, atlas
from contactsense.sim.deepest import moving_links

from ..harness import Report, silent
from ..parallel import run_trials
from .judge import Judged, judge_several
from .options import Options
from .runs import record_several

# Parts of the names of links that are left out: legs stand on force/torque sensors.
LEGS = ("leg", "foot", "talus", "glut")

# Number of contacts and of the trial.
Item: TypeAlias = tuple[Options, int, int]


@dataclass(frozen=True)
class Trial:
    """One run; none where no such contacts were found."""

    contacts: int
    number: int
    judged: Judged | None


@dataclass(frozen=True)
class Study:
    """All trials."""

    options: Options
    trials: list[Trial]
    complete: bool = True  # Ctrl-C did not end it early

    def judged(self, contacts: int) -> list[Judged]:
        """Of all trials with so many contacts."""
        return [trial.judged for trial in self.trials if trial.judged and trial.contacts == contacts]


def run(options: Options | None = None, *, processes: int | None = None, progress: Report = silent) -> Study:
    """Runs the study; `progress` is told the stage, and how much of it is done.

    The answer but for the times depends on the options alone, not on `processes` (default: one a core).
    Ctrl-C ends it early, with the trials that are finished.

    Raises:
        InputError: an option cannot be used.
        ModelError: there is no such robot.
    """
    options = options or Options()
    robot = Robot.named(options.robot)
    if robot.floating_base and options.robot != "atlas":
        raise InputError("robot: of those with a floating base, only atlas has a posture here")
    touched(robot, options)
    items = [(options, contacts, number) for number in range(options.trials) for contacts in options.contacts]
    trials, complete = run_trials(_trial, items, "trials", processes, progress)
    return Study(options, trials, complete)


def touched(robot: Robot, options: Options) -> tuple[str, ...]:
    """Links that may be touched."""
    moving = moving_links(robot)
    if unknown := set(options.links) - set(moving):
        raise InputError(f"links: {', '.join(sorted(unknown))} does not move or has no surface")
    links = options.links or tuple(link for link in moving if not any(part in link for part in LEGS))
    if len(links) < max(options.contacts):
        raise InputError(f"contacts: there are only {len(links)} links that may be touched")
    return links


def _trial(item: Item) -> Trial:
    options, contacts, number = item
    robot = Robot.named(options.robot)
    links = touched(robot, options)
    seed = int(np.random.default_rng([options.seed, contacts, number]).integers(2**31))
    posture = atlas.posture(robot.model, seed) if robot.floating_base else None
    try:
        run = record_several(
            robot, links, contacts, options.poses, q=posture, friction=options.friction, seed=seed
        )
    except InputError:
        return Trial(contacts, number, None)
    finder_class = ContactParticleFilter if options.method == "filter" else StaticObstacleSampler
    finder = finder_class(
        robot,
        particles=options.particles,
        max_contacts=options.max_contacts,
        links=links,
        measurement="friction_cone" if options.friction > 0.0 else "normal",
        friction=options.friction,
        torque_noise=options.newton_metres,
        relative_noise=0.01 * options.percent,
        seed=seed,
    )
    noise = TorqueNoise(percent=options.percent, newton_metres=options.newton_metres, seed=seed)
    start = time.perf_counter()
    for q, torque in zip(run.q, run.external_torque, strict=True):
        estimate = finder.update(q, noise.measure(torque))
    seconds = (time.perf_counter() - start) / len(run.q)
    probability = np.nan
    if isinstance(finder, StaticObstacleSampler):
        probability = float(finder.number_probabilities[contacts - 1])
    return Trial(contacts, number, judge_several(estimate, run, -1, probability, seconds))

"""All poses of all robots."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import TypeAlias

import numpy as np

from contactsense import ContactMap, Identifiability, NoiseModel, Robot
from contactsense.sim._arrays import FloatArray

from ..example_robots import robot_of
from ..harness import Report, silent
from ..parallel import run_trials
from .options import Options

ROBOTS = ("iiwa14", "atlas")

# Robot, number of the pose.
Item: TypeAlias = tuple[Options, str, int]


@dataclass(frozen=True, eq=False)
class Pose:
    """One pose of a robot, and what the torques tell there."""

    robot: str
    q: FloatArray
    told: Identifiability


@dataclass(frozen=True, eq=False)
class Study:
    """All poses."""

    options: Options
    poses: list[Pose]
    complete: bool = True  # Ctrl-C did not end it early

    @property
    def robots(self) -> tuple[str, ...]:
        """Those of which there is a pose."""
        return tuple(dict.fromkeys(pose.robot for pose in self.poses))

    def of(self, robot: str) -> list[Pose]:
        """The poses of a robot; their samples are the same points of its links."""
        return [pose for pose in self.poses if pose.robot == robot]

    def robot(self, name: str) -> Robot:
        """One of them."""
        return _robot(self.options, name)


def run(options: Options | None = None, *, processes: int | None = None, progress: Report = silent) -> Study:
    """Runs the study; `progress` is told the stage, and how much of it is done.

    The answer depends on the options alone, not on `processes` (default: one a core). Ctrl-C ends it early,
    with the poses that are finished.

    Raises:
        InputError: an option cannot be used; names it.
        ModelError, GeometryError: a robot cannot be used.
    """
    options = options or Options()
    names = tuple(dict.fromkeys(options.robots)) or ROBOTS
    for name in names:
        _map(options, name)  # what cannot be used is reported before any work is shared out
    poses = 1 if options.q else options.poses
    items = [(options, name, number) for name in names for number in range(poses)]
    found, complete = run_trials(_pose, items, "poses", processes, progress)
    return Study(options, found, complete)


def _pose(item: Item) -> Pose:
    options, name, number = item
    contact_map = _map(options, name)
    given = options.configuration()
    if given is None:
        seed = int(np.random.SeedSequence([options.seed, number]).generate_state(1)[0])
        q = contact_map.robot.random_configuration(seed)
    else:
        q = np.array(given)
    return Pose(name, q, contact_map.identifiability(q, force=options.force))


@lru_cache(maxsize=8)
def _robot(options: Options, name: str) -> Robot:
    return robot_of(name, options.package_dirs, floating_base=options.floating_base)


@lru_cache(maxsize=8)
def _map(options: Options, name: str) -> ContactMap:
    noise = NoiseModel(torque=options.torque_noise, model=0.0, relative=options.relative_noise)
    return ContactMap(_robot(options, name), samples=options.samples, friction=options.friction, noise=noise)

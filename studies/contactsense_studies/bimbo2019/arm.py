"""The study's robot."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

from contactsense import InputError, Robot
from contactsense.sim.deepest import moving_links

from ..arm_options import ArmOptions
from ..example_robots import robot_of


@dataclass(frozen=True)
class Arm:
    """A robot on a fixed base, and the links that are touched."""

    robot: Robot
    links: tuple[str, ...]


def load_arm(options: ArmOptions) -> Arm:
    """Loads the robot, once a process.

    Raises:
        InputError: it has a floating base or no such link.
        ModelError, GeometryError: the description cannot be used.
    """
    arm = _load(options.robot, options.package_dirs)
    unknown = [link for link in options.links if link not in arm.links]
    if unknown:
        raise InputError(f"links: '{unknown[0]}' has no surface that moves; there are {', '.join(arm.links)}")
    return Arm(arm.robot, options.links or arm.links)


@lru_cache(maxsize=1)
def _load(name: str, package_dirs: tuple[str, ...]) -> Arm:
    robot = robot_of(name, package_dirs)
    if robot.floating_base or robot.nq != robot.nv:
        raise InputError(f"robot: '{name}' must be an arm on a fixed base, its joints of one coordinate each")
    return Arm(robot, moving_links(robot))

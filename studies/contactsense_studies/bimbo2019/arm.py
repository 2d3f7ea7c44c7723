"""The study's robot."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from contactsense import InputError, Robot
from contactsense.robot import DESCRIPTIONS
from contactsense.sim import model_from_urdf, named_model

from .options import Options


@dataclass(frozen=True)
class Arm:
    """A robot on a fixed base, its Pinocchio model, and the links that are touched."""

    robot: Robot
    model: Any
    links: tuple[str, ...]


def load_arm(options: Options) -> Arm:
    """Loads the robot, once a process.

    Raises:
        InputError: it has a floating base or no such link.
        ModelError, GeometryError: the description cannot be used.
    """
    arm = _load(options.robot, options.package_dirs)
    unknown = [link for link in options.links if link not in arm.links]
    if unknown:
        raise InputError(f"links: '{unknown[0]}' has no surface that moves; there are {', '.join(arm.links)}")
    return Arm(arm.robot, arm.model, options.links or arm.links)


@lru_cache(maxsize=1)
def _load(name: str, package_dirs: tuple[str, ...]) -> Arm:
    if name in DESCRIPTIONS:
        robot, model = Robot.named(name), named_model(name)
    else:
        robot, model = Robot.from_urdf(name, package_dirs=package_dirs), model_from_urdf(name)
    if robot.floating_base or robot.nq != robot.nv:
        raise InputError(f"robot: '{name}' must be an arm on a fixed base, its joints of one coordinate each")
    q = robot.neutral()
    moving = tuple(link for link in robot.link_names if np.any(robot.jacobian(q, link)))
    return Arm(robot, model, moving)

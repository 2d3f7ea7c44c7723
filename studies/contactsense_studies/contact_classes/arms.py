"""The study's robots: which ones the weights are found on, and which ones judge them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

from contactsense import Robot

from ..example_robots import example_robot, panda


@dataclass(frozen=True)
class ArmKind:
    """How a robot is described, and whether the weights were found on it."""

    describe: Callable[[], Robot]
    fitted: bool


ARMS = {
    "iiwa14": ArmKind(lambda: Robot.named("iiwa14"), True),
    "xarm7": ArmKind(lambda: example_robot("xarm_description/urdf/xarm7.urdf"), True),
    "panda": ArmKind(panda, False),
    "ur5": ArmKind(lambda: example_robot("ur_description/urdf/ur5_robot.urdf"), False),
    "talos": ArmKind(lambda: example_robot("talos_data/robots/talos_left_arm.urdf"), False),
}
FITTED = tuple(name for name, kind in ARMS.items() if kind.fitted)
JUDGED = tuple(name for name, kind in ARMS.items() if not kind.fitted)


@lru_cache(maxsize=2)
def described(name: str) -> Robot:
    """Loaded once a process.

    Raises:
        MissingExtraError: example-robot-data is not installed.
    """
    return ARMS[name].describe()

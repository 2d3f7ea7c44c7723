"""The study's robots, and the kinds of errors that they have."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache

from contactsense import Robot

from ..example_robots import example_robot, panda

ROBOTS: dict[str, Callable[[], Robot]] = {
    "iiwa14": lambda: Robot.named("iiwa14"),
    "panda": panda,
    "ur5": lambda: example_robot("ur_description/urdf/ur5_robot.urdf"),
    "xarm7": lambda: example_robot("xarm_description/urdf/xarm7.urdf"),
    "kinova": lambda: example_robot("kinova_description/robots/kinova.urdf"),
    "ur10": lambda: example_robot("ur_description/urdf/ur10_robot.urdf"),
}
# No setting of `calibrate` was chosen on these.
USUAL = ("iiwa14", "panda", "ur5")
# Without and with errors that the regression has no exact term for: gears with hysteresis, and torque scales.
KINDS = ("linear", "typical")


@lru_cache(maxsize=2)
def described(name: str) -> Robot:
    """Loaded once a process.

    Raises:
        MissingExtraError: example-robot-data is not installed.
    """
    return ROBOTS[name]()

"""The study's arms: as described, and what is wrong with each."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

from contactsense import Robot
from contactsense.sim import ImperfectArm

from ..example_robots import example_robot, panda


@dataclass(frozen=True)
class ArmKind:
    """How an arm is described, and how one of its kind differs from that, by a seed."""

    about: str
    describe: Callable[[], Robot]
    errors: Callable[[Robot, int], ImperfectArm]


def _iiwa14() -> Robot:
    return Robot.named("iiwa14")


def _ur5() -> Robot:
    return example_robot("ur_description/urdf/ur5_robot.urdf")


def _kinova() -> Robot:
    return example_robot("kinova_description/robots/kinova.urdf")


_SENSORS = "torque sensors between gears and links"
ARMS = {
    "panda": ArmKind(f"Panda, {_SENSORS}", panda, ImperfectArm.typical),
    "iiwa14": ArmKind(f"iiwa14, {_SENSORS}", _iiwa14, ImperfectArm.typical),
    "ur5": ArmKind(f"UR5, {_SENSORS}", _ur5, ImperfectArm.typical),
    "kinova": ArmKind(f"Kinova Jaco 2, {_SENSORS}", _kinova, ImperfectArm.typical),
    # As on the real one: all friction and the rotors are in the torque.
    "ur5_currents": ArmKind("UR5, torques are motor currents", _ur5, ImperfectArm.motor_currents),
}


@lru_cache(maxsize=2)
def described(name: str) -> Robot:
    """The robot that monitors are given, loaded once a process.

    Raises:
        MissingExtraError: example-robot-data is not installed.
    """
    return ARMS[name].describe()

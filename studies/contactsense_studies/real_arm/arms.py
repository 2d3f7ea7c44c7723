"""The study's arms: as described, and what is wrong with each."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

from contactsense import Robot

from ..example_robots import example_robot, panda

if TYPE_CHECKING:
    from contactsense.sim import ImperfectArm


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


# The options of the command name the arms, and need no simulator for it.
def _typical(robot: Robot, seed: int) -> ImperfectArm:
    from contactsense.sim import ImperfectArm

    return ImperfectArm.typical(robot, seed)


def _motor_currents(robot: Robot, seed: int) -> ImperfectArm:
    from contactsense.sim import ImperfectArm

    return ImperfectArm.motor_currents(robot, seed)


_SENSORS = "torque sensors between gears and links"
ARMS = {
    "panda": ArmKind(f"Panda, {_SENSORS}", panda, _typical),
    "iiwa14": ArmKind(f"iiwa14, {_SENSORS}", _iiwa14, _typical),
    "ur5": ArmKind(f"UR5, {_SENSORS}", _ur5, _typical),
    "kinova": ArmKind(f"Kinova Jaco 2, {_SENSORS}", _kinova, _typical),
    # As on the real one: all friction and the rotors are in the torque.
    "ur5_currents": ArmKind("UR5, torques are motor currents", _ur5, _motor_currents),
}


@lru_cache(maxsize=2)
def described(name: str) -> Robot:
    """The robot that monitors are given, loaded once a process.

    Raises:
        MissingExtraError: example-robot-data is not installed.
    """
    return ARMS[name].describe()

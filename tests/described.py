"""A loader's description with the warnings of the robot made of it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import contactsense as cs
from contactsense.loading.description import RobotDescription


def describe_urdf(path: Path, **options: Any) -> RobotDescription:
    robot = cs.Robot.from_urdf(path, **options)
    return robot._description._replace(warnings=list(robot.warnings))

"""Options that the commands on logs share: the robot, and how its log is read."""

from __future__ import annotations

import fnmatch
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Annotated, Any, Literal

import typer

from .._core import ForceTorqueSensor
from ..errors import InputError
from ..log import Log, read_log
from ..robot import DESCRIPTIONS, Robot
from .robot_files import package_folders, quietly, summary

_Geometry = Literal["collision", "visual", "collision_or_visual"]
_GEOMETRIES: tuple[_Geometry, ...] = ("collision", "visual", "collision_or_visual")

RobotOption = Annotated[
    str, typer.Option("--robot", help=f"URDF of the robot, or the name of one of: {', '.join(DESCRIPTIONS)}.")
]
PackageOption = Annotated[
    list[Path] | None,
    typer.Option(
        "--package-dir",
        help="Folder with the packages of package:// names, besides that of the URDF's own package and "
        "those of a sourced ROS workspace; may be repeated.",
    ),
]
LockedOption = Annotated[
    list[str] | None,
    typer.Option(
        "--lock",
        help="JOINT, JOINT=POSITION, or a pattern such as 'hand_*': joints that do not move.",
    ),
]
FloatingOption = Annotated[
    bool,
    typer.Option("--floating-base", help="The root link of the URDF moves freely, as that of a humanoid."),
]
GeometryOption = Annotated[
    str, typer.Option("--geometry", help="Shapes of the surface: collision, visual or collision_or_visual.")
]
ColumnOption = Annotated[
    list[str] | None,
    typer.Option(
        "--column",
        help="QUANTITY=NAME, such as position='actual_q_*', with * for the joint; quantities are time, "
        "position, velocity, torque, external_torque, current, base_pose, base_twist; may be repeated.",
    ),
]
TopicOption = Annotated[
    list[str] | None, typer.Option("--topic", help="Topic or table to look at; may be repeated.")
]
UnitOption = Annotated[
    list[str] | None,
    typer.Option("--unit", help="QUANTITY=UNIT, such as position=deg; may be repeated."),
]
ConstantsOption = Annotated[
    str | None,
    typer.Option(
        "--torque-constants", help="Torque for each recorded unit, one or one a joint: 0.1,0.1,0.08."
    ),
]
ExternalOption = Annotated[
    bool,
    typer.Option(
        "--external",
        help="Take the vendor's external torque in place of the motors' torques; --torque-constants=-1 "
        "turns its sign.",
    ),
]
RateOption = Annotated[
    float | None,
    typer.Option("--rate", help="Interpolate to so many rows a second (default: rows as they are)."),
]


@dataclass(frozen=True)
class LogOptions:
    """What the options say of the robot and of how its log is read."""

    robot: RobotOption
    package_dir: PackageOption = None
    lock: LockedOption = None
    floating_base: FloatingOption = False
    geometry: GeometryOption = "collision"
    column: ColumnOption = None
    topic: TopicOption = None
    unit: UnitOption = None
    torque_constants: ConstantsOption = None
    external: ExternalOption = False
    rate: RateOption = None

    def load_robot(self) -> Robot:
        """The robot; its warnings are printed on stderr."""
        robot = self._robot()
        for line in summary(robot.warnings):
            print(f"{robot.name}: {line}", file=sys.stderr)
        return robot

    def _robot(self) -> Robot:
        if self.robot in DESCRIPTIONS:
            return Robot.named(self.robot)
        shapes = next((known for known in _GEOMETRIES if known == self.geometry), None)
        if shapes is None:
            raise InputError(
                f"geometry: must be collision, visual or collision_or_visual, not {self.geometry!r}"
            )
        load = partial(
            quietly,
            Robot.from_urdf,
            self.robot,
            package_dirs=[*(self.package_dir or []), *package_folders(self.robot)],
            floating_base=self.floating_base,
            geometry=shapes,
            missing_meshes="warn",
        )
        if not self.lock:
            return load()
        joints: dict[str, float] = {}
        known: tuple[str, ...] = ()
        for key, value in pairs("lock", self.lock, default="0").items():
            matching = [key]
            if "*" in key:
                known = known or load().joint_names
                matching = fnmatch.filter(known, key)
            joints.update(dict.fromkeys(matching, _number("lock", value)))
        return load(locked_joints=joints)

    def reading(self, sensors: Mapping[ForceTorqueSensor, str | None] | None = None) -> dict[str, Any]:
        """Arguments of `read_log` by name."""
        return {
            "columns": pairs("column", self.column),
            "topics": self.topic or None,
            "units": pairs("unit", self.unit),
            "torque_constants": numbers("torque-constants", self.torque_constants),
            "external": self.external,
            "rate": self.rate,
            "sensors": sensors or {},
        }

    def load_log(
        self, path: Path, robot: Robot, sensors: Mapping[ForceTorqueSensor, str | None] | None = None
    ) -> Log:
        """The log of a file with the readings of sensors; what was chosen is printed on stderr.

        Raises:
            InputError: the file cannot be read; names it.
        """
        try:
            log = read_log(path, robot, **self.reading(sensors))
        except OSError as cause:
            # Of several files, as of a bag, the one that it is.
            file = cause.filename or path
            raise InputError(f"log: cannot read '{file}': {cause.strerror or cause}") from cause
        print(log.reading, file=sys.stderr)
        return log


def pairs(option: str, given: Sequence[str] | None, default: str | None = None) -> dict[str, str]:
    """`NAME=VALUE` by name.

    Raises:
        InputError: there is no "=", where there is no default.
    """
    found = {}
    for text in given or ():
        name, equals, value = text.partition("=")
        if not equals and default is None:
            raise InputError(f"{option}: must be NAME=VALUE, not '{text}'")
        found[name] = value if equals else str(default)
    return found


def numbers(option: str, text: str | None) -> list[float] | float | None:
    """One number, or several with commas between them.

    Raises:
        InputError: one of them is no number.
    """
    if text is None:
        return None
    several = [_number(option, it) for it in text.split(",")]
    return several[0] if len(several) == 1 else several


def _number(option: str, text: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise InputError(f"{option}: must be a number, not '{text}'") from None

"""Options that the commands on logs share: the robot, and how its log is read."""

from __future__ import annotations

import fnmatch
import logging
import sys
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Annotated, Literal

import typer

from ..errors import InputError
from ..log import Log, read_log
from ..robot import DESCRIPTIONS, Robot

_Geometry = Literal["collision", "visual", "collision_or_visual"]
_GEOMETRIES: tuple[_Geometry, ...] = ("collision", "visual", "collision_or_visual")

RobotOption = Annotated[
    str, typer.Option("--robot", help=f"URDF of the robot, or the name of one of: {', '.join(DESCRIPTIONS)}.")
]
PackageOption = Annotated[
    list[Path] | None,
    typer.Option("--package-dir", help="Folder with the meshes of package:// names; may be repeated."),
]
LockedOption = Annotated[
    list[str] | None,
    typer.Option(
        "--lock",
        help="JOINT, JOINT=POSITION, or a pattern such as 'hand_*': joints that do not move.",
    ),
]
GeometryOption = Annotated[
    str, typer.Option("--geometry", help="Shapes of the surface: collision, visual or collision_or_visual.")
]
ColumnOption = Annotated[
    list[str] | None,
    typer.Option(
        "--column",
        help="QUANTITY=NAME, such as position='actual_q_*', with * for the joint; quantities are time, "
        "position, velocity, torque, external_torque, current; may be repeated.",
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
RateOption = Annotated[
    float | None,
    typer.Option("--rate", help="Interpolate to so many rows a second (default: rows as they are)."),
]


def load_robot(
    name: str, package_dirs: Sequence[Path] | None, locked: Sequence[str] | None, geometry: str
) -> Robot:
    """The robot of the options."""
    if name in DESCRIPTIONS:
        return Robot.named(name)
    shapes = next((known for known in _GEOMETRIES if known == geometry), None)
    if shapes is None:
        raise InputError(f"geometry: must be collision, visual or collision_or_visual, not {geometry!r}")
    folders = list(package_dirs or ())
    load = partial(Robot.from_urdf, name, package_dirs=folders, geometry=shapes, missing_meshes="warn")
    if not locked:
        return load()
    joints: dict[str, float] = {}
    known: tuple[str, ...] = ()
    for key, value in pairs("lock", locked, default="0").items():
        matching = [key]
        if "*" in key:
            known = known or _quietly(load).joint_names
            matching = fnmatch.filter(known, key)
        joints.update(dict.fromkeys(matching, _number("lock", value)))
    return load(locked_joints=joints)


def _quietly(load: Callable[[], Robot]) -> Robot:
    """Warnings of a robot are logged when it is loaded with its joints locked."""
    logger = logging.getLogger("contactsense")
    before, logger.disabled = logger.disabled, True
    try:
        return load()
    finally:
        logger.disabled = before


def load_log(
    path: Path,
    robot: Robot,
    columns: Sequence[str] | None,
    topics: Sequence[str] | None,
    units: Sequence[str] | None,
    constants: str | None,
    rate: float | None,
) -> Log:
    """The log of the options; what was chosen is printed on stderr."""
    numbers = None if constants is None else [_number("torque-constants", it) for it in constants.split(",")]
    log = read_log(
        path,
        robot,
        columns=pairs("column", columns),
        topics=topics or None,
        units=pairs("unit", units),
        torque_constants=numbers[0] if numbers is not None and len(numbers) == 1 else numbers,
        rate=rate,
    )
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


def _number(option: str, text: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise InputError(f"{option}: must be a number, not '{text}'") from None

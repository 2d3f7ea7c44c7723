"""Robots of the studies: packaged ones, those of URDF files, and those of the package example-robot-data."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path

from contactsense import Robot
from contactsense._extras import MissingExtraError
from contactsense.robot import DESCRIPTIONS

PACKAGE = "example-robot-data"
PANDA = "example-robot-data/robots/panda_description/urdf/panda.urdf"


def robot_of(name: str, package_dirs: Iterable[str | Path] = (), *, floating_base: bool = False) -> Robot:
    """A packaged robot by its name, or that of a URDF file, whose base may move freely."""
    if name in DESCRIPTIONS:
        return Robot.named(name)
    return Robot.from_urdf(name, package_dirs=package_dirs, floating_base=floating_base)


def share_folder() -> Path:
    """The folder that `package://` names of example-robot-data refer to.

    Raises:
        MissingExtraError: the package is not installed.
    """
    try:
        files = distribution(PACKAGE).files or []
    except PackageNotFoundError as cause:
        raise MissingExtraError(PACKAGE) from cause
    for file in files:
        if file.as_posix().endswith(PANDA):
            return Path(str(file.locate())).resolve().parents[len(Path(PANDA).parts) - 1]
    raise MissingExtraError(PACKAGE)


def panda() -> Robot:
    """Franka's arm with its hand, the fingers closed: `q` is the seven joints of the arm.

    Raises:
        MissingExtraError: example-robot-data is not installed.
    """
    share = share_folder()
    fingers = ("panda_finger_joint1", "panda_finger_joint2")
    return Robot.from_urdf(share / PANDA, package_dirs=share, locked_joints=fingers)


def example_robot(file: str) -> Robot:
    """An arm of example-robot-data, by its file below the folder of robots.

    Raises:
        MissingExtraError: example-robot-data is not installed.
    """
    share = share_folder()
    return Robot.from_urdf(share / PACKAGE / "robots" / file, package_dirs=share)


def available(
    named: Iterable[str], usual: Iterable[str], describe: Callable[[str], Robot]
) -> tuple[tuple[str, ...], dict[str, str]]:
    """The robots that a study can have, and of those left out what is missing.

    Args:
        named: those that somebody asked for, all of which must be there; if empty, the usual ones.
        usual: left out where they are not installed.
        describe: loads one by name.

    Raises:
        MissingExtraError: one that is named is not installed.
    """
    named = tuple(dict.fromkeys(named))
    there, skipped = [], {}
    for name in named or usual:
        try:
            describe(name)
        except MissingExtraError as missing:
            if named:
                raise
            skipped[name] = str(missing)
        else:
            there.append(name)
    return tuple(there), skipped

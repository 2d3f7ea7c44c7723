"""The files of a robot's description: where its meshes may be, and what is odd about them."""

from __future__ import annotations

import logging
import os
import re
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from ..robot import Robot

# A warning of one link is of its mesh.
_OF_MESH = re.compile(r"link '(.*?)': (?:mesh '(.*?)')?")
_MISSING = "the link has no surface there"


def package_folders(urdf: str) -> list[Path]:
    """Folders that hold ROS packages: that of the package in which the URDF lies, and those of the workspace.

    The workspace is the one that the shell has sourced (ROS_PACKAGE_PATH, AMENT_PREFIX_PATH).
    """
    own = [parent.parent for parent in Path(urdf).absolute().parents if (parent / "package.xml").is_file()]
    ros1 = [Path(entry) for entry in _entries("ROS_PACKAGE_PATH")]
    ros2 = [Path(entry) / "share" for entry in _entries("AMENT_PREFIX_PATH")]
    return [folder for folder in dict.fromkeys([*own, *ros1, *ros2]) if folder.is_dir()]


def _entries(variable: str) -> list[str]:
    return [entry for entry in os.environ.get(variable, "").split(os.pathsep) if entry]


def quietly(load: Callable[..., Robot], *arguments: Any, **options: Any) -> Robot:
    """Without the warnings in the log: they are printed in short."""
    logger = logging.getLogger("contactsense")
    before, logger.disabled = logger.disabled, True
    try:
        return load(*arguments, **options)
    finally:
        logger.disabled = before


def summary(warnings: Sequence[str]) -> list[str]:
    """Warnings of a robot; those of meshes, of which there may be hundreds, as one line of each kind."""
    of_meshes = [(found, text) for text in warnings if (found := _OF_MESH.match(text))]
    told = [text for text in warnings if not _OF_MESH.match(text)]
    missing = [found for found, text in of_meshes if text.endswith(_MISSING)]
    if missing:
        links = len({found[1] for found in missing})
        told.append(
            f"meshes of {links} links were not found, such as '{missing[0][2]}', and these links have no "
            "surface: name the folder that holds the robot's packages with --package-dir"
        )
    odd = [found for found, text in of_meshes if not text.endswith(_MISSING)]
    if odd:
        links = len({found[1] for found in odd})
        told.append(f"meshes of {links} links are open or were repaired; Robot.warnings lists {len(odd)}")
    return told

"""Pinocchio models to simulate and control with."""

from __future__ import annotations

import os
import xml.etree.ElementTree as ET
from importlib import resources
from pathlib import Path

import pinocchio as pin

from contactsense.errors import ModelError
from contactsense.robot import Robot, description_file

from .geoms import Geom, geoms_of

_FLOATING = {"iiwa14": False, "atlas": True}


def model_from_urdf(path: str | os.PathLike[str], *, floating_base: bool = False) -> pin.Model:
    """Joints and inertias of a URDF file; shapes are left out, so no mesh need be there.

    Raises:
        ModelError: the file cannot be read as a robot.
    """
    try:
        return _model(Path(path).read_text(encoding="utf-8"), floating_base)
    except (OSError, ET.ParseError, ValueError, RuntimeError) as cause:
        raise ModelError(f"'{os.fspath(path)}' cannot be read as a URDF: {cause}") from cause


def named_model(name: str) -> pin.Model:
    """A robot described in this package: "iiwa14" (fixed base) or "atlas" (free base)."""
    with resources.as_file(description_file(name)) as path:
        return model_from_urdf(path, floating_base=_FLOATING[name])


def named_geoms(name: str, *, contype: int = 0, conaffinity: int = 0) -> tuple[Geom, ...]:
    """The shapes of a robot described in this package; masks as in `geoms_of`."""
    return geoms_of(Robot.named(name)._description.links, contype=contype, conaffinity=conaffinity)


def _model(text: str, floating_base: bool) -> pin.Model:
    root = ET.fromstring(text)
    # Some URDF parsers know no capsule, and say so on standard error.
    for link in root.findall("link"):
        for part in link.findall("visual") + link.findall("collision"):
            link.remove(part)
    free = (pin.JointModelFreeFlyer(),) if floating_base else ()
    return pin.buildModelFromXML(ET.tostring(root, encoding="unicode"), *free)

"""Exact primitives attached to the simulated bodies, for contact or for looking at."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np

from contactsense import Robot
from contactsense.errors import GeometryError
from contactsense.loading.description import GeometryTuple, LinkTuple

from ._arrays import FloatArray
from ._text import pose_attributes, text


@dataclass(frozen=True)
class Geom:
    """One primitive fixed to the body behind a joint.

    `size` is MuJoCo's [m]: box half-lengths (3); sphere (radius); cylinder and capsule (radius, half length).
    `contype` and `conaffinity` are MuJoCo's contact masks; zero collides with nothing.
    """

    name: str
    joint: int  # 0 = world, k = k-th joint of the Pinocchio model
    kind: Literal["box", "sphere", "cylinder", "capsule"]
    size: tuple[float, ...]
    pose: FloatArray = field(default_factory=lambda: np.eye(4))  # (4, 4) in the joint's frame
    contype: int = 0
    conaffinity: int = 0

    def write(self, body: ET.Element) -> None:
        """Add the `<geom>` to a `<body>` or `<worldbody>`."""
        element = ET.SubElement(body, "geom", pose_attributes(self.pose), name=self.name, type=self.kind)
        element.set("size", text(self.size))
        element.set("mass", "0")
        element.set("contype", str(self.contype))
        element.set("conaffinity", str(self.conaffinity))


def geoms_of(links: Iterable[LinkTuple], *, contype: int = 0, conaffinity: int = 0) -> tuple[Geom, ...]:
    """The shapes of a loaded description's links, named `link:number`.

    Raises:
        GeometryError: a mesh. MuJoCo would collide its convex hull, on real links centimetres off.
    """
    masks: dict[str, Any] = {"contype": contype, "conaffinity": conaffinity}
    return tuple(
        _geom(link, f"{link.name}:{number}", shape, masks)
        for link in links
        for number, shape in enumerate(link.geometry)
    )


def _geom(link: LinkTuple, name: str, shape: GeometryTuple, masks: dict[str, Any]) -> Geom:
    pose = link.placement @ shape.placement
    if shape.kind == "box":
        size = tuple(0.5 * float(length) for length in shape.params)
        return Geom(name, link.joint, "box", size, pose, **masks)
    if shape.kind == "sphere":
        return Geom(name, link.joint, "sphere", (float(shape.params[0]),), pose, **masks)
    if shape.kind == "cylinder" or shape.kind == "capsule":
        radius, length = shape.params
        return Geom(name, link.joint, shape.kind, (float(radius), 0.5 * float(length)), pose, **masks)
    raise GeometryError(
        f"link '{link.name}' has a mesh; only boxes, spheres, cylinders, capsules are simulated"
    )


def named_geoms(name: str, *, contype: int = 0, conaffinity: int = 0) -> tuple[Geom, ...]:
    """The shapes of a robot described in this package; masks as in `geoms_of`."""
    return geoms_of(Robot.named(name)._description.links, contype=contype, conaffinity=conaffinity)

"""A URDF file as a checked tree of links and joints."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

import numpy as np

from ..errors import ModelError
from .description import SUPPORTED_JOINTS, FloatArray, name_list
from .regular_file import read_regular_file
from .xml_numbers import number_attribute, origin, parse_numbers

MOVING = ("revolute", "continuous", "prismatic")

# Larger files are not read [bytes]: 20 times the largest URDF published.
_LARGEST_FILE = 1 << 24

# Parsers of URDF descend one call per link.
_MAX_DEPTH = 1000


@dataclass(frozen=True)
class UrdfInertial:
    """Mass [kg] and inertia [kg m^2] of a link, at a placement in the link's frame."""

    xyz: list[float]
    rpy: list[float]
    mass: float
    moments: dict[str, float]

    @property
    def inertia(self) -> FloatArray:
        """(3, 3), about the centre of mass, in the inertial frame's axes."""
        m = self.moments
        rows = [
            [m["ixx"], m["ixy"], m["ixz"]],
            [m["ixy"], m["iyy"], m["iyz"]],
            [m["ixz"], m["iyz"], m["izz"]],
        ]
        return np.array(rows)


@dataclass(frozen=True)
class UrdfLink:
    """A link; `element` still holds its geometry."""

    name: str
    inertial: UrdfInertial | None
    element: Element


@dataclass(frozen=True)
class UrdfJoint:
    """A fixed or moving joint between two links; angles [rad], lengths [m], efforts [N] or [Nm]."""

    name: str
    kind: str
    parent: str
    child: str
    xyz: list[float]
    rpy: list[float]
    axis: list[float]
    limit: dict[str, float] | None
    mimics: str | None


@dataclass(frozen=True)
class UrdfTree:
    """All links and joints of a URDF; they form one tree."""

    name: str
    links: dict[str, UrdfLink]
    joints: dict[str, UrdfJoint]

    @property
    def moving(self) -> list[UrdfJoint]:
        """The joints that are not fixed, in the file's order."""
        return [joint for joint in self.joints.values() if joint.kind in MOVING]


def read_urdf(path: Path) -> UrdfTree:
    """Read and check a URDF file; `ModelError` names the element that is wrong."""
    try:
        # Bytes, so that the XML declaration decides the encoding.
        robot = ElementTree.fromstring(read_regular_file(path, _LARGEST_FILE))
    except OSError as cause:
        raise ModelError(f"cannot read the URDF file '{path}': {cause.strerror or cause}") from cause
    except (ElementTree.ParseError, ValueError, LookupError) as cause:
        raise ModelError(f"'{path}' is not XML: {cause}") from cause
    if robot.tag != "robot":
        raise ModelError(f"'{path}' is not a URDF: its root element is <{robot.tag}>, not <robot>")
    links = [_link(element) for element in robot.findall("link")]
    if not links:
        raise ModelError(f"'{path}' has no links (a xacro file must be expanded first)")
    joints = [_joint(element) for element in robot.findall("joint")]
    _require_unique("link", (link.name for link in links))
    _require_unique("joint", (joint.name for joint in joints))
    tree = UrdfTree(
        robot.get("name") or path.stem,
        {link.name: link for link in links},
        {joint.name: joint for joint in joints},
    )
    _require_tree(tree)
    return tree


def _link(element: Element) -> UrdfLink:
    name = element.get("name")
    if not name:
        raise ModelError("a <link> has no name")
    found = element.find("inertial")
    if found is None:
        return UrdfLink(name, None, element)
    owner = f"link '{name}'"
    mass, inertia = found.find("mass"), found.find("inertia")
    if mass is None or inertia is None:
        raise ModelError(f"{owner}: <inertial> needs <mass> and <inertia>")
    # Products of inertia may be left out; URDF's default is zero.
    moments = {
        key: number_attribute(inertia, key, owner, ModelError, None if key[1] == key[2] else 0.0)
        for key in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
    }
    value = number_attribute(mass, "value", owner, ModelError)
    return UrdfLink(name, UrdfInertial(*origin(found, owner, ModelError), value, moments), element)


def _joint(element: Element) -> UrdfJoint:
    name = element.get("name")
    if not name:
        raise ModelError("a <joint> has no name")
    owner = f"joint '{name}'"
    kind = element.get("type", "")
    if kind not in (*MOVING, "fixed"):
        hint = "; for a floating base use floating_base=True" if kind == "floating" else ""
        raise ModelError(f"{owner} has the type '{kind}'; supported: {SUPPORTED_JOINTS}{hint}")
    parent, child = (_end(element, end, owner) for end in ("parent", "child"))
    mimic = element.find("mimic")
    axis, limit = (
        ([1.0, 0.0, 0.0], None) if kind == "fixed" else (_axis(element, owner), _limit(element, owner))
    )
    if limit is None and kind in ("revolute", "prismatic"):
        raise ModelError(
            f"{owner} is {kind} and needs <limit> (a revolute joint without limits is 'continuous')"
        )
    mimics = None if mimic is None else mimic.get("joint", "")
    return UrdfJoint(name, kind, parent, child, *origin(element, owner, ModelError), axis, limit, mimics)


def _end(element: Element, end: str, owner: str) -> str:
    found = element.find(end)
    link = None if found is None else found.get("link")
    if not link:
        raise ModelError(f'{owner} needs <{end} link="..."/>')
    return link


def _axis(element: Element, owner: str) -> list[float]:
    found = element.find("axis")
    if found is None:
        return [1.0, 0.0, 0.0]
    axis = parse_numbers(found.get("xyz", ""), 3, f"{owner}: 'xyz' of <axis>", ModelError)
    if not 1e-6 < math.hypot(*axis) < 1e6:
        raise ModelError(
            f"{owner}: <axis> must be a direction of about unit length, not '{found.get('xyz')}'"
        )
    return axis


def _limit(element: Element, owner: str) -> dict[str, float] | None:
    found = element.find("limit")
    if found is None:
        return None
    # A large finite value stands for "unlimited": it is what Pinocchio's URDF reader accepts.
    unlimited = float(np.finfo(np.float64).max)
    defaults = {"lower": 0.0, "upper": 0.0, "effort": unlimited, "velocity": unlimited}
    limit = {
        key: number_attribute(found, key, owner, ModelError, value, unlimited)
        for key, value in defaults.items()
    }
    for key in ("effort", "velocity"):
        if limit[key] < 0.0:
            raise ModelError(f"{owner}: '{key}' of <limit> must not be negative, not {limit[key]:g}")
    return limit


def _require_unique(what: str, names: Iterable[str]) -> None:
    twice = [name for name, count in Counter(names).items() if count > 1]
    if twice:
        raise ModelError(f"{what} names must be unique; given more than once: {name_list(twice)}")


def _require_tree(tree: UrdfTree) -> None:
    parents: dict[str, str] = {}
    children: dict[str, list[str]] = {name: [] for name in tree.links}
    for joint in tree.joints.values():
        for end in (joint.parent, joint.child):
            if end not in tree.links:
                raise ModelError(
                    f"joint '{joint.name}' names the link '{end}', which the description does not have"
                )
        if joint.child in parents:
            raise ModelError(
                f"link '{joint.child}' has two parents, '{parents[joint.child]}' and '{joint.parent}'; "
                "the links must form a tree"
            )
        parents[joint.child] = joint.parent
        children[joint.parent].append(joint.child)
    roots = [name for name in tree.links if name not in parents]
    if len(roots) > 1:
        raise ModelError(
            f"the links must form one tree with one root; links without a parent: {name_list(roots)}"
        )
    level, reached, depth = roots, set(roots), 0
    while level and depth <= _MAX_DEPTH:
        level = [child for name in level for child in children[name]]
        reached.update(level)
        depth += 1
    if level:
        raise ModelError(f"the chain of links down to '{level[0]}' is longer than {_MAX_DEPTH}")
    cycle = [name for name in tree.links if name not in reached]
    if cycle:
        raise ModelError(f"the links must form a tree; these form a cycle: {name_list(cycle)}")

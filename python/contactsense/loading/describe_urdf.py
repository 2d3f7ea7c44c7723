"""A robot description from a URDF file."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any
from xml.etree import ElementTree
from xml.etree.ElementTree import Element, SubElement

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from ..errors import InputError, ModelError
from .description import FloatArray, LinkTuple, RobotDescription, check_finite
from .inertia import check_bodies, check_inertias, check_mass_matrix
from .locked import LockedJoints, lock_joints
from .meshes import MeshFinder, PackageDirs
from .oddities import oddities
from .pinocchio_links import links_of
from .pinocchio_model import joints_of
from .shapes import link_shapes
from .urdf_tree import UrdfTree, read_urdf

_ROOT_JOINT = "root_joint"  # Pinocchio's name for the joint it adds
_LINK = "link:"  # keeps a link apart from a joint of the same name, which Pinocchio cannot lock


def describe_urdf(
    path: str | os.PathLike[str],
    *,
    package_dirs: PackageDirs = (),
    floating_base: bool = False,
    locked_joints: LockedJoints = None,
    geometry: str = "collision",
    gravity: ArrayLike = (0.0, 0.0, -9.81),
) -> RobotDescription:
    """Read a URDF.

    `q` and `v` are ordered as in `pinocchio.buildModelFromUrdf`; links as in its frames, depth-first.
    Mesh files come from the URDF's folder and `package_dirs` only. `locked_joints` fixes joints at given
    positions ({name: position [rad] or [m]}) or, for plain names, at neutral. `geometry` is "collision" or
    "visual"; `gravity` is (3,) in the world frame [m/s^2].

    Raises `ModelError`, `GeometryError` for the description, `InputError` for the arguments.
    """
    if not isinstance(floating_base, bool | np.bool_):
        raise InputError(f"floating_base must be True or False, not {floating_base!r}")
    if not isinstance(geometry, str) or geometry not in ("collision", "visual"):
        raise InputError(f"geometry: must be 'collision' or 'visual', not {geometry!r}")
    acceleration = _gravity(gravity)
    try:
        file = Path(path)
        file.resolve()
    except (TypeError, ValueError, OSError, RuntimeError) as cause:
        raise InputError(f"path: must be a path to a URDF file, not {path!r}") from cause
    meshes = MeshFinder(file, package_dirs)
    tree = read_urdf(file)
    _check_reserved_names(tree, floating_base)
    warnings = oddities(tree) + check_inertias("link", _inertias(tree))
    full = _kinematics(tree, floating_base)
    model, lock_warnings = lock_joints(full, tree, locked_joints)
    joints = joints_of(model)
    placed = {link.name: link for link in links_of(model)[0].values()}
    links = []
    for link in links_of(full)[0].values():
        name = link.name.removeprefix(_LINK)
        # Links and parents as they are without locked joints; only where they sit differs.
        links.append(
            link._replace(
                name=name,
                joint=placed[link.name].joint,
                placement=placed[link.name].placement,
                geometry=link_shapes(tree.links[name].element, name, geometry, meshes),
            )
        )
    check_finite(joints, links)
    check_bodies(joints, links)
    warnings += lock_warnings + check_mass_matrix(joints) + _no_surface(links, geometry)
    return RobotDescription(tree.name, joints, links, acceleration, warnings)


def _inertias(tree: UrdfTree) -> Iterator[tuple[str, float, FloatArray]]:
    for link in tree.links.values():
        if link.inertial is not None:
            yield link.name, link.inertial.mass, link.inertial.inertia


def _gravity(gravity: ArrayLike) -> FloatArray:
    try:
        vector = np.array(gravity, dtype=np.float64)
    except (TypeError, ValueError, OverflowError) as cause:
        raise InputError(f"gravity: must be 3 finite numbers [m/s^2], not {gravity!r}") from cause
    if vector.shape != (3,) or not np.isfinite(vector).all():
        raise InputError(f"gravity: must be 3 finite numbers [m/s^2], not {gravity!r}")
    return vector


def _check_reserved_names(tree: UrdfTree, floating_base: bool) -> None:
    for name in ("universe", _ROOT_JOINT) if floating_base else ("universe",):
        if name in tree.joints:
            raise ModelError(f"joint '{name}' has a name that Pinocchio uses itself; rename it")


def _no_surface(links: list[LinkTuple], geometry: str) -> list[str]:
    if any(link.geometry for link in links):
        return []
    return [f"No link has <{geometry}> geometry, so the robot has no surface to be touched"]


def _kinematics(tree: UrdfTree, floating_base: bool) -> Any:
    root = (pin.JointModelFreeFlyer(),) if floating_base else ()
    try:
        return pin.buildModelFromXML(_kinematic_xml(tree), *root)
    except (ValueError, RuntimeError) as cause:
        raise ModelError(f"Pinocchio cannot build the robot '{tree.name}': {cause}") from cause


def _kinematic_xml(tree: UrdfTree) -> str:
    """The URDF reduced to what the kinematics and inertias need, every number checked."""
    robot = Element("robot", name=tree.name)
    for link in tree.links.values():
        element = SubElement(robot, "link", name=_LINK + link.name)
        if link.inertial is not None:
            inertial = SubElement(element, "inertial")
            _origin(inertial, link.inertial.xyz, link.inertial.rpy)
            SubElement(inertial, "mass", value=repr(link.inertial.mass))
            SubElement(inertial, "inertia", _texts(link.inertial.moments))
    for joint in tree.joints.values():
        element = SubElement(robot, "joint", name=joint.name, type=joint.kind)
        SubElement(element, "parent", link=_LINK + joint.parent)
        SubElement(element, "child", link=_LINK + joint.child)
        SubElement(element, "axis", xyz=_row(joint.axis))
        _origin(element, joint.xyz, joint.rpy)
        if joint.limit is not None:
            SubElement(element, "limit", _texts(joint.limit))
    return ElementTree.tostring(robot, encoding="unicode")


def _origin(element: Element, xyz: Iterable[float], rpy: Iterable[float]) -> None:
    SubElement(element, "origin", xyz=_row(xyz), rpy=_row(rpy))


def _row(values: Iterable[float]) -> str:
    return " ".join(map(repr, values))


def _texts(values: Mapping[str, float]) -> dict[str, str]:
    return {key: repr(value) for key, value in values.items()}

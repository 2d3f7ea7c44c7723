"""What a loader hands on: the robot as plain names, numbers and arrays."""

from __future__ import annotations

from typing import Any, Literal, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

FloatArray: TypeAlias = NDArray[np.float64]
JointKind: TypeAlias = Literal["free_flyer", "revolute", "continuous", "prismatic"]
GeometryKind: TypeAlias = Literal["mesh", "box", "cylinder", "sphere", "capsule"]
# Kind and parameters of a shape: "mesh" (vertices (n, 3), triangles (m, 3) uint32); "box" (x, y, z), full
# extents; "cylinder" (radius, length); "sphere" (radius,); "capsule" (radius, length of the cylindrical
# part). Cylinders and capsules lie along their z axis.
Shape: TypeAlias = tuple[GeometryKind, tuple[Any, ...]]


class JointTuple(NamedTuple):
    """A moving joint with the rigid body behind it; everything in the joint's own frame, SI units."""

    name: str
    parent: int  # 0 = world, k = k-th joint
    kind: JointKind
    axis: FloatArray  # (3,), unit; zero for a free flyer
    placement: FloatArray  # (4, 4), in the parent joint's frame
    mass: float
    com: FloatArray  # (3,)
    inertia: FloatArray  # (3, 3), about the centre of mass
    armature: float
    lower: float  # -inf where unlimited
    upper: float
    effort: float  # inf where unlimited
    velocity: float


class GeometryTuple(NamedTuple):
    """A shape of a link."""

    kind: GeometryKind
    params: tuple[Any, ...]
    placement: FloatArray  # (4, 4), in the link's frame


class LinkTuple(NamedTuple):
    """A link: a named frame fixed to a joint, with its shapes."""

    name: str
    joint: int  # 0 = world, k = k-th joint
    placement: FloatArray  # (4, 4), in the joint's frame
    parent: int | None  # position of the link that its joint, fixed or moving, hangs from; None for the root
    mass: float  # its own: of the joint's body, the part that is this link's
    com: FloatArray  # (3,), in the link's frame
    inertia: FloatArray  # (3, 3), about the centre of mass
    geometry: list[GeometryTuple]


class RobotDescription(NamedTuple):
    """A robot for the core, which checks it: joints in the order of Pinocchio's model, links depth-first."""

    name: str
    joints: list[JointTuple]
    links: list[LinkTuple]
    gravity: FloatArray  # (3,), world frame [m/s^2]
    warnings: list[str]


def name_list(names: list[str], limit: int = 12) -> str:
    """Names for a message, quoted; a long list is cut and says by how many."""
    shown = ", ".join(f"'{name}'" for name in names[:limit])
    return shown if len(names) <= limit else f"{shown} and {len(names) - limit} more"

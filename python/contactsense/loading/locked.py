"""Joints held at a fixed position."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Any, SupportsFloat, TypeAlias

import pinocchio as pin

from ..errors import InputError
from .description import name_list
from .urdf_tree import UrdfJoint, UrdfTree

# `buildReducedModel` makes a `pinocchio.Data`, whose memory grows with the cube of the joints: half a GB
# for 200.
_MOST_JOINTS = 200

LockedJoints: TypeAlias = Mapping[str, SupportsFloat] | Iterable[str] | None


def lock_joints(model: Any, tree: UrdfTree, locked: LockedJoints) -> tuple[Any, list[str]]:
    """The model without the locked joints, their links kept where they then are, and warnings.

    `InputError` lists the valid names.
    """
    positions = _positions(locked, tree)
    if not positions:
        return model, []
    if model.njoints - 1 > _MOST_JOINTS:
        raise InputError(
            f"locked_joints: joints can be locked in robots of up to {_MOST_JOINTS} moving joints, not "
            f"{model.njoints - 1}; make them fixed joints in the URDF"
        )
    q = pin.neutral(model)
    outside = []
    for name, position in positions.items():
        joint = model.joints[model.getJointId(name)]
        if joint.nq == 2:  # continuous: (cos, sin)
            q[joint.idx_q : joint.idx_q + 2] = math.cos(position), math.sin(position)
        else:
            q[joint.idx_q] = position
        if not _within_limits(tree.joints[name], position):
            outside.append(name)
    reduced = pin.buildReducedModel(model, sorted(model.getJointId(name) for name in positions), q)
    if not outside:
        return reduced, []
    return reduced, [f"These joints are locked outside their limits: {name_list(outside)}"]


def _positions(locked: LockedJoints, tree: UrdfTree) -> dict[str, float]:
    if locked is None:
        return {}
    valid = [joint.name for joint in tree.moving]
    wanted = f"locked_joints must be {{name: position}} or names; valid names: {name_list(valid, len(valid))}"
    if isinstance(locked, str | bytes) or not isinstance(locked, Iterable):
        raise InputError(f"{wanted}; not {locked!r}")
    positions: dict[str, float] = {}
    for name, value in locked.items() if isinstance(locked, Mapping) else ((name, 0.0) for name in locked):
        if not isinstance(name, str) or name not in valid:
            raise InputError(f"{wanted}; {name!r} is none of them")
        try:
            positions[name] = math.nan if isinstance(value, str | bytes | bool) else float(value)
        except (TypeError, ValueError, OverflowError):
            positions[name] = math.nan
        if not math.isfinite(positions[name]):
            raise InputError(
                f"locked_joints: the position of '{name}' must be a finite number, not {value!r}"
            )
    return positions


def _within_limits(joint: UrdfJoint, position: float) -> bool:
    if joint.kind == "continuous" or joint.limit is None:
        return True
    return joint.limit["lower"] <= position <= joint.limit["upper"]

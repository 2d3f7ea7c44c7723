"""Joints of a Pinocchio model as plain arrays."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ..errors import ModelError
from .description import FloatArray, JointKind, JointTuple

_KINDS: dict[str, JointKind] = {
    "JointModelFreeFlyer": "free_flyer",
    **dict.fromkeys([f"JointModelR{axis}" for axis in ("X", "Y", "Z", "evoluteUnaligned")], "revolute"),
    **dict.fromkeys([f"JointModelRUB{axis}" for axis in "XYZ"], "continuous"),
    "JointModelRevoluteUnboundedUnaligned": "continuous",
    **dict.fromkeys([f"JointModelP{axis}" for axis in ("X", "Y", "Z", "rismaticUnaligned")], "prismatic"),
}

_SUPPORTED = "revolute, continuous, prismatic, fixed, and a free flyer as the root"

# Pinocchio writes "unlimited" as the largest float.
_UNLIMITED = 1e300


def joints_of(model: Any) -> list[JointTuple]:
    """Every joint but the universe, in the model's order; `ModelError` names an unsupported joint."""
    return [_joint(model, index) for index in range(1, model.njoints)]


def _pose(placement: Any) -> FloatArray:
    return np.array(placement.homogeneous, dtype=np.float64)


def _joint(model: Any, index: int) -> JointTuple:
    joint, name = model.joints[index], str(model.names[index])
    kind = _KINDS.get(joint.shortname())
    if kind is None:
        raise ModelError(f"joint '{name}' is a {joint.shortname()}; supported: {_SUPPORTED}")
    if kind == "free_flyer" and (index != 1 or model.parents[1] != 0):
        raise ModelError(
            f"joint '{name}' is a free flyer inside the robot; a free flyer can only be the root joint"
        )
    inertia = model.inertias[index]
    lower, upper, effort, velocity = -math.inf, math.inf, math.inf, math.inf
    if kind != "free_flyer":
        effort = _limit(model.effortLimit[joint.idx_v])
        velocity = _limit(model.velocityLimit[joint.idx_v])
    if kind in ("revolute", "prismatic"):
        lower = _limit(model.lowerPositionLimit[joint.idx_q])
        upper = _limit(model.upperPositionLimit[joint.idx_q])
    return JointTuple(
        name=name,
        parent=int(model.parents[index]),
        kind=kind,
        axis=_axis(joint, kind),
        placement=_pose(model.jointPlacements[index]),
        mass=float(inertia.mass),
        com=np.array(inertia.lever, dtype=np.float64),
        inertia=np.array(inertia.inertia, dtype=np.float64),
        armature=0.0 if kind == "free_flyer" else float(model.armature[joint.idx_v]),
        lower=lower,
        upper=upper,
        effort=effort,
        velocity=velocity,
    )


def _axis(joint: Any, kind: JointKind) -> FloatArray:
    if kind == "free_flyer":
        return np.zeros(3)
    # The motion subspace holds the axis for every joint model; an `axis` attribute only some have.
    data = joint.createData()
    joint.calc(data, np.array([1.0, 0.0])[: joint.nq])
    subspace = np.asarray(data.S, dtype=np.float64).reshape(6)
    return subspace[:3].copy() if kind == "prismatic" else subspace[3:].copy()


def _limit(value: float) -> float:
    return math.copysign(math.inf, value) if abs(value) >= _UNLIMITED else float(value)

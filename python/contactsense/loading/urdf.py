"""A robot from a URDF file: checked by the core, built by Pinocchio."""

from __future__ import annotations

import math
import os
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, NamedTuple, SupportsFloat, TypeAlias

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from .. import _core
from ..errors import InputError, ModelError
from .describe_pinocchio import describe_pinocchio
from .description import FloatArray, JointTuple, RobotDescription, Shape, name_list
from .pinocchio_links import is_body
from .pinocchio_model import joints_of

# `buildReducedModel` makes a `pinocchio.Data`, whose memory grows with the cube of the joints: half a GB
# for 200.
_MOST_JOINTS = 200

PackageDirs: TypeAlias = str | os.PathLike[str] | Iterable[str | os.PathLike[str]]
LockedJoints: TypeAlias = Mapping[str, SupportsFloat] | Iterable[str] | None


class Loaded(NamedTuple):
    """A robot as the core and as Pinocchio take it."""

    description: RobotDescription
    model: Any  # pinocchio.Model
    geometry_model: Any  # pinocchio.GeometryModel, in which spheres stand for `shapes`
    shapes: dict[str, Shape]  # meshes and capsules, by the name of the geometry object


def load_urdf(
    path: str | os.PathLike[str],
    *,
    package_dirs: PackageDirs,
    floating_base: bool,
    locked_joints: LockedJoints,
    geometry: str,
    gravity: ArrayLike,
    armature: Mapping[str, SupportsFloat] | None,
    missing_meshes: str,
) -> Loaded:
    """Load a URDF file; the arguments are those of `Robot.from_urdf`."""
    if not isinstance(floating_base, bool | np.bool_):
        raise InputError(f"floating_base: must be True or False, not {floating_base!r}")
    acceleration = _gravity(gravity)
    for argument, value in (("geometry", geometry), ("missing_meshes", missing_meshes)):
        if not isinstance(value, str):
            raise InputError(f"{argument}: must be a string, not {value!r}")
    xml, shapes, warnings = _core._checked_urdf(
        _path("path", path), _paths(package_dirs), bool(floating_base), geometry, missing_meshes
    )
    root = (pin.JointModelFreeFlyer(),) if floating_base else ()
    try:
        full = pin.buildModelFromXML(xml, *root)
        objects = pin.buildGeomFromUrdfString(full, xml, pin.GeometryType.COLLISION)
    except (ValueError, RuntimeError) as cause:
        raise ModelError(f"Pinocchio cannot build the robot of '{path}': {cause}") from cause
    full.gravity.linear = acceleration
    _set_armature(full, armature)
    locked = _by_joint("locked_joints", locked_joints, full)
    model, objects = _lock(full, objects, locked)
    outside = _outside_limits(full, locked)
    if outside:
        warnings.append(f"These joints are locked outside their limits: {name_list(outside)}")
    for renamed in (full, model) if locked else (model,):
        for frame in filter(is_body, renamed.frames):
            frame.name = frame.name.removeprefix(_core._LINK_PREFIX)
    for item in objects.geometryObjects:
        item.name = item.name.removeprefix(_core._LINK_PREFIX)
    standing_for = {f"{link}_{place}": shape for link, place, shape in shapes}
    description = describe_pinocchio(model, objects, standing_for, full if locked else None)
    return Loaded(
        description._replace(warnings=warnings + description.warnings), model, objects, standing_for
    )


def _path(argument: str, path: Any) -> Path:
    try:
        found = Path(path)
    except TypeError as cause:
        raise InputError(f"{argument}: must be a path, not {path!r}") from cause
    if "\0" in str(found):
        raise InputError(f"{argument}: must be a path without zero bytes, not {path!r}")
    return found


def _paths(package_dirs: PackageDirs) -> list[Path]:
    given = [package_dirs] if isinstance(package_dirs, str | os.PathLike) else package_dirs
    if not isinstance(given, Iterable) or isinstance(given, bytes):
        raise InputError(f"package_dirs: must be a folder or folders that hold packages, not {given!r}")
    return [_path("package_dirs", folder).absolute() for folder in given]


def _gravity(gravity: ArrayLike) -> FloatArray:
    try:
        vector = np.array(gravity, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        vector = np.zeros(0)
    if vector.shape != (3,) or not np.isfinite(vector).all():
        raise InputError(f"gravity: must be 3 finite numbers [m/s^2], not {gravity!r}")
    return vector


def _set_armature(model: Any, armature: Mapping[str, SupportsFloat] | None) -> None:
    if armature is not None and not isinstance(armature, Mapping):
        raise InputError(f"armature: must be {{joint: kg m^2}}, not {armature!r}")
    for name, value in _by_joint("armature", armature, model).items():
        if value < 0.0:
            raise InputError(f"armature: the value of '{name}' must not be negative, not {value}")
        model.armature[model.joints[model.getJointId(name)].idx_v] = value


def _by_joint(argument: str, given: Any, model: Any) -> dict[str, float]:
    """{name: value} of joints that an actuator moves; 0 for names alone."""
    if given is None:
        return {}
    first = 2 if model.njoints > 1 and model.joints[1].nv == 6 else 1
    valid = [str(name) for name in list(model.names)[first:]]
    wanted = f"{argument}: must be {{joint: value}} or names; valid names: {name_list(valid, len(valid))}"
    if isinstance(given, str | bytes) or not isinstance(given, Iterable):
        raise InputError(f"{wanted}; not {given!r}")
    values: dict[str, float] = {}
    for name, value in given.items() if isinstance(given, Mapping) else ((name, 0.0) for name in given):
        if not isinstance(name, str) or name not in valid:
            raise InputError(f"{wanted}; {name!r} is none of them")
        try:
            values[name] = math.nan if isinstance(value, str | bytes | bool) else float(value)
        except (TypeError, ValueError, OverflowError):
            values[name] = math.nan
        if not math.isfinite(values[name]):
            raise InputError(f"{argument}: the value of '{name}' must be a finite number, not {value!r}")
    return values


def _lock(model: Any, objects: Any, positions: dict[str, float]) -> tuple[Any, Any]:
    """Models without the locked joints, their links kept where they then are."""
    if not positions:
        return model, objects
    if model.njoints - 1 > _MOST_JOINTS:
        raise InputError(
            f"locked_joints: joints can be locked in robots of up to {_MOST_JOINTS} moving joints, not "
            f"{model.njoints - 1}; make them fixed joints in the URDF"
        )
    q = pin.neutral(model)
    for name, position in positions.items():
        joint = model.joints[model.getJointId(name)]
        if joint.nq == 2:  # continuous: (cos, sin)
            q[joint.idx_q : joint.idx_q + 2] = math.cos(position), math.sin(position)
        else:
            q[joint.idx_q] = position
    reduced, shapes = pin.buildReducedModel(
        model, objects, sorted(model.getJointId(name) for name in positions), q
    )
    return reduced, shapes


def _outside_limits(model: Any, positions: dict[str, float]) -> list[str]:
    joints: dict[str, JointTuple] = {joint.name: joint for joint in joints_of(model)} if positions else {}
    return [
        name for name, value in positions.items() if not joints[name].lower <= value <= joints[name].upper
    ]

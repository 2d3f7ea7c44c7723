"""A robot description from a Pinocchio model and its geometry model."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin

from ..errors import InputError, ModelError
from .coal import shape_of
from .description import GeometryTuple, LinkTuple, RobotDescription, check_finite
from .inertia import check_bodies, check_inertias, check_mass_matrix
from .pinocchio_links import is_body, links_of
from .pinocchio_model import joints_of


def describe_pinocchio(model: Any, geometry_model: Any) -> RobotDescription:
    """Read a `pinocchio.Model` and the `pinocchio.GeometryModel` built for it.

    Links are the BODY frames, in the model's order; a shape belongs to the BODY frame it sits in or behind.
    A joint without any BODY frame whose body has shapes gives a link of the joint's name.

    Raises `InputError` for the arguments, `ModelError` for joints, inertias and gravity that are not
    supported, `GeometryError` for shapes.
    """
    if not isinstance(model, pin.Model):
        raise InputError(f"model must be a pinocchio.Model, not {type(model).__name__}")
    if not isinstance(geometry_model, pin.GeometryModel):
        raise InputError(
            f"geometry_model must be a pinocchio.GeometryModel, not {type(geometry_model).__name__}"
        )
    gravity = np.array(model.gravity.linear, dtype=np.float64)
    if not np.isfinite(gravity).all() or np.any(model.gravity.angular):
        raise ModelError(f"model.gravity must be a finite linear acceleration, not {model.gravity}")
    joints = joints_of(model)
    links, warnings = _links(model, geometry_model)
    check_finite(joints, links)
    check_bodies(joints, links)
    warnings += check_inertias("joint", ((joint.name, joint.mass, joint.inertia) for joint in joints))
    warnings += check_mass_matrix(joints)
    if not any(link.geometry for link in links):
        warnings.append("geometry_model has no shapes, so the robot has no surface to be touched")
    return RobotDescription(str(model.name), joints, links, gravity, warnings)


def _links(model: Any, geometry_model: Any) -> tuple[list[LinkTuple], list[str]]:
    frames: list[int | None] = []
    for shape in geometry_model.geometryObjects:
        if shape.parentJoint >= model.njoints:
            raise InputError(
                f"geometry_model was not built for this model: '{shape.name}' sits at no joint of it"
            )
        frames.append(_body_frame(model, shape))
    shapes = list(zip(geometry_model.geometryObjects, frames, strict=True))
    bare = dict.fromkeys(int(shape.parentJoint) for shape, frame in shapes if frame is None)
    links, unnamed, warnings = links_of(model, bare)
    for shape, frame in shapes:
        if frame is None:
            link, placement = unnamed[shape.parentJoint], shape.placement
        else:
            link = links[frame]
            placement = model.frames[frame].placement.actInv(shape.placement)
        kind, params = shape_of(shape.geometry, shape.name, mirrored=bool(np.prod(shape.meshScale) < 0.0))
        link.geometry.append(GeometryTuple(kind, params, np.array(placement.homogeneous, dtype=np.float64)))
    if unnamed:
        names = ", ".join(f"'{link.name}'" for link in unnamed.values())
        warnings.append(f"Links named after their joints for want of BODY frames: {names}")
    return [*links.values(), *unnamed.values()], warnings


def _body_frame(model: Any, shape: Any) -> int | None:
    """Index of the BODY frame that carries the shape, None where its joint has none."""
    index = shape.parentFrame
    # Objects made without a frame hold an index beyond the last.
    while 0 < index < model.nframes and model.frames[index].parentJoint == shape.parentJoint:
        if is_body(model.frames[index]):
            return int(index)
        index = model.frames[index].parentFrame
    for position, frame in enumerate(model.frames):
        if is_body(frame) and frame.parentJoint == shape.parentJoint:
            return position
    return None

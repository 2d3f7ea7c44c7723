"""A robot description from a Pinocchio model and its geometry model."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pinocchio as pin

from ..errors import InputError, ModelError
from .coal import shape_of
from .description import GeometryTuple, LinkTuple, RobotDescription, Shape
from .pinocchio_links import is_body, links_of
from .pinocchio_model import joints_of


def describe_pinocchio(
    model: Any,
    geometry_model: Any,
    shapes: Mapping[str, Shape] | None = None,
    unlocked: Any = None,
) -> RobotDescription:
    """Read a `pinocchio.Model` and the `pinocchio.GeometryModel` built for it.

    Links are the BODY frames, in the model's order; a shape belongs to the BODY frame it sits in or behind.
    A joint without any BODY frame whose body has shapes gives a link of the joint's name.

    `shapes` are what geometry objects of these names stand for. `unlocked` is the model before joints were
    locked, where there is one: only it knows which links these joints hang from.

    Raises `InputError` for the arguments, `ModelError` for joints that are not supported, `GeometryError` for
    shapes.
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
    links, warnings = _links(model, geometry_model, shapes or {})
    if unlocked is not None:
        # Links and parents as they are without locked joints; only where they sit differs.
        placed = {link.name: link for link in links}
        warnings = []
        links = [
            link._replace(joint=now.joint, placement=now.placement, geometry=now.geometry)
            for link in links_of(unlocked)[0].values()
            for now in [placed[link.name]]
        ]
    if shapes is None and not any(link.geometry for link in links):
        warnings.append("geometry_model has no shapes, so the robot has no surface to be touched")
    return RobotDescription(str(model.name), joints, links, gravity, warnings)


def _links(model: Any, geometry_model: Any, shapes: Mapping[str, Shape]) -> tuple[list[LinkTuple], list[str]]:
    frames: list[int | None] = []
    for item in geometry_model.geometryObjects:
        if item.parentJoint >= model.njoints:
            raise InputError(
                f"geometry_model was not built for this model: '{item.name}' sits at no joint of it"
            )
        frames.append(_body_frame(model, item))
    items = list(zip(geometry_model.geometryObjects, frames, strict=True))
    bare = dict.fromkeys(int(item.parentJoint) for item, frame in items if frame is None)
    links, unnamed, warnings = links_of(model, bare)
    for item, frame in items:
        if frame is None:
            link, placement = unnamed[item.parentJoint], item.placement
        else:
            link = links[frame]
            placement = model.frames[frame].placement.actInv(item.placement)
        shape = shapes.get(item.name)
        if shape is None:
            shape = shape_of(item.geometry, item.name, mirrored=bool(np.prod(item.meshScale) < 0.0))
        link.geometry.append(GeometryTuple(*shape, np.array(placement.homogeneous, dtype=np.float64)))
    if unnamed:
        names = ", ".join(f"'{link.name}'" for link in unnamed.values())
        warnings.append(f"Links named after their joints for want of BODY frames: {names}")
    return [*links.values(), *unnamed.values()], warnings


def _body_frame(model: Any, item: Any) -> int | None:
    """Index of the BODY frame that carries the geometry object, None where its joint has none."""
    index = item.parentFrame
    # Objects made without a frame hold an index beyond the last.
    while 0 < index < model.nframes and model.frames[index].parentJoint == item.parentJoint:
        if is_body(model.frames[index]):
            return int(index)
        index = model.frames[index].parentFrame
    for position, frame in enumerate(model.frames):
        if is_body(frame) and frame.parentJoint == item.parentJoint:
            return position
    return None

"""The links' own inertias in a Pinocchio model, whose bodies lump what fixed joints join."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from .description import FloatArray

# Share of a body's largest parameter: what a subtraction leaves below it is rounding.
_ROUNDING = 1e-12

IsBody = Callable[[Any], bool]
LinkInertia = tuple[
    float, FloatArray, FloatArray
]  # mass, centre of mass, inertia about it; in the link's frame


def is_locked(model: Any, index: int) -> bool:
    """Whether `pinocchio.buildReducedModel` made this frame of a joint: it then is its own parent."""
    return index > 0 and bool(model.frames[index].parentFrame == index)


def parent_frames(model: Any, is_body: IsBody) -> list[int | None]:
    """Each frame's parent frame, always an earlier one; of a locked joint's the first link of its body."""
    first: dict[int, int] = {}
    for index, frame in enumerate(model.frames):
        if is_body(frame):
            first.setdefault(int(frame.parentJoint), index)
    parents: list[int | None] = []
    for index, frame in enumerate(model.frames):
        parent = first.get(int(frame.parentJoint)) if is_locked(model, index) else int(frame.parentFrame)
        parents.append(parent if parent is not None and parent < index else None)
    return parents


def link_inertias(model: Any, parents: list[int | None], is_body: IsBody) -> dict[int, LinkInertia]:
    """{BODY frame: its own mass, centre of mass and inertia}.

    A fixed joint's frame holds the inertia of the link it carries, the frame of a joint that was locked that
    of what was its body, and a moving joint that of its whole body. What is left of a body is its first
    link's.
    """
    carried = {
        parents[index]: index for index, frame in reversed(list(enumerate(model.frames))) if is_body(frame)
    }
    own = {index: np.zeros(10) for index, frame in enumerate(model.frames) if is_body(frame)}
    # Of each (formerly) moving body, and of the world: what it weighs in all, and its links. Older Pinocchios
    # do not know what the world weighs.
    rest = {~joint: _parameters(model.inertias[joint]) for joint in range(model.njoints)}
    if not rest[~0].any():
        del rest[~0]
    heads: dict[int, int] = {}
    for index, frame in enumerate(model.frames):
        group = _group(model, parents, index)
        parameters = _parameters(frame.placement.act(frame.inertia))
        if index == group:
            rest[group] = parameters
            if ~int(frame.parentJoint) in rest:
                rest[~int(frame.parentJoint)] -= parameters
            continue
        link = index if is_body(frame) else carried.get(index)
        if is_body(frame):
            heads.setdefault(group, index)
        if link is not None and model.frames[link].parentJoint == frame.parentJoint:
            own[link] += parameters
            if group in rest:
                rest[group] -= parameters
    for group, head in heads.items():
        if group in rest:
            joint = int(model.frames[head].parentJoint)
            left = rest[group]
            left[np.abs(left) <= _ROUNDING * np.abs(_parameters(model.inertias[joint])).max()] = 0.0
            own[head] += left
    return {index: _in_frame(own[index], model.frames[index].placement) for index in own}


def _group(model: Any, parents: list[int | None], index: int) -> int:
    """The locked joint's frame at or above a frame on its body, else the complement of the joint's number."""
    joint = model.frames[index].parentJoint
    above: int | None = index
    while above is not None and model.frames[above].parentJoint == joint:
        if is_locked(model, above):
            return above
        above = parents[above]
    return ~int(joint)


def _parameters(inertia: Any) -> FloatArray:
    """(10,): mass, first moments, inertia about the frame's origin; those of parts of a body add up."""
    return np.array(inertia.toDynamicParameters(), dtype=np.float64)


def _in_frame(parameters: FloatArray, placement: Any) -> LinkInertia:
    """Of parameters in the joint's frame, for a frame placed there."""
    mass = max(float(parameters[0]), 0.0)
    xx, xy, yy, xz, yz, zz = parameters[4:]
    about_com = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    com = np.zeros(3)
    if mass > 0.0:
        com = parameters[1:4] / mass
        about_com -= mass * (com @ com * np.eye(3) - np.outer(com, com))
        com = placement.rotation.T @ (com - placement.translation)
    return mass, com, placement.rotation.T @ about_com @ placement.rotation

"""Links of a Pinocchio model, in their tree."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from .description import LinkTuple, name_list
from .pinocchio_inertia import is_locked, link_inertias, parent_frames


def is_body(frame: Any) -> bool:
    """Whether a frame is a link's."""
    return str(frame.type) == "BODY"


def links_of(
    model: Any, bare_joints: Iterable[int] = ()
) -> tuple[dict[int, LinkTuple], dict[int, LinkTuple], list[str]]:
    """Links without shapes, {frame index: link} and {bare joint: link}, and warnings.

    The first are the BODY frames, in the model's order; the second, named after their joints, come after
    them. A link's `parent` is a position in this order.
    """
    frames = [index for index, frame in enumerate(model.frames) if is_body(frame)]
    joints = [int(model.frames[index].parentJoint) for index in frames]
    bare = list(bare_joints)
    first = {joint: position for position, joint in reversed(list(enumerate([*joints, *bare])))}
    position_of = {frame: position for position, frame in enumerate(frames)}
    parents = parent_frames(model, is_body)
    inertias = link_inertias(model, parents, is_body)
    links = {}
    for position, (index, joint) in enumerate(zip(frames, joints, strict=True)):
        above = parents[index]
        while above is not None and not is_body(model.frames[above]):
            above = parents[above]
        links[index] = LinkTuple(
            str(model.frames[index].name),
            joint,
            np.array(model.frames[index].placement.homogeneous, dtype=np.float64),
            _parent(model, first, joint, position, None if above is None else position_of[above], joints),
            *inertias[index],
            [],
        )
    unnamed = {
        joint: LinkTuple(
            str(model.names[joint]),
            joint,
            np.eye(4),
            _parent(model, first, joint, first[joint], None, joints),
            float(model.inertias[joint].mass),
            np.array(model.inertias[joint].lever, dtype=np.float64),
            np.array(model.inertias[joint].inertia, dtype=np.float64),
            [],
        )
        for joint in bare
    }
    return links, unnamed, _locked_warnings(model)


def _parent(
    model: Any, first: dict[int, int], joint: int, position: int, above: int | None, joints: list[int]
) -> int | None:
    """The parent link's position: the frames' word where the joints agree with it, else a first link."""
    carrier = joint
    while carrier != 0:
        carrier = int(model.parents[carrier])
        if carrier in first:
            break
    if above is not None and joints[above] in (joint, carrier):
        return above
    if first[joint] != position:
        return first[joint]
    return first.get(carrier) if carrier != joint else None


def _locked_warnings(model: Any) -> list[str]:
    locked = [str(frame.name) for index, frame in enumerate(model.frames) if is_locked(model, index)]
    if not locked:
        return []
    return [
        "The model does not say which links its locked joints hang from (taken: the first link of the body, "
        f"which matters for force/torque sensors at fixed joints only): {name_list(locked)}"
    ]

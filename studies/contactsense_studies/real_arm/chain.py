"""How far links are from each other along an arm."""

from __future__ import annotations

import pinocchio as pin

from contactsense import Robot
from contactsense.loading.pinocchio_inertia import is_locked


class Chain:
    """The tree of the links with a surface; one without, such as a flange, is no step on the way."""

    def __init__(self, robot: Robot) -> None:
        surfaces = frozenset(robot.link_names)
        self._parents = {link: _parent(robot.model, link, surfaces) for link in robot.all_link_names}

    def steps(self, first: str, second: str) -> int:
        """Number of links from one to the other: 0 for the same link, 1 for neighbours."""
        up, down = self._to_base(first), self._to_base(second)
        for number, link in enumerate(down):
            if link in up:
                return up.index(link) + number
        # Several links may stand on a base without a surface, which then is the step between them.
        return len(up) + len(down) - 1

    def _to_base(self, link: str | None) -> list[str]:
        line = []
        while link is not None:
            line.append(link)
            link = self._parents[link]
        return line


def _parent(model: pin.Model, link: str, surfaces: frozenset[str]) -> str | None:
    """The next link towards the base that has a surface; joints are frames of their own."""
    index = _towards_base(model, model.getBodyId(link))
    while index > 0:
        frame = model.frames[index]
        if frame.type == pin.FrameType.BODY and frame.name in surfaces:
            return str(frame.name)
        index = _towards_base(model, index)
    return None


def _towards_base(model: pin.Model, index: int) -> int:
    """The frame before one; what a locked joint hangs from is lost, and guessed."""
    if not is_locked(model, index):
        return int(model.frames[index].parentFrame)
    # A hand comes before its fingers: the last link of the same body that is not behind a locked joint.
    for before in range(index - 1, 0, -1):
        frame = model.frames[before]
        same_body = frame.parentJoint == model.frames[index].parentJoint
        if frame.type == pin.FrameType.BODY and same_body and not is_locked(model, frame.parentFrame):
            return before
    return 0

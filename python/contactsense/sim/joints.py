"""The joints of a Pinocchio model as MuJoCo knows them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np
import pinocchio as pin

from contactsense.errors import ModelError
from contactsense.loading.description import JointKind, JointTuple
from contactsense.loading.pinocchio_model import joints_of

MujocoKind: TypeAlias = Literal["hinge", "slide", "free"]

_KINDS: dict[JointKind, MujocoKind] = {
    "revolute": "hinge",
    "continuous": "hinge",
    "prismatic": "slide",
    "free_flyer": "free",
}


@dataclass(frozen=True)
class SimulatedJoint:
    """One moving joint and where it stands in the Pinocchio model."""

    index: int  # in model.joints
    q: int  # first entry in q
    v: int  # first entry in v
    kind: MujocoKind
    body: JointTuple  # axis, placement and inertia

    @property
    def name(self) -> str:
        """The same in both models."""
        return self.body.name

    @property
    def unbounded(self) -> bool:
        """Whether q holds (cos, sin) of the angle."""
        return self.body.kind == "continuous"


def joints(model: pin.Model) -> tuple[SimulatedJoint, ...]:
    """Every moving joint in Pinocchio's order.

    Raises:
        ModelError: a joint that is not revolute, prismatic, continuous or a free base at the origin.
    """
    found = []
    for index, body in enumerate(joints_of(model), start=1):
        if body.kind == "free_flyer" and not np.allclose(body.placement, np.eye(4), rtol=0, atol=1e-12):
            raise ModelError(f"joint '{body.name}': a free base must join the root to the world's origin")
        joint = model.joints[index]
        found.append(SimulatedJoint(index, int(joint.idx_q), int(joint.idx_v), _KINDS[body.kind], body))
    return tuple(found)

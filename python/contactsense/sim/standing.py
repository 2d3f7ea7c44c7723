"""Control of a legged robot that stands on flat feet."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from contactsense.errors import InputError, ModelError

from ._arrays import FloatArray, gains, not_negative, symmetric, vector


@dataclass(frozen=True)
class Sole:
    """The flat rectangle under a foot, its sides along the x and y axes of the foot's link."""

    link: str
    centre: FloatArray  # (3,) in the link's frame [m]
    half_lengths: tuple[float, float]  # along x and y, within which the pressure's centre is kept [m]

    def __post_init__(self) -> None:
        object.__setattr__(self, "centre", vector("centre", self.centre, 3))
        lengths = vector("half_lengths", self.half_lengths, 2)
        if not (lengths > 0).all():
            raise InputError(f"half_lengths must be positive, not {self.half_lengths}")


class StandingController:
    """Holds a posture by inverse dynamics with ground forces: the joints' rows of `M a + C v + g - J^T F`.

    - `a` of the base and of all joints that are not in the legs: `kp (q_d - q) - kd v`.
    - `a` of the legs: such that the feet stay. The legs' torques do not follow from the feet's velocities,
      which keeps the control stable while a foot tips.
    - `F`, the ground's wrenches on the feet: the smallest that carry the base rows, with the centres of
      pressure inside the soles. What the ground cannot give is left out.

    Args:
        model: Pinocchio model with a free base, and six joints from there to each foot, none of them shared.
        posture: (nq,) to hold, with flat feet.
        soles: one a foot.
        kp, kd: [1/s^2] and [1/s], one for all or (nv,); those of the legs are not used.
        leg_damping: of the legs' joints, so that a foot without ground under it does not swing [Nms].

    Raises:
        ModelError, InputError: names what is wrong.
    """

    # A moment weighs as much as a force with this lever [m].
    _LEVER = 0.1

    def __init__(
        self,
        model: pin.Model,
        posture: ArrayLike,
        soles: Sequence[Sole],
        *,
        kp: ArrayLike = 400.0,
        kd: ArrayLike = 40.0,
        leg_damping: float = 5.0,
    ) -> None:
        if model.njoints < 2 or model.joints[1].shortname() != "JointModelFreeFlyer":
            raise ModelError("model: standing needs a free base as the first joint")
        self._model, self._data = model, model.createData()
        self._posture = vector("posture", posture, model.nq)
        self._kp, self._kd = gains("kp", kp, model.nv), gains("kd", kd, model.nv)
        self._damping = not_negative("leg_damping", leg_damping)
        self._soles = tuple(soles)
        self._frames = [_frame(model, sole.link) for sole in self._soles]
        legs = [_leg(model, frame) for frame in self._frames]
        self._legs = np.array(sorted(index for leg in legs for index in leg), dtype=np.intp)
        if not legs or any(len(leg) != 6 for leg in legs) or len(set(self._legs)) < self._legs.size:
            raise ModelError("soles: each foot needs six joints of its own from the base")
        self._others = np.setdiff1d(np.arange(model.nv), self._legs)
        self._stiffness = np.tile([1.0] * 3 + [self._LEVER**2] * 3, len(self._soles))

    def torque(self, q: FloatArray, v: FloatArray) -> FloatArray:
        """(nv - 6,) motor torque [Nm] at position `q` (nq,) and velocity `v` (nv,)."""
        model, data = self._model, self._data
        pin.computeAllTerms(model, data, q, v)
        mass = symmetric(data.M)
        jacobian = np.vstack([pin.getFrameJacobian(model, data, frame, _AXES) for frame in self._frames])
        drift = self._drift(q, v)
        a = self._kp * pin.difference(model, q, self._posture) - self._kd * v
        legs, others = self._legs, self._others
        a[legs] = np.linalg.solve(jacobian[:, legs], -drift - jacobian[:, others] @ a[others])
        needed = mass @ a + data.nle
        torque: FloatArray = needed - jacobian.T @ self._ground(jacobian, needed[:6])
        torque[legs] -= self._damping * v[legs]
        return torque[6:]

    def _drift(self, q: FloatArray, v: FloatArray) -> FloatArray:
        """Acceleration of the feet, world axes, with `a` zero."""
        model, data = self._model, self._data
        pin.forwardKinematics(model, data, q, v, np.zeros(model.nv))
        pin.updateFramePlacements(model, data)
        feet = [pin.getFrameClassicalAcceleration(model, data, frame, _AXES).vector for frame in self._frames]
        return np.concatenate(feet)

    def _ground(self, jacobian: FloatArray, needed: FloatArray) -> FloatArray:
        """Wrenches on the feet, world axes, at their links' origins."""
        base = jacobian[:, :6]
        soft = self._stiffness[:, None] * base
        wrenches: FloatArray = soft @ np.linalg.solve(base.T @ soft, needed)
        for sole, frame, wrench in zip(self._soles, self._frames, wrenches.reshape(-1, 6), strict=True):
            turn = self._data.oMf[frame].rotation
            force, moment = turn.T @ wrench[:3], turn.T @ wrench[3:]
            lever = np.cross(sole.centre, force)
            along, across = sole.half_lengths
            limit = max(force[2], 0.0) * np.array([across, along])
            about = moment - lever
            about[:2] = np.clip(about[:2], -limit, limit)
            wrench[3:] = turn @ (about + lever)
        return wrenches


_AXES = pin.LOCAL_WORLD_ALIGNED


def _frame(model: pin.Model, link: str) -> int:
    if not model.existFrame(link, pin.FrameType.BODY):
        raise InputError(f"soles: no link '{link}'")
    return int(model.getFrameId(link, pin.FrameType.BODY))


def _leg(model: pin.Model, frame: int) -> list[int]:
    """Velocity indices of the joints between the base and a frame."""
    joint = model.frames[frame].parentJoint
    leg: list[int] = []
    while joint > 1:
        leg += range(model.joints[joint].idx_v, model.joints[joint].idx_v + model.joints[joint].nv)
        joint = model.parents[joint]
    return leg

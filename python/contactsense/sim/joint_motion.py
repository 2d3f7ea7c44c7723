"""A motion of the joints as plain arrays."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from contactsense.errors import InputError

from ._arrays import FloatArray
from .joints import SimulatedJoint, joints


@dataclass(frozen=True, eq=False, init=False)
class JointMotion:
    """Where the joints are over time; `n` rows.

    Args:
        time: (n,), strictly increasing [s]; at least two rows.
        q: (n, nq) positions, as in Pinocchio.
        v: (n, nv) velocities.
        a: (n, nv) accelerations.

    Raises:
        InputError: names the argument.
    """

    time: FloatArray
    q: FloatArray
    v: FloatArray
    a: FloatArray

    def __init__(self, time: ArrayLike, q: ArrayLike, v: ArrayLike, a: ArrayLike) -> None:
        for name, value in (("time", time), ("q", q), ("v", v), ("a", a)):
            try:
                array = np.array(value, dtype=np.float64, order="C")
            except (TypeError, ValueError):
                raise InputError(f"{name}: must be an array of numbers") from None
            dimensions = 1 if name == "time" else 2
            if array.ndim != dimensions:
                raise InputError(f"{name}: must have {dimensions} dimensions, not {array.ndim}")
            if not np.isfinite(array).all():
                raise InputError(f"{name}: must be finite")
            if name != "time" and len(array) != len(self.time):
                raise InputError(f"{name}: must have {len(self.time)} rows, as time has, not {len(array)}")
            array.setflags(write=False)
            object.__setattr__(self, name, array)
        if len(self.time) < 2 or (np.diff(self.time) <= 0.0).any():
            raise InputError("time: must have two rows or more and increase from row to row [s]")

    def __len__(self) -> int:
        return len(self.time)


class JointAngles:
    """Positions as one number a joint, also where Pinocchio writes (cos, sin) of a continuous joint.

    Raises:
        InputError: a free base.
    """

    def __init__(self, model: pin.Model) -> None:
        self.joints: tuple[SimulatedJoint, ...] = joints(model)
        if any(joint.kind == "free" for joint in self.joints):
            raise InputError("robot: needs a fixed base")
        self.nq, self.nv = int(model.nq), int(model.nv)
        self.sliding = np.zeros(self.nv, dtype=bool)
        for joint in self.joints:
            self.sliding[joint.v] = joint.kind == "slide"

    def read(self, q: FloatArray) -> FloatArray:
        """(n, nv) angles or displacements of positions `q` (n, nq), without jumps of a turn."""
        angles = np.empty((len(q), self.nv))
        for joint in self.joints:
            if joint.unbounded:
                angles[:, joint.v] = np.unwrap(np.arctan2(q[:, joint.q + 1], q[:, joint.q]))
            else:
                angles[:, joint.v] = q[:, joint.q]
        return angles

    def write(self, angles: FloatArray) -> FloatArray:
        """(n, nq) positions of `angles` (n, nv)."""
        q = np.empty((len(angles), self.nq))
        for joint in self.joints:
            if joint.unbounded:
                q[:, joint.q] = np.cos(angles[:, joint.v])
                q[:, joint.q + 1] = np.sin(angles[:, joint.v])
            else:
                q[:, joint.q] = angles[:, joint.v]
        return q

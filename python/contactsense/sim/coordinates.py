"""Between Pinocchio's and MuJoCo's coordinates of the same robot.

They differ in the free base: MuJoCo writes its quaternion (w, x, y, z) and its linear velocity along world
axes, Pinocchio writes (x, y, z, w) and body axes. Angular velocity is along body axes in both. A continuous
joint is (cos, sin) in Pinocchio, an angle in MuJoCo. MuJoCo numbers joints depth first.
"""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from contactsense.errors import ModelError

from ._arrays import FloatArray
from ._mujoco import mujoco
from .joints import joints


class Coordinates:
    """Conversions for one pair of models; joints are matched by name."""

    def __init__(self, model: pin.Model, mj_model: mujoco.MjModel) -> None:
        self.nq, self.nv = int(model.nq), int(model.nv)
        self.floating_base = False
        self.bodies = np.zeros(model.njoints, dtype=np.intp)  # MuJoCo's body of each Pinocchio joint
        plain: list[tuple[int, int]] = []
        unbounded: list[tuple[int, int]] = []
        self._v = np.empty(self.nv, dtype=np.intp)
        for joint in joints(model):
            number = mujoco.mj_name2id(mj_model, mujoco.mjtObj.mjOBJ_JOINT, joint.name)
            if number < 0:
                raise ModelError(f"the MuJoCo model has no joint '{joint.name}'")
            self.bodies[joint.index] = mj_model.jnt_bodyid[number]
            q, v = int(mj_model.jnt_qposadr[number]), int(mj_model.jnt_dofadr[number])
            if joint.kind == "free":
                if (q, v, joint.q, joint.v) != (0, 0, 0, 0):
                    raise ModelError(f"the free base '{joint.name}' must be the first joint")
                self.floating_base = True
                self._v[:6] = np.arange(6)
            else:
                (unbounded if joint.unbounded else plain).append((joint.q, q))
                self._v[joint.v] = v
        if (mj_model.nq, mj_model.nv) != (self.nv + self.floating_base, self.nv):
            raise ModelError(
                f"the MuJoCo model has {mj_model.nv} degrees of freedom, the Pinocchio one {self.nv}"
            )
        self._q = np.array(plain, dtype=np.intp).reshape(-1, 2).T
        self._angle = np.array(unbounded, dtype=np.intp).reshape(-1, 2).T

    def qpos(self, q: FloatArray) -> FloatArray:
        """MuJoCo's position for Pinocchio's `q`."""
        qpos = np.empty(self.nv + self.floating_base)
        if self.floating_base:
            qpos[:3] = q[:3]
            qpos[[4, 5, 6, 3]] = q[3:7]
        qpos[self._q[1]] = q[self._q[0]]
        qpos[self._angle[1]] = np.arctan2(q[self._angle[0] + 1], q[self._angle[0]])
        return qpos

    def q(self, qpos: FloatArray) -> FloatArray:
        """Pinocchio's `q` for MuJoCo's position."""
        q = np.empty(self.nq)
        if self.floating_base:
            q[:3] = qpos[:3]
            q[3:7] = qpos[[4, 5, 6, 3]]
        q[self._q[0]] = qpos[self._q[1]]
        q[self._angle[0]] = np.cos(qpos[self._angle[1]])
        q[self._angle[0] + 1] = np.sin(qpos[self._angle[1]])
        return q

    def qvel(self, q: FloatArray, v: FloatArray) -> FloatArray:
        """MuJoCo's velocity (or generalised force, which transforms alike) for Pinocchio's `v` at `q`."""
        qvel = np.empty(self.nv)
        qvel[self._v] = v
        if self.floating_base:
            qvel[:3] = base_rotation(q) @ v[:3]
        return qvel

    def v(self, q: FloatArray, qvel: FloatArray) -> FloatArray:
        """Pinocchio's velocity (or generalised force) at its `q` for MuJoCo's."""
        v: FloatArray = qvel[self._v]
        if self.floating_base:
            v[:3] = base_rotation(q).T @ v[:3]
        return v


def base_rotation(q: FloatArray) -> FloatArray:
    """(3, 3) rotation from the free base's axes to the world's, from Pinocchio's `q`."""
    return np.asarray(pin.Quaternion(q[3:7]).matrix(), dtype=np.float64)

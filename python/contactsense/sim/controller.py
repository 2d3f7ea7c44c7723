"""Joint-space control with the robot's full dynamics."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from contactsense.errors import InputError

from ._arrays import FloatArray, not_negative, vector
from .trajectory import TrajectoryPoint


class ComputedTorqueController:
    """`tau = M(q) (a_d + kp (q_d - q) + kd (v_d - v)) + C v + g`, for a fixed base.

    Args:
        model: Pinocchio model without a free base.
        kp: stiffness of the error's decay [1/s^2].
        kd: damping of it [1/s]; 2 sqrt(kp) is critical.
        torque_limits: (nv,) largest magnitude of each torque [Nm]; none by default.
    """

    def __init__(
        self,
        model: pin.Model,
        *,
        kp: float = 400.0,
        kd: float = 40.0,
        torque_limits: ArrayLike | None = None,
    ) -> None:
        if any(joint.shortname() == "JointModelFreeFlyer" for joint in model.joints):
            raise InputError("model: computed torque needs a fixed base")
        self._model = model
        self._data = model.createData()
        self.kp, self.kd = not_negative("kp", kp), not_negative("kd", kd)
        self._limits = None if torque_limits is None else vector("torque_limits", torque_limits, model.nv)
        if self._limits is not None and (self._limits < 0).any():
            raise InputError("torque_limits must not be negative")

    def torque(self, q: FloatArray, v: FloatArray, reference: TrajectoryPoint) -> FloatArray:
        """(nv,) motor torque [Nm] at position `q` (nq,) and velocity `v` (nv,)."""
        error = pin.difference(self._model, q, reference.q)
        acceleration = reference.a + self.kp * error + self.kd * (reference.v - v)
        tau = np.array(pin.rnea(self._model, self._data, q, v, acceleration))
        return tau if self._limits is None else np.clip(tau, -self._limits, self._limits)

"""How strong the joints of a robot are."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from contactsense import Robot

from ._arrays import FloatArray

# Poses over which the largest load is looked for where a description gives no effort limit.
_POSES = 100
# What an arm's drives can accelerate its links at, beside carrying them [rad/s^2; m/s^2].
_ACCELERATION = 10.0
# Drives that carry the links of a light wrist and nothing else are still at least this strong [Nm; N].
_WEAKEST = 1.0


def rated_torque(robot: Robot) -> FloatArray:
    """(nv,) effort limits; where there is none, what carries and accelerates the links [Nm; N]."""
    limits = np.array(robot.effort_limits)
    known = np.isfinite(limits) & (limits > 0.0)
    if known.all():
        return limits
    model = robot.model
    data = model.createData()
    needed = np.full(robot.nv, _WEAKEST)
    for seed in range(_POSES):
        q = robot.random_configuration(seed)
        gravity = np.abs(pin.computeGeneralizedGravity(model, data, q))
        inertia = np.diag(pin.crba(model, data, q))
        needed = np.maximum(needed, gravity + _ACCELERATION * inertia)
    return np.where(known, limits, needed)

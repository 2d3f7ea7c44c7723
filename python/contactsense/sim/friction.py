"""Friction of joints."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contactsense.errors import InputError

from ._arrays import FloatArray, not_negative, positive
from .per_joint import PerJoint, kept, spread


@dataclass(frozen=True)
class Friction:
    """Coulomb, viscous and Stribeck friction, one number for all joints or (nv,) for one each.

    The motor has to give `(coulomb + stribeck exp(-(v / stribeck_velocity)^2)) s + viscous v` on top of the
    rest. `s` is the direction of the motion: `tanh(v / sign_velocity)`, or with `presliding` a state that
    follows the position as in Dahl's model and therefore stays at rest, as the friction of real gears does.
    For sliding joints, read N for Nm and m for rad.

    Args:
        coulomb: [Nm].
        viscous: [Nm s/rad].
        stribeck: what breaking away takes above Coulomb friction [Nm].
        stribeck_velocity: at which 37 % of that is left [rad/s].
        sign_velocity: slow against any motion of an arm, so that Coulomb friction is a step, yet without the
            jump that no numerical method likes [rad/s].
        presliding: travel in which the direction turns [rad], about 1e-3 in gears; 0 for the tanh.
        seen: share of it that measured torques contain: 1 for motor currents, which overcome all of it; 0 for
            a sensor between gear and link; between them where seals and bearings lie behind the sensor.

    Raises:
        InputError: names the setting.
    """

    coulomb: PerJoint = 0.0
    viscous: PerJoint = 0.0
    stribeck: PerJoint = 0.0
    stribeck_velocity: float = 0.1
    sign_velocity: float = 0.01
    presliding: float = 0.0
    seen: PerJoint = 1.0

    def __post_init__(self) -> None:
        for name in ("coulomb", "viscous", "stribeck", "seen"):
            object.__setattr__(self, name, kept(f"friction.{name}", getattr(self, name), lowest=0.0))
        if np.max(self.seen) > 1.0:
            raise InputError("friction.seen: must be a share from 0 to 1")
        positive("friction.stribeck_velocity", self.stribeck_velocity)
        positive("friction.sign_velocity", self.sign_velocity)
        not_negative("friction.presliding", self.presliding)

    def torque(self, angles: FloatArray, v: FloatArray) -> FloatArray:
        """(n, nv) what the motors have to give to overcome it, at `angles` and velocities `v` (n, nv)."""
        nv = v.shape[1]
        if self.presliding > 0.0:
            direction = dahl_state(angles, self.presliding)
        else:
            direction = np.tanh(v / self.sign_velocity)
        breakaway = np.exp(-np.square(v / self.stribeck_velocity))
        coulomb, viscous, stribeck = (
            spread(f"friction.{name}", getattr(self, name), nv) for name in ("coulomb", "viscous", "stribeck")
        )
        torque: FloatArray = (coulomb + stribeck * breakaway) * direction + viscous * v
        return torque

    def share_seen(self, nv: int) -> FloatArray:
        """(nv,) of `seen`."""
        return spread("friction.seen", self.seen, nv)


def dahl_state(angles: FloatArray, travel: float) -> FloatArray:
    """(n, nv) direction of motion between -1 and 1 (Dahl 1968): `dz = (1 - z sign(dx)) dx / travel`, from 0.

    Each step is solved exactly for a motion in one direction, so that it is stable for any length of a step.
    """
    steps = np.diff(angles, axis=0, prepend=angles[:1])
    target, remain = np.sign(steps), np.exp(-np.abs(steps) / travel)
    state = np.zeros_like(angles)
    for row in range(1, len(angles)):
        state[row] = target[row] + (state[row - 1] - target[row]) * remain[row]
    return state

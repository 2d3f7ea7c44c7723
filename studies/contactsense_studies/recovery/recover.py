"""One simulated arm with a payload: what `calibrate` finds of its known errors."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

import contactsense as cs
from contactsense import Robot, sim
from contactsense.sim._arrays import FloatArray

# What a payload weighs, as a share of the robot's mass, and how far its centre is from the link's origin [m].
MASS = (0.03, 0.12)
REACH = 0.1


@dataclass(frozen=True, eq=False)
class Recovery:
    """Errors of one calibration; a std of zero where none is stated."""

    bias: FloatArray  # (nv,) found less true [Nm]
    bias_std: FloatArray
    coulomb: FloatArray  # (nv,) found less true [Nm]
    coulomb_std: FloatArray
    coulomb_true: FloatArray
    noise: FloatArray  # (nv,) found over true torque noise
    mass: float  # found less true, as a share of the true one
    mass_std: float  # as well
    com: FloatArray  # (3,) found less true [m]
    com_std: FloatArray


def loaded(robot: Robot, arm: sim.ImperfectArm, seed: int) -> sim.ImperfectArm:
    """The arm with a payload on its last link, drawn with `seed`."""
    rng = np.random.default_rng([seed, 12])
    mass = float(rng.uniform(*MASS) * robot.mass)
    x, y, z = rng.uniform(-REACH, REACH, 3)
    return replace(arm, payload=sim.Payload(last_link(robot), mass, (float(x), float(y), float(z))))


def last_link(robot: Robot) -> str:
    """The link that the last joint carries."""
    model = robot.model
    frames = [frame.name for frame in model.frames if frame.parentJoint == model.njoints - 1]
    return next(name for name in robot.link_names if name in frames)


def linear(arm: sim.ImperfectArm) -> sim.ImperfectArm:
    """Without hysteresis, and without errors of scale, which no log tells from masses."""
    return replace(arm, hysteresis=0.0, torque_scale=1.0)


def recover(robot: Robot, arm: sim.ImperfectArm, motion: sim.JointMotion, seed: int) -> Recovery:
    """Records the arm, calibrates it, and compares.

    Raises:
        InputError: the arm has no payload, or a setting does not fit the robot.
    """
    load = arm.payload
    if load is None:
        raise cs.InputError("arm: must have a payload")
    run = sim.record_imperfect(robot, arm, motion, seed=seed)
    found = cs.calibrate(robot, run.log, payload_link=load.link)
    held, friction = found.payload, arm.friction
    assert held is not None  # its link is named
    seen = friction.share_seen(robot.nv) * np.broadcast_to(np.array(friction.coulomb), robot.nv)
    return Recovery(
        bias=found.torque_bias - arm.per_joint("torque_bias", robot.nv),
        bias_std=np.array(found.torque_bias_std),
        coulomb=found.friction.coulomb - seen,
        coulomb_std=np.array(found.friction.coulomb_std),
        coulomb_true=seen,
        noise=np.array(found.noise.torque) / arm.per_joint("torque_noise", robot.nv),
        mass=held.mass / load.mass - 1.0,
        mass_std=held.mass_std / load.mass,
        com=np.array(held.com) - np.array(load.com),
        com_std=np.array(held.com_std),
    )

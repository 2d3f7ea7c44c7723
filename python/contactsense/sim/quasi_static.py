"""Contact runs in closed form: the robot is so slow that only the contact and gravity count."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from contactsense import Robot
from contactsense.errors import InputError

from ._arrays import FloatArray
from .disturbance import TorqueError
from .penalty import ContactForce, PenaltyContact, joint_torque
from .run import ContactRun


def record_quasi_static(
    robot: Robot,
    contact: PenaltyContact,
    time: ArrayLike,
    q: ArrayLike,
    *,
    error: TorqueError | None = None,
    true_model: pin.Model | None = None,
    settings: dict[str, Any] | None = None,
) -> ContactRun:
    """The run of a robot led through given poses: `tau = g(q) - J^T F`, without physics engine.

    Friction acts against the motion from sample to sample; at the first sample there is none.

    Args:
        robot: what is known of it: `external_torque = g(q) - tau`.
        contact: its spring.
        time: (T,) [s], increasing.
        q: (T, nq), see `ContactPath.q`.
        error: of the external torque; none by default.
        true_model: the robot as it is, whose gravity `tau` carries; by default as `robot` says.
        settings: added to those of the record.

    Raises:
        InputError: names the argument.
    """
    times = np.array(time, dtype=np.float64)
    poses = np.array(q, dtype=np.float64)
    if times.ndim != 1 or times.size < 1 or not np.isfinite(times).all() or (np.diff(times) <= 0).any():
        raise InputError("time must be finite and increasing, of shape (T,)")
    if poses.shape != (times.size, robot.nq) or not np.isfinite(poses).all():
        raise InputError(f"q must be finite, of shape ({times.size}, {robot.nq})")
    if robot.nq != robot.nv:
        raise InputError("robot: needs a fixed base and joints with one coordinate each")
    v = np.zeros_like(poses)
    v[1:] = np.diff(poses, axis=0) / np.diff(times)[:, None]
    still = np.zeros(robot.nv)
    forces = [contact.forces(pose, speed) for pose, speed in zip(poses, v, strict=True)]
    true = np.array([joint_torque(robot, pose, each) for pose, each in zip(poses, forces, strict=True)])
    known = np.array([robot.inverse_dynamics(pose, still, still) for pose in poses])
    gravity = known if true_model is None else gravity_torques(true_model, poses)
    disturbed = true if error is None else error.measure(true)
    tau = gravity - disturbed
    plain = contact.to_dict() | {
        "recorder": "quasi-static",
        "robot": robot.name,
        "error": (error or TorqueError()).to_dict(),
    }
    plain |= settings or {}
    return contact_run(times, poses, v, tau, known - tau, true, forces, plain)


def gravity_torques(model: pin.Model, q: FloatArray) -> FloatArray:
    """(T, nv) torques that hold `model` at rest in poses `q` (T, nq)."""
    data = model.createData()
    return np.array([pin.computeGeneralizedGravity(model, data, pose) for pose in q])


def contact_run(
    time: FloatArray,
    q: FloatArray,
    v: FloatArray,
    tau: FloatArray,
    external_torque: FloatArray,
    true_external_torque: FloatArray,
    forces: list[tuple[ContactForce, ...]],
    settings: dict[str, Any],
) -> ContactRun:
    """Columns of the deepest contact of each sample put beside the rest."""
    nothing = np.full(3, np.nan)
    first = [each[0] if each else None for each in forces]
    return ContactRun(
        time,
        q,
        v,
        tau,
        external_torque,
        true_external_torque,
        tuple(contact.link if contact else "" for contact in first),
        np.array([contact.point if contact else nothing for contact in first]),
        np.array([contact.normal if contact else nothing for contact in first]),
        np.array([contact.force if contact else np.zeros(3) for contact in first]),
        settings,
    )

"""Runs of an imperfect arm in closed form, without physics engine."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from contactsense import Robot
from contactsense.errors import InputError
from contactsense.log import Log

from ._arrays import FloatArray, whole
from .imperfect_arm import ImperfectArm
from .imperfect_run import ImperfectRun, RecordedContact, Truth
from .joint_motion import JointAngles, JointMotion
from .person_contact import PersonContact
from .reading import kept_rows, motion_reading, time_reading, torque_reading

# Repetitions until deflection and external torque agree; each leaves a fiftieth of the difference for joints
# that give way by 1 mrad/Nm.
_ROUNDS = 3


def record_imperfect(
    robot: Robot,
    arm: ImperfectArm,
    motion: JointMotion,
    contacts: Iterable[PersonContact] = (),
    *,
    seed: int = 0,
) -> ImperfectRun:
    """What `arm` measures while it follows `motion` and a person pushes it.

    Its position controller is assumed to follow the motion exactly, but for `arm.compliance`. Hence its joint
    torques are the inverse dynamics of the true robot less `J^T f` of the contacts.

    Args:
        robot: as described; fixed base.
        arm: what is wrong with it.
        motion: of its joints.
        contacts: within the time of the motion; forces at once add up.
        seed: of noise, jitter and dropped ticks. Same seed, same run.

    Raises:
        InputError: names the argument.
    """
    whole("seed", seed)
    angles_of = JointAngles(robot.model)
    if motion.q.shape[1] != robot.nq or motion.v.shape[1] != robot.nv or motion.a.shape[1] != robot.nv:
        raise InputError(f"motion: must have q (n, {robot.nq}), v and a (n, {robot.nv})")
    pushes = tuple(contacts)
    for number, each in enumerate(pushes):
        if each.start < motion.time[0] or each.end > motion.time[-1]:
            raise InputError(f"contacts[{number}]: must lie within the motion's time")
    true_robot = arm.true_robot(robot)
    motion = _give_way(robot, arm, angles_of, motion, pushes)
    external, contact, records = _contacts(robot, motion, pushes)
    tau = _inverse_dynamics(true_robot.model, motion) - external
    angles = angles_of.read(motion.q)
    friction = arm.friction.torque(angles, motion.v)
    streams = [np.random.default_rng([seed, stream]) for stream in range(3)]
    seen = tau + arm.friction.share_seen(robot.nv) * friction
    tau_read = torque_reading(robot, arm, motion.time, seen, streams[0])
    q_read, v_read = motion_reading(arm, angles_of, motion, angles)
    kept = kept_rows(arm, motion.time, streams[1])
    truth = Truth(
        time=motion.time[kept],
        q=motion.q[kept],
        v=motion.v[kept],
        a=motion.a[kept],
        tau=tau[kept],
        friction=friction[kept],
        external_torque=external[kept],
        contact=contact[kept],
        contacts=tuple(_with_rows(record, motion.time[kept]) for record in records),
        robot=true_robot,
        arm=arm,
    )
    stamps = time_reading(arm, motion.time, streams[2])
    log = Log(stamps[kept], q_read[kept], v_read[kept], tau_read[kept])
    return ImperfectRun(log, truth)


def _inverse_dynamics(model: pin.Model, motion: JointMotion) -> FloatArray:
    """(n, nv) torques that move `model` so, rotors included [Nm]."""
    data = model.createData()
    tau = np.empty_like(motion.v)
    for row in range(len(motion)):
        tau[row] = pin.rnea(model, data, motion.q[row], motion.v[row], motion.a[row])
    return tau


def _contacts(
    robot: Robot, motion: JointMotion, contacts: tuple[PersonContact, ...]
) -> tuple[FloatArray, NDArray[np.intp], list[RecordedContact]]:
    external = np.zeros_like(motion.v)
    which = np.full(len(motion), -1, dtype=np.intp)
    records = []
    for number, each in enumerate(contacts):
        shares = each.share(motion.time)
        rows = np.flatnonzero(shares)
        if rows.size == 0:
            raise InputError(f"contacts[{number}]: lasts less than a tick of the motion")
        # The middle row of those with the largest force.
        full = rows[shares[rows] >= shares.max()]
        largest = int(full[len(full) // 2])
        for row in rows:
            pose = robot.link_pose(motion.q[row], each.link)
            point, force = each.at(float(motion.time[row]), pose)
            torque = robot.jacobian(motion.q[row], each.link, point)[:3].T @ force
            external[row] += torque
            if row == largest:
                found = RecordedContact(each, slice(0, 0), float(motion.time[row]), point, force, torque)
        which[rows] = number
        records.append(found)
    return external, which, records


def _with_rows(record: RecordedContact, time: FloatArray) -> RecordedContact:
    first = np.searchsorted(time, record.contact.start, side="right")
    last = np.searchsorted(time, record.contact.end, side="left")
    rows = slice(int(first), int(last))
    return replace(record, rows=rows)


def _give_way(
    robot: Robot,
    arm: ImperfectArm,
    angles_of: JointAngles,
    motion: JointMotion,
    contacts: tuple[PersonContact, ...],
) -> JointMotion:
    """The motion with what the external torque adds to it, at positions where the two agree."""
    compliance = arm.per_joint("compliance", robot.nv)
    if not compliance.any() or not contacts:
        return motion
    time, planned = motion.time, angles_of.read(motion.q)
    moved = motion
    for _ in range(_ROUNDS):
        added = compliance * _contacts(robot, moved, contacts)[0]
        faster = np.gradient(added, time, axis=0)
        harder = np.gradient(faster, time, axis=0)
        moved = JointMotion(time, angles_of.write(planned + added), motion.v + faster, motion.a + harder)
    return moved

"""The arm's contacts once more, on an arm with the errors of a real one that is calibrated first."""

from __future__ import annotations

import numpy as np

from .. import ContactMonitor, Robot, calibrate, exciting_motion
from ..calibration import Calibration
from ..sim import (
    ImperfectArm,
    ImperfectRun,
    JointMotion,
    PersonContact,
    Push,
    SineTrajectory,
    record_imperfect,
)
from .result import ImperfectResult, Signals
from .score import HitScorer, strongest
from .settings import DT

# Contact-free motion before the run [s].
CALIBRATION = 30.0


def run_imperfect(
    robot: Robot, motion: SineTrajectory, pushes: tuple[Push, ...], end: float, seed: int
) -> ImperfectResult:
    """Calibrates an arm with the errors of `ImperfectArm.typical`, moves and pushes it as the ideal one.

    It follows the motion exactly, and forces rise and fall as smooth bells in place of half-sines.

    Args:
        robot: as described.
        motion: of the joints.
        pushes: on them.
        end: of the motion [s].
        seed: of its errors, noise, and motion for calibration.
    """
    arm = ImperfectArm.typical(robot, seed)
    calibration = _calibrated(robot, arm, seed)
    run = record_imperfect(robot, arm, _sampled(motion, end), [_contact(push) for push in pushes], seed=seed)
    return _judged(robot, run, pushes, calibration)


def _calibrated(robot: Robot, arm: ImperfectArm, seed: int) -> Calibration:
    plan = exciting_motion(robot, CALIBRATION, dt=DT, seed=seed)
    free = record_imperfect(robot, arm, JointMotion(plan.time, plan.q, plan.v, plan.a), seed=seed + 1)
    return calibrate(robot, free.log)


def _sampled(motion: SineTrajectory, end: float) -> JointMotion:
    time = DT * np.arange(round(end / DT) + 1)
    points = [motion.at(float(each)) for each in time]
    q, v, a = ([getattr(point, name) for point in points] for name in ("q", "v", "a"))
    return JointMotion(time, q, v, a)


def _contact(push: Push) -> PersonContact:
    force = push.peak_force * push.direction
    return PersonContact(
        push.link, push.point_local, force, push.start, push.duration, rise=0.5 * push.duration
    )


def _judged(
    robot: Robot, run: ImperfectRun, pushes: tuple[Push, ...], calibration: Calibration
) -> ImperfectResult:
    log, truth = run.log, run.truth
    assert log.tau is not None
    monitor = ContactMonitor(robot, dt=DT, calibration=calibration)
    threshold = monitor.torque_threshold
    waiting = [HitScorer(robot, push, number, threshold, log.q[0]) for number, push in enumerate(pushes, 1)]
    scored, false_alarms = [], 0
    torque = np.empty_like(log.v)
    force, collision = np.full(len(log), np.nan), np.zeros(len(log), dtype=bool)
    steps = np.diff(log.time, prepend=log.time[0] - DT)
    for row, time in enumerate(truth.time):
        report = monitor.update(log.q[row], log.v[row], log.tau[row], dt=steps[row])
        torque[row], collision[row] = report.external_torque, report.collision
        contact = strongest(report)
        if contact is not None and contact.located:
            force[row] = np.linalg.norm(contact.force)
        while waiting and time > waiting[0].end:
            scored.append(waiting.pop(0).result())
        if waiting and waiting[0].covers(time):
            waiting[0].update(time, log.q[row], report)
        else:
            false_alarms += report.onset
    scored += [each.result() for each in waiting]
    true_force = np.sum(
        [push.peak_force * _contact(push).share(truth.time) for push in pushes], axis=0, initial=0.0
    )
    return ImperfectResult(
        hits=tuple(scored),
        false_alarms=false_alarms,
        signals=Signals(truth.time, truth.external_torque, torque, true_force, force, collision),
        calibration_seconds=CALIBRATION,
        torque_threshold=threshold,
    )

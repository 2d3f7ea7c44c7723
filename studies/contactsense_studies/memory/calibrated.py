"""Runs of an arm with the errors of a real one, which is calibrated before from motion without contact."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from contactsense import Calibration, InputError, MomentumObserver, Robot, calibrate, exciting_motion
from contactsense.sim import (
    ContactRun,
    ImperfectArm,
    JointMotion,
    Pace,
    PersonContact,
    joint_exploration,
    record_imperfect,
    record_quasi_static,
    touch_scene,
)
from contactsense.sim._arrays import FloatArray

DT = 2e-3  # [s]
GAIN = 50.0  # of the observer [1/s]
CALIBRATION = 20.0  # length of the motion without contact [s]
PACE = Pace(motions=40, duration=0.25, rate=1.0 / DT)
EVERY = 20  # row that is handed on
SETTLING = 0.3  # of the observer, which the first contact hits at once [s]
TRIES = 10


@dataclass(frozen=True, eq=False)
class _Leaning(PersonContact):
    """The contact with an obstacle, as it was recorded without the errors, in place of a person's."""

    run: ContactRun

    def share(self, time: FloatArray) -> FloatArray:
        return np.ones_like(time)

    def at(self, time: float, link_pose: FloatArray) -> tuple[FloatArray, FloatArray]:
        row = int(np.argmin(np.abs(self.run.time - time)))
        return self.run.point[row], self.run.force[row]


def record_calibrated(robot: Robot, link: str, friction: float, seed: int) -> tuple[ContactRun, Calibration]:
    """What an arm drawn with `seed` measures of one contact, and what it has learnt of itself before.

    Raises:
        InputError: the link cannot be touched so.
    """
    arm = ImperfectArm.typical(robot, seed)
    plan = exciting_motion(robot, CALIBRATION, dt=DT, seed=seed)
    motion = JointMotion(plan.time, plan.q, plan.v, plan.a)
    calibration = calibrate(robot, record_imperfect(robot, arm, motion, seed=seed).log)
    return _measured(robot, arm, _leaning(robot, link, friction, seed), calibration, seed), calibration


def _leaning(robot: Robot, link: str, friction: float, seed: int) -> _Leaning:
    cause: InputError | None = None
    for chance in np.random.SeedSequence(seed).generate_state(TRIES).tolist():
        try:
            scene = touch_scene(robot, link, least_torque=0.5, seed=chance)
            path = joint_exploration(robot, scene, pace=PACE, seed=chance)
        except InputError as refused:
            cause = refused
            continue
        contact = scene.contact(robot, friction=friction)
        run = record_quasi_static(robot, contact, path.time, path.q)
        # The last tick is left out, lest rounding ends the contact after the motion.
        start, duration = float(run.time[0]), float(run.time[-2] - run.time[0])
        # Where the force is and how it changes is the run's, not a person's.
        return _Leaning(link, np.zeros(3), np.zeros(3), start, duration, 0.5 * duration, run=run)
    raise InputError(f"link: '{link}' does not keep a contact in {TRIES} scenes") from cause


def _measured(
    robot: Robot, arm: ImperfectArm, leaning: _Leaning, calibration: Calibration, seed: int
) -> ContactRun:
    run = leaning.run
    v = np.gradient(run.q, run.time, axis=0)
    motion = JointMotion(run.time, run.q, v, np.gradient(v, run.time, axis=0))
    read = record_imperfect(robot, arm, motion, [leaning], seed=seed + 1)
    observer = MomentumObserver(robot, dt=DT, gain=GAIN, calibration=calibration)
    log, steps = read.log, np.diff(read.log.time, prepend=read.log.time[0] - DT)
    assert log.v is not None
    assert log.tau is not None
    external = [
        observer.update(q, v, tau, dt=max(step, 0.1 * DT))
        for q, v, tau, step in zip(log.q, log.v, log.tau, steps, strict=True)
    ]
    # Rows that were dropped, if any, are missing in the log.
    kept = np.searchsorted(run.time, read.truth.time - 0.5 * DT)
    shown = (read.truth.time >= run.time[0] + SETTLING) & (np.arange(len(kept)) % EVERY == 0)
    rows = kept[shown]
    return replace(
        run,
        time=log.time[shown],
        q=log.q[shown],
        v=log.v[shown],
        tau=log.tau[shown],
        external_torque=np.array(external)[shown],
        true_external_torque=read.truth.external_torque[shown],
        link=tuple(run.link[row] for row in rows),
        point=run.point[rows],
        normal=run.normal[rows],
        force=run.force[rows],
    )

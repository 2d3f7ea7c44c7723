"""Detection with a calibration: one statistic of all joints and several gains."""

from __future__ import annotations

import numpy as np
import pytest

import contactsense as cs
from contactsense.sim import ImperfectArm, PersonScene

ROBOT = cs.Robot.named("iiwa14")
# An arm that nothing was tuned on.
SEED = 61


@pytest.fixture(scope="module")
def arm() -> ImperfectArm:
    return ImperfectArm.typical(ROBOT, seed=SEED)


@pytest.fixture(scope="module")
def calibration(arm) -> cs.Calibration:
    motion = PersonScene(seconds=60.0, contacts=0, seed=SEED).record(ROBOT, arm)
    return cs.calibrate(ROBOT, motion.log)


def reports_of(log: cs.Log, **options):
    monitor = cs.ContactMonitor(ROBOT, dt=1e-3, **options)
    steps = np.diff(log.time, prepend=log.time[0] - 1e-3)
    for row, step in enumerate(steps):
        yield monitor.update(log.q[row], log.v[row], log.tau[row], dt=float(step))


def test_free_motion_is_no_contact_and_contacts_are_detected(arm, calibration) -> None:
    scene = PersonScene(
        seconds=75.0, contacts=20, contact_free=15.0, force=(10.0, 40.0), duration=(0.3, 1.0), seed=SEED + 1
    )
    run = scene.record(ROBOT, arm)
    onset = np.array([report.onset for report in reports_of(run.log, calibration=calibration)])
    detected = [onset[c.rows.start : c.rows.stop + 50].any() for c in run.truth.contacts]
    outside = np.ones(len(onset), dtype=bool)
    for contact in run.truth.contacts:
        outside[contact.rows.start : contact.rows.stop + 100] = False
    # 16 of 20 and none, and one and two fewer or more for other processors.
    assert np.mean(detected) >= 0.6, detected
    assert onset[outside].sum() <= 2
    # Without a calibration the same arm reports a contact nearly always.
    uncalibrated = np.array([report.collision for report in reports_of(run.log)])
    assert uncalibrated[:15000].mean() > 0.2


def test_lost_ticks_are_no_contact(arm, calibration) -> None:
    log = PersonScene(seconds=20.0, contacts=0, seed=SEED + 2).record(ROBOT, arm).log
    rng = np.random.default_rng(3)
    kept = np.ones(len(log), dtype=bool)
    for start in rng.integers(0, len(log), 40):
        kept[start : start + rng.integers(1, 20)] = False
    thinned = cs.Log(log.time[kept], log.q[kept], log.v[kept], log.tau[kept])
    assert sum(report.onset for report in reports_of(thinned, calibration=calibration)) == 0


def test_significance_is_in_standard_deviations() -> None:
    calibration = cs.Calibration.of_description(ROBOT)
    monitor = cs.ContactMonitor(ROBOT, dt=1e-3, calibration=calibration)
    q, v = np.full(7, 0.3), np.zeros(7)
    weight = ROBOT.inverse_dynamics(q, v, v)
    for _ in range(200):
        free = monitor.update(q, v, weight)
    assert free.significance is not None
    assert free.significance < 2.0
    assert not free.collision
    found = []
    for force in (2.0, 5.0, 20.0):
        torque = ROBOT.jacobian(q, "iiwa_link_6")[:3].T @ [0.0, force, 0.0]
        monitor.reset()
        for _ in range(200):
            report = monitor.update(q, v, weight - torque)
        found.append(report.significance)
    assert found == sorted(found)
    assert found[-1] > 5.0
    assert report.collision
    assert report.links


def test_contacts_that_follow_each_other_soon_are_told_apart() -> None:
    monitor = cs.ContactMonitor(ROBOT, dt=1e-3, calibration=cs.Calibration.of_description(ROBOT))
    q, v = np.full(7, 0.3), np.zeros(7)
    weight = ROBOT.inverse_dynamics(q, v, v)
    push = ROBOT.jacobian(q, "iiwa_link_6")[:3].T @ [0.0, 40.0, 0.0]
    onsets = []
    for tick in range(3000):
        touched = tick >= 1000 and tick % 400 < 200
        if monitor.update(q, v, weight - push * touched).onset:
            onsets.append(tick)
    # Within 10 ms of each push; the slowest observer still holds a fifth of the one before.
    assert [onset - onset % 400 for onset in onsets] == [1200, 1600, 2000, 2400, 2800]
    assert max(onset % 400 for onset in onsets) < 10


def test_thresholds_of_joints_remain_a_choice() -> None:
    calibration = cs.Calibration.of_description(ROBOT)
    q, v = np.full(7, 0.3), np.zeros(7)
    tau = ROBOT.inverse_dynamics(q, v, v)
    monitor = cs.ContactMonitor(ROBOT, dt=1e-3, calibration=calibration, torque_threshold=2.0)
    assert monitor.update(q, v, tau).significance is None
    monitor = cs.ContactMonitor(ROBOT, dt=1e-3, calibration=calibration)
    assert monitor.update(q, v, tau).significance is not None
    monitor.torque_threshold = 2.0
    assert monitor.update(q, v, tau).significance is None
    assert monitor.torque_threshold[0] == 2.0

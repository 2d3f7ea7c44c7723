"""A payload that is picked up and put down while the monitor runs."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import contactsense as cs

IIWA = cs.Robot.named("iiwa14")
DT = 1e-3
LINK, MASS, COM = "iiwa_link_7", 2.0, [0.02, -0.01, 0.1]
LOADED = IIWA.with_payload(LINK, MASS, COM)
OMEGA = 2 * np.pi * np.array([0.30, 0.35, 0.40, 0.45, 0.50, 0.55, 0.60])
HALF = 1.5  # before the change and after it [s]


@cache
def motion(seed: int) -> tuple[np.ndarray, ...]:
    rng = np.random.default_rng(seed)
    angle = OMEGA * DT * np.arange(int(2 * HALF / DT))[:, None] + rng.uniform(0.0, 2 * np.pi, 7)
    middle = rng.uniform(-0.7, 0.7, 7) + np.array([0.0, 0.5, 0.0, -1.0, 0.0, 0.5, 0.0])
    return middle + 0.3 * np.sin(angle), 0.3 * OMEGA * np.cos(angle), -0.3 * OMEGA**2 * np.sin(angle)


@cache
def torques(seed: int) -> np.ndarray:
    """Without and with the payload."""
    rows = list(zip(*motion(seed), strict=True))
    return np.array([[robot.inverse_dynamics(*row) for row in rows] for robot in (IIWA, LOADED)])


def onsets(seed: int, borne: int, said: int, *, picked_up: bool = True, **options: object) -> list[int]:
    """Ticks of onsets; `borne` and `said` are the first ticks with the other load."""
    rng = np.random.default_rng([seed, 1])
    monitor = cs.ContactMonitor(IIWA, dt=DT, **options)
    if not picked_up:
        monitor.set_payload(LINK, MASS, COM)
    q, v, _ = motion(seed)
    found = []
    for tick in range(len(q)):
        if tick == said:
            monitor.set_payload(LINK, MASS, COM) if picked_up else monitor.clear_payload()
        has = (tick >= borne) == picked_up
        tau = torques(seed)[int(has), tick] + rng.normal(scale=0.05, size=7)
        if monitor.update(q[tick], v[tick], tau).onset:
            found.append(tick)
    return found


def calibration() -> cs.Calibration:
    return cs.Calibration.of_description(IIWA)


@pytest.mark.parametrize("picked_up", [True, False])
@pytest.mark.parametrize("calibrated", [True, False])
def test_a_change_at_one_tick_is_no_contact(calibrated: bool, picked_up: bool) -> None:
    options = {"calibration": calibration()} if calibrated else {"torque_threshold": 1.0}
    change = int(HALF / DT)
    for seed in range(3):
        assert not onsets(seed, change, change, picked_up=picked_up, **options)


def test_a_weight_that_comes_a_little_later_than_announced_is_no_contact() -> None:
    change = int(HALF / DT)
    for seed, late in enumerate((50, 150, 300)):
        assert not onsets(seed, change + late, change, calibration=calibration())


def test_a_weight_that_is_not_announced_is_an_external_torque() -> None:
    change = int(HALF / DT)
    (found,) = onsets(0, change, change + 300, calibration=calibration())
    assert change <= found < change + 60


def test_a_contact_goes_on_over_the_change_and_is_found_after_it() -> None:
    monitor = cs.ContactMonitor(IIWA, dt=DT, calibration=calibration())
    q, rest = np.array([0.3, 0.6, -0.4, -1.2, 0.5, 0.9, 0.1]), np.zeros(7)
    weight = [robot.inverse_dynamics(q, rest, rest) for robot in (IIWA, LOADED)]
    push = IIWA.jacobian(q, "iiwa_link_5")[:3].T @ [30.0, 20.0, 0.0]
    for _ in range(500):
        monitor.update(q, rest, weight[0])
    before = [monitor.update(q, rest, weight[0] - push) for _ in range(200)][-1]
    monitor.set_payload(LINK, MASS, COM)
    after = [monitor.update(q, rest, weight[1] - push) for _ in range(200)]
    assert before.collision
    assert all(report.collision and not report.onset for report in after)
    np.testing.assert_allclose(after[0].external_torque, before.external_torque, atol=1e-9)
    for _ in range(2000):
        last = monitor.update(q, rest, weight[1])
    assert not last.collision
    assert any(monitor.update(q, rest, weight[1] - push).onset for _ in range(100))


def test_the_robot_is_the_one_with_its_payload() -> None:
    monitor = cs.ContactMonitor(IIWA, dt=DT)
    monitor.set_payload(LINK, 1.0, COM)
    monitor.set_payload(LINK, MASS, COM)  # in place of the first
    assert monitor.robot.mass == pytest.approx(IIWA.mass + MASS)
    assert isinstance(monitor.robot, cs.Robot)
    monitor.reset()
    assert monitor.robot.mass == pytest.approx(IIWA.mass + MASS)
    q, rest = np.full(7, 0.4), np.zeros(7)
    for _ in range(200):
        report = monitor.update(q, rest, LOADED.inverse_dynamics(q, rest, rest))
    np.testing.assert_allclose(report.external_torque, 0.0, atol=1e-6)
    monitor.clear_payload()
    monitor.clear_payload()
    assert monitor.robot is IIWA


@pytest.mark.parametrize(
    ("name", "arguments"),
    [
        ("link", ("nothing", 1.0, COM)),
        ("mass", (LINK, -1.0, COM)),
        ("mass", (LINK, np.nan, COM)),
        ("com", (LINK, 1.0, [0.0, np.inf, 0.0])),
        ("com", (LINK, 1.0, [0.0, 0.0])),
    ],
)
def test_what_is_no_payload_is_refused(name: str, arguments: tuple[object, ...]) -> None:
    monitor = cs.ContactMonitor(IIWA, dt=DT)
    with pytest.raises(cs.InputError, match=rf"^{name}: "):
        monitor.set_payload(*arguments)
    assert monitor.robot is IIWA


def test_sensors_read_the_payload_too() -> None:
    sensor = cs.ForceTorqueSensor("wrist", "iiwa_link_6")
    monitor = cs.ContactMonitor(IIWA, dt=DT, sensors=[sensor], torque_threshold=0.5)
    q, rest = np.array([0.3, 0.6, -0.4, -1.2, 0.5, 0.9, 0.1]), np.zeros(7)
    turn = IIWA.link_pose(q, sensor.link)[:3, :3].T
    readings, taus = [], []
    for robot in (IIWA, LOADED):
        missing = cs.LoadCompensator(robot, [sensor]).update(q, rest, rest, np.zeros((1, 6)))[0]
        readings.append(-np.r_[turn @ missing[:3], turn @ missing[3:]][None])
        taus.append(robot.inverse_dynamics(q, rest, rest))
    for _ in range(300):
        monitor.update(q, rest, taus[0], readings[0])
    monitor.set_payload(LINK, MASS, COM)
    for _ in range(300):
        report = monitor.update(q, rest, taus[1], readings[1])
        assert not report.collision
        np.testing.assert_allclose(report.wrenches, 0.0, atol=1e-6)


# A gripper that the model lacks, mounted after the calibration.
GRIPPER_MASS, GRIPPER_COM = 0.73, (0.01, -0.02, 0.09)


@cache
def realistic() -> tuple[object, cs.Calibration]:
    """An arm with errors and its calibration."""
    pytest.importorskip("mujoco", reason="the simulation needs MuJoCo: pip install contactsense[sim]")
    from contactsense import sim

    arm = sim.ImperfectArm.typical(IIWA, 11)
    plan = cs.exciting_motion(IIWA, 60.0, dt=DT, seed=5)
    log = sim.record_imperfect(IIWA, arm, sim.JointMotion(plan.time, plan.q, plan.v, plan.a), seed=5).log
    return arm, cs.calibrate(IIWA, log)


def after_motion(seed: int, *, gripper: bool, contacts: int) -> cs.ContactMonitor:
    arm, calibrated = realistic()
    from contactsense import sim

    assert isinstance(arm, sim.ImperfectArm)
    if gripper:
        arm = replace(arm, payload=sim.Payload(LINK, GRIPPER_MASS, GRIPPER_COM))
    log = (
        sim.PersonScene(seconds=20.0, contacts=contacts, force=(10.0, 40.0), seed=seed).record(IIWA, arm).log
    )
    monitor = cs.ContactMonitor(IIWA, dt=DT, calibration=calibrated)
    assert log.tau is not None
    for q, v, tau in zip(log.q, log.v, log.tau, strict=True):
        monitor.update(q, v, tau)
    return monitor


@pytest.mark.parametrize("contacts", [0, 3])
def test_a_gripper_that_the_model_lacks_is_proposed(contacts: int) -> None:
    monitor = after_motion(21 + contacts, gripper=True, contacts=contacts)
    found = monitor.propose_payload()
    assert found is not None
    assert found.link == LINK
    assert found.mass == pytest.approx(GRIPPER_MASS, rel=0.05)
    np.testing.assert_allclose(found.com, GRIPPER_COM, atol=0.01)
    assert found.poses >= 3
    assert 0.6 <= found.evidence <= 1.0
    assert abs(found.mass - GRIPPER_MASS) < 3.0 * found.mass_std < 0.2
    assert (found.com_std < 0.03).all()
    # Taken over, it is no longer missing.
    monitor.set_payload(found.link, found.mass, found.com)
    assert monitor.propose_payload() is None


@pytest.mark.parametrize("contacts", [0, 3])
def test_without_a_payload_none_is_proposed(contacts: int) -> None:
    assert after_motion(31 + contacts, gripper=False, contacts=contacts).propose_payload() is None


def after_holding(torque: object, poses: int) -> cs.PayloadProposal | None:
    """Of `torque(q)` from outside in some poses, held for 3 s each."""
    assert callable(torque)
    monitor = cs.ContactMonitor(IIWA, dt=0.01, calibration=calibration())
    rest = np.zeros(7)
    for pose in range(poses):
        q = IIWA.random_configuration(40 + pose)
        tau = IIWA.inverse_dynamics(q, rest, rest) - torque(q)
        for tick in range(300):
            # Between two poses nothing is known.
            monitor.update(q, rest, tau, dt=1.0 if tick == 0 and pose else None)
    return monitor.propose_payload()


def weight(q: np.ndarray) -> np.ndarray:
    rest = np.zeros(7)
    return IIWA.inverse_dynamics(q, rest, rest) - LOADED.inverse_dynamics(q, rest, rest)


def test_it_takes_three_poses() -> None:
    assert after_holding(weight, 2) is None
    found = after_holding(weight, 4)
    assert found is not None
    assert found.mass == pytest.approx(MASS, rel=0.02)
    np.testing.assert_allclose(found.com, COM, atol=5e-3)


@pytest.mark.parametrize("with_link", [False, True])
def test_a_held_force_that_does_not_turn_with_gravity_is_no_payload(with_link: bool) -> None:
    def pushed(q: np.ndarray) -> np.ndarray:
        pose = IIWA.link_pose(q, LINK)
        force = pose[:3, :3] @ [15.0, 0.0, 12.0] if with_link else np.array([15.0, 10.0, 0.0])
        point = pose[:3, :3] @ [0.0, 0.0, 0.05] + pose[:3, 3]
        torque: np.ndarray = IIWA.jacobian(q, LINK, point)[:3].T @ force
        return torque

    assert after_holding(pushed, 5) is None

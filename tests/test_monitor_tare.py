"""`ContactMonitor.tare`: what an untouched robot reads becomes zero."""

from __future__ import annotations

import numpy as np
import pytest

import contactsense as cs

ROBOT = cs.Robot.named("iiwa14")
LINK = "iiwa_link_7"
STILL = np.zeros(7)
Q = np.array([0.3, 0.6, -0.4, -1.2, 0.5, 0.9, 0.1])
BIAS = np.array([0.9, -1.4, 0.3, 0.8, -0.6, 0.2, 0.1])  # [Nm]
OFFSET = np.array([6.0, -9.0, 14.0, 0.3, -0.4, 0.2])  # [N, Nm]
TOOL = (0.9, [0.01, -0.02, 0.08])
NOISE = (0.05, 0.2, 0.01)  # torque [Nm], force [N], moment [Nm]

# How monitors follow a bias: not at all, with thresholds, and with all joints tested at once.
CALIBRATION = cs.Calibration.of_description(ROBOT.with_payload(LINK, *TOOL))
WAYS = {
    "fixed": {},
    "followed": {"bias_time_constant": 0.5},
    "calibrated": {"calibration": CALIBRATION},
}


class Wrist:
    """The arm with a tool that the model has, on a sensor whose readings have an offset and noise."""

    def __init__(self, convention: str = "support", noisy: bool = True) -> None:
        self.robot = ROBOT.with_payload(LINK, *TOOL)
        pose = np.eye(4)
        pose[:3, :3] = [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]
        self.sensor = cs.ForceTorqueSensor("wrist", LINK, pose=pose, convention=convention)
        self.compensator = cs.LoadCompensator(self.robot, [self.sensor])
        self.rng = np.random.default_rng(3)
        self.noisy = noisy

    def update(self, monitor: cs.ContactMonitor, q: np.ndarray, ticks: int, torque: np.ndarray = STILL):
        """Ticks at a pose, with an external torque that no sensor sees; the last report."""
        weight = self.robot.inverse_dynamics(q, STILL, STILL)
        free = -self.compensator.tare(q, np.zeros((1, 6)))
        for _ in range(ticks):
            white = self.rng.normal(0.0, 1.0, 13) * self.noisy
            tau = weight - torque - BIAS + NOISE[0] * white[:7]
            reading = free + OFFSET + white[7:] * np.repeat(NOISE[1:], 3)
            report = monitor.update(q, STILL, tau, reading if monitor.sensors else None)
        return report


@pytest.mark.parametrize("convention", ["load", "support"])
@pytest.mark.parametrize("way", WAYS)
def test_offsets_and_bias_are_gone_at_other_poses(way: str, convention: str) -> None:
    wrist = Wrist(convention)
    monitor = cs.ContactMonitor(wrist.robot, dt=1e-3, sensors=[wrist.sensor], **WAYS[way])
    # A force behind the sensor, as far as the monitor knows.
    assert wrist.update(monitor, Q, 1200).collision
    monitor.tare()
    np.testing.assert_allclose(monitor.bias, BIAS, atol=0.02)
    error = monitor.sensors[0].offset - OFFSET
    assert np.abs(error[:3]).max() < 0.05
    assert np.abs(error[3:]).max() < 0.003
    assert not wrist.update(monitor, Q, 1).collision
    for seed in range(20):
        other = cs.ContactMonitor(wrist.robot, dt=1e-3, sensors=monitor.sensors)
        external = wrist.update(other, ROBOT.random_configuration(seed), 200).wrenches[0]
        assert np.linalg.norm(external[:3]) < 0.5, seed


@pytest.mark.parametrize("way", WAYS)
def test_zero_stays_zero_and_contacts_are_detected(way: str) -> None:
    wrist = Wrist()
    monitor = cs.ContactMonitor(wrist.robot, dt=1e-3, **WAYS[way])
    wrist.update(monitor, Q, 800)
    monitor.tare()
    for _ in range(40):
        report = wrist.update(monitor, Q, 100)
        assert not report.collision
        assert np.abs(report.external_torque).max() < 0.1
    push = ROBOT.jacobian(Q, LINK)[:3].T @ [0.0, 30.0, 20.0]
    report = wrist.update(monitor, Q, 300, push)
    assert report.collision
    np.testing.assert_allclose(report.external_torque, push, atol=0.3)
    monitor.reset()
    assert np.all(monitor.bias == 0.0)


def test_a_sensor_with_wanted_contacts() -> None:
    wrist = Wrist()
    monitor = cs.ContactMonitor(
        wrist.robot, dt=1e-3, sensors=[wrist.sensor], wanted_contacts=["wrist"], torque_threshold=0.3
    )
    wrist.update(monitor, Q, 500)
    monitor.tare()
    for _ in range(20):
        report = wrist.update(monitor, Q, 20)
        assert not report.collision
        assert np.abs(report.collision_torque).max() < 0.1


def test_external_torques_of_a_vendor() -> None:
    rng = np.random.default_rng(5)
    for options in ({}, {"bias_time_constant": 0.5}):
        monitor = cs.ContactMonitor(ROBOT, dt=1e-3, **options)
        for _ in range(300):
            monitor.update_external(Q, BIAS + rng.normal(0.0, 0.05, 7))
        monitor.tare()
        np.testing.assert_allclose(monitor.bias, BIAS, atol=0.02)
        report = monitor.update_external(Q, BIAS)
        assert not report.collision
        assert np.abs(report.external_torque).max() < 0.02


def test_the_last_of_a_contact_is_no_bias() -> None:
    wrist = Wrist(noisy=False)
    monitor = cs.ContactMonitor(wrist.robot, dt=1e-3, torque_threshold=2.0)
    wrist.update(monitor, Q, 300)
    push = ROBOT.jacobian(Q, LINK)[:3].T @ [0.0, 30.0, 20.0]
    assert wrist.update(monitor, Q, 100, push).collision
    with pytest.raises(cs.InputError, match=r"tare: there is a contact.*reset\(\)"):
        monitor.tare()
    while wrist.update(monitor, Q, 1).collision:
        pass
    with pytest.raises(cs.InputError, match="not known yet"):
        monitor.tare()
    wrist.update(monitor, Q, 101)
    monitor.tare()
    np.testing.assert_allclose(monitor.bias, BIAS, atol=0.02)


def test_what_cannot_be_tared_changes_nothing() -> None:
    wrist = Wrist(noisy=False)
    monitor = cs.ContactMonitor(wrist.robot, dt=1e-3, sensors=[wrist.sensor], bias_limit=1.0)
    with pytest.raises(cs.InputError, match="not known yet"):
        monitor.tare()
    before = wrist.update(monitor, Q, 1)
    with pytest.raises(cs.InputError, match="not known yet"):
        monitor.tare()
    before = wrist.update(monitor, Q, 500)
    with pytest.raises(cs.InputError, match=r"0 is 0\.900 .* beyond the 0\.500 that bias_limit"):
        monitor.tare()
    assert np.all(monitor.sensors[0].offset == 0.0)
    assert np.all(monitor.bias == 0.0)
    after = wrist.update(monitor, Q, 1)
    np.testing.assert_allclose(after.external_torque, before.external_torque, atol=1e-6)
    np.testing.assert_allclose(after.wrenches[0], before.wrenches[0], atol=1e-6)


def test_a_sensor_without_readings_keeps_its_offset() -> None:
    given = cs.ForceTorqueSensor("wrist", LINK, offset=[1.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    monitor = cs.ContactMonitor(ROBOT, dt=1e-3, sensors=[given])
    tau = ROBOT.inverse_dynamics(Q, STILL, STILL)
    for _ in range(300):
        monitor.update(Q, STILL, tau, np.full((1, 6), np.nan))
    monitor.tare()
    assert monitor.sensors == (given,)

"""The monitor with a vendor's external torque in place of the observer's."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import contactsense as cs

IIWA = cs.Robot.named("iiwa14")
DT = 1e-3
Q = np.array([0.3, 0.6, -0.4, -1.2, 0.5, 0.9, 0.1])
V = np.zeros(7)
THRESHOLD = 0.5


def external_calibration(path: Path, **noise: float) -> cs.Calibration:
    """A calibration of external torques that corrects nothing."""
    cs.Calibration.of_description(IIWA).save(path)
    text = path.read_text(encoding="utf-8")
    assert "torque_is_external: false" in text
    path.write_text(text.replace("torque_is_external: false", "torque_is_external: true"), encoding="utf-8")
    return cs.Calibration.load(path)


def push(link: str, force: list[float]) -> np.ndarray:
    return IIWA.jacobian(Q, link)[:3].T @ force


def test_the_given_torque_is_reported_and_detected_at_once() -> None:
    monitor = cs.ContactMonitor(IIWA, dt=DT, torque_threshold=THRESHOLD)
    free = monitor.update_external(Q, np.full(7, 0.4))
    assert not free.collision
    assert free.time == 0.0
    torque = push("iiwa_link_7", [15.0, 0.0, 0.0])
    report = monitor.update_external(Q, torque, v=V)
    np.testing.assert_array_equal(report.external_torque, torque)
    assert report.onset
    assert report.contacts
    # The motors' torque is not known.
    assert np.isnan(report.acceleration).all()


def test_a_contact_in_the_first_sample_is_seen() -> None:
    monitor = cs.ContactMonitor(IIWA, dt=DT, torque_threshold=THRESHOLD)
    assert monitor.update_external(Q, push("iiwa_link_7", [15.0, 0.0, 0.0])).onset


def test_the_bias_is_followed_and_subtracted() -> None:
    monitor = cs.ContactMonitor(IIWA, dt=DT, torque_threshold=THRESHOLD, bias_time_constant=0.2)
    bias = np.linspace(-2.0, 2.0, 7)
    reports = [monitor.update_external(Q, bias) for _ in range(1000)]
    assert not any(report.collision for report in reports)
    np.testing.assert_allclose(monitor.bias, bias, atol=1e-6)
    np.testing.assert_allclose(reports[-1].external_torque, 0.0, atol=1e-6)
    assert monitor.update_external(Q, bias + push("iiwa_link_7", [15.0, 0.0, 0.0])).onset


def test_a_gap_delays_nothing() -> None:
    monitor = cs.ContactMonitor(IIWA, dt=DT, torque_threshold=THRESHOLD)
    monitor.update_external(Q, V)
    report = monitor.update_external(Q, push("iiwa_link_7", [15.0, 0.0, 0.0]), dt=0.7)
    assert report.onset
    assert report.time == pytest.approx(0.7)


def test_two_sources_are_not_mixed() -> None:
    monitor = cs.ContactMonitor(IIWA, dt=DT)
    weight = IIWA.inverse_dynamics(Q, V, V)
    monitor.update_external(Q, V)
    with pytest.raises(cs.InputError, match=r"tau: .*update_external.*reset\(\)"):
        monitor.update(Q, V, weight)
    monitor.reset()
    assert not monitor.update(Q, V, weight).collision
    with pytest.raises(cs.InputError, match=r"tau_ext: .*update.*reset\(\)"):
        monitor.update_external(Q, V)
    # A sample refused is a sample missed.
    assert monitor.update(Q, V, weight).time == pytest.approx(2 * DT)
    monitor.reset()
    assert not monitor.update_external(Q, V).collision


def test_what_is_refused_changes_nothing() -> None:
    monitor = cs.ContactMonitor(IIWA, dt=DT, torque_threshold=THRESHOLD, bias_time_constant=0.2)
    monitor.update_external(Q, V)
    bias = monitor.bias
    wrong = {"q": Q[1:], "tau_ext": np.full(7, np.nan), "v": V[1:], "dt": -1.0, "wrenches": np.zeros((1, 6))}
    for name, value in wrong.items():
        arguments = {"q": Q, "tau_ext": V} | {name: value}
        with pytest.raises(cs.InputError, match=rf"^{name}: "):
            monitor.update_external(**arguments)
    np.testing.assert_array_equal(monitor.bias, bias)
    # Each refused sample took a tick; the one with a measured step that no clock has did not say how long.
    assert monitor.update_external(Q, V).time == pytest.approx(6 * DT)


def test_calibration_and_torque_are_of_one_kind(tmp_path: Path) -> None:
    of_motors = cs.ContactMonitor(IIWA, dt=DT, calibration=cs.Calibration.of_description(IIWA))
    with pytest.raises(cs.InputError, match="tau_ext: the calibration is of torques of the motors"):
        of_motors.update_external(Q, V)
    external = cs.ContactMonitor(IIWA, dt=DT, calibration=external_calibration(tmp_path / "iiwa.yaml"))
    with pytest.raises(cs.InputError, match="tau: the calibration is of external torques"):
        external.update(Q, V, V)


def test_all_joints_are_tested_behind_several_gains(tmp_path: Path) -> None:
    """A weak contact is found that no joint's threshold on the raw torque would show."""
    calibration = external_calibration(tmp_path / "iiwa.yaml")
    monitor = cs.ContactMonitor(IIWA, dt=DT, calibration=calibration)
    rng = np.random.default_rng(1)
    bias = rng.normal(scale=0.05, size=7)
    noise = lambda: bias + rng.normal(scale=0.05, size=7)  # noqa: E731
    free = [monitor.update_external(Q, noise(), v=V) for _ in range(10_000)]
    assert not any(report.collision for report in free)
    assert free[-1].significance is not None
    # Thresholds on single joints are for the noise of each sample.
    torque = push("iiwa_link_6", [4.0, 3.0, 0.0])
    touched = [monitor.update_external(Q, noise() + torque, v=V) for _ in range(300)]
    delay = next(k for k, report in enumerate(touched) if report.collision)
    assert delay < 100
    np.testing.assert_allclose(
        np.mean([report.external_torque for report in touched], axis=0), torque, atol=0.15
    )
    released = [monitor.update_external(Q, noise(), v=V) for _ in range(1500)]
    assert not released[-1].collision


@pytest.mark.parametrize("calibrated", [False, True])
def test_a_wanted_contact_behind_a_sensor_is_left_out_without_lag(calibrated: bool, tmp_path: Path) -> None:
    sensor = cs.ForceTorqueSensor("wrist", "iiwa_link_6")
    options = (
        {"calibration": external_calibration(tmp_path / "iiwa.yaml")}
        if calibrated
        else {"torque_threshold": THRESHOLD}
    )
    monitor = cs.ContactMonitor(IIWA, dt=DT, sensors=[sensor], wanted_contacts=["wrist"], **options)
    pose = IIWA.link_pose(Q, "iiwa_link_6")
    weight = -cs.LoadCompensator(IIWA, [sensor]).update(Q, V, V, np.zeros((1, 6)))[0]
    force = np.array([20.0, -5.0, 10.0])
    turned = lambda wrench: np.r_[pose[:3, :3].T @ wrench[:3], pose[:3, :3].T @ wrench[3:]]  # noqa: E731
    free = turned(weight)[None]
    # What is at the sensor's own origin loads it with no moment.
    touched = turned(weight + np.r_[force, np.zeros(3)])[None]
    for _ in range(500):
        assert not monitor.update_external(Q, V, free).collision
    for tick in range(200):
        report = monitor.update_external(Q, push("iiwa_link_6", list(force)), touched)
        assert not report.collision, tick
    other = push("iiwa_link_6", list(force)) + push("iiwa_link_4", [0.0, 0.0, 40.0])
    assert any(monitor.update_external(Q, other, touched).collision for _ in range(50))

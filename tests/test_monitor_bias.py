"""The bias learns nothing from contacts or wrong readings, and only what hysteresis may have left."""

from __future__ import annotations

import numpy as np
import pytest

import contactsense as cs

DT = 1e-3
Q = np.array([0.3, 0.6, -0.4, -1.2, 0.5, 0.9, 0.2])
STILL = np.zeros(7)


@pytest.fixture(scope="module")
def arm() -> cs.Robot:
    return cs.Robot.named("iiwa14")


def monitor_of(robot: cs.Robot, **options: object) -> cs.ContactMonitor:
    options = {"observer_gain": 50.0, "torque_threshold": 0.5, "bias_time_constant": 1.0} | options
    return cs.ContactMonitor(robot, dt=DT, **options)


def run(
    monitor: cs.ContactMonitor, seconds: float, tau_ext: object = 0.0, noise: float = 0.0
) -> list[cs.ContactReport]:
    """A robot at rest under an external torque."""
    rng = np.random.default_rng(1)
    weight = monitor.robot.inverse_dynamics(Q, STILL, STILL) - tau_ext
    return [
        monitor.update(Q, STILL, weight + noise * rng.standard_normal(7)) for _ in range(round(seconds / DT))
    ]


def push(robot: cs.Robot, newtons: float, link: str = "iiwa_link_6") -> np.ndarray:
    """External torque of a sideways push on a link."""
    pose = robot.link_pose(Q, link)
    return robot.jacobian(Q, link, pose[:3, 3] + pose[:3, 2] * 0.05)[:3].T @ (
        newtons * np.array([0.6, -0.6, -0.53])
    )


@pytest.mark.parametrize("start", [0.0, 0.3, 0.75])
@pytest.mark.parametrize("bias", [0.0, 1.5])
def test_a_push_while_the_bias_is_learnt_is_not_learnt(arm: cs.Robot, start: float, bias: float) -> None:
    monitor = monitor_of(arm)
    run(monitor, start, bias, noise=0.1)
    run(monitor, 0.2, bias + 6.0, noise=0.1)
    run(monitor, 1.2 - start, bias, noise=0.1)
    np.testing.assert_allclose(monitor.bias, bias, atol=0.1)
    assert not any(report.collision for report in run(monitor, 1.0, bias, noise=0.1))
    assert run(monitor, 0.2, bias + 6.0)[-1].collision


@pytest.mark.parametrize("tick", [1, 500, 990, 1500])
@pytest.mark.parametrize("gain", [10.0, 50.0, 1000.0])
def test_an_impossible_tick_moves_no_bias(arm: cs.Robot, tick: int, gain: float) -> None:
    monitor = monitor_of(arm, observer_gain=gain)
    run(monitor, tick * DT, 0.3)
    run(monitor, DT, 1000.0)
    reports = run(monitor, 2.5, 0.3)
    assert not reports[-1].collision
    np.testing.assert_allclose(monitor.bias, 0.3, atol=0.05)


def test_a_bias_that_was_learnt_from_a_contact_is_given_up(arm: cs.Robot) -> None:
    monitor = monitor_of(arm, bias_time_constant=0.5)
    run(monitor, 1.0, 6.0)
    np.testing.assert_allclose(monitor.bias, 6.0, atol=0.1)
    reports = run(monitor, 1.0)
    assert not reports[-1].collision
    assert sum(report.remainder_learned for report in reports) == 1
    np.testing.assert_allclose(monitor.bias, 0.0, atol=0.05)


def test_the_bias_is_limited(arm: cs.Robot) -> None:
    # The sign of tau is wrong: no bias hides that.
    monitor = monitor_of(arm)
    weight = arm.inverse_dynamics(Q, STILL, STILL)
    assert np.abs(weight).max() > 0.5 * 30 / 2
    assert run(monitor, 3.0, 2.0 * weight)[-1].collision
    assert np.abs(monitor.bias).max() == 15.0
    monitor = monitor_of(arm, bias_limit=np.inf)
    assert not run(monitor, 3.0, 2.0 * weight)[-1].collision
    # Nor a torque that settles.
    monitor = monitor_of(arm, bias_settle_time=0.5, bias_limit=10.0)
    run(monitor, 1.5)
    assert not run(monitor, 2.0, [0, 4.5, 0, 0, 0, 0, 0])[-1].collision
    assert run(monitor, 2.0, [0, 6.0, 0, 0, 0, 0, 0])[-1].collision


@pytest.mark.parametrize("link", ["iiwa_link_4", "iiwa_link_6", "iiwa_link_7"])
@pytest.mark.parametrize("threshold", [0.2, 0.5, [2.0, 2.0, 1.5, 1.5, 0.5, 0.5, 0.3]])
def test_a_person_clamped_after_an_impact_is_not_forgotten(
    arm: cs.Robot, link: str, threshold: object
) -> None:
    monitor = monitor_of(arm, torque_threshold=threshold)
    run(monitor, 1.5)
    run(monitor, 0.05, push(arm, 200.0, link))
    reports = run(monitor, 20.0, push(arm, 15.0, link))
    assert all(report.collision for report in reports)
    assert not any(report.remainder_learned for report in reports)
    np.testing.assert_allclose(monitor.bias, 0.0, atol=0.01)


@pytest.mark.parametrize("share", [0.03, 0.08, 0.15])
def test_what_hysteresis_leaves_is_learnt_and_reported(arm: cs.Robot, share: float) -> None:
    monitor = monitor_of(arm, torque_threshold=0.2)
    run(monitor, 1.5, 0.1)
    contact = push(arm, 10.0)
    contact *= 2.0 / np.abs(contact).max()
    run(monitor, 1.0, 0.1 + contact)
    reports = run(monitor, 0.6, 0.1 + share * contact, noise=0.01)
    assert not reports[-1].collision
    # A small remainder is under the thresholds as it is.
    over = share * np.abs(contact).max() > 0.2
    assert sum(report.remainder_learned for report in reports) == over
    if over:
        np.testing.assert_allclose(monitor.bias, 0.1 + share * contact, atol=0.04)


def test_the_share_of_hysteresis_is_an_option(arm: cs.Robot) -> None:
    contact = np.array([0.0, 4.0, 0.0, 2.0, 0.0, 0.0, 0.0])
    for hysteresis, over in ((0.2, True), (0.1, False), ([0.1, 0.2, 0.1, 0.1, 0.1, 0.1, 0.1], True)):
        monitor = monitor_of(arm, hysteresis=hysteresis)
        run(monitor, 1.5)
        run(monitor, 0.5, contact)
        # Joint 2 keeps 15 % of its own, joint 4 less than a threshold.
        reports = run(monitor, 1.0, [0.0, 0.6, 0.0, 0.3, 0.0, 0.0, 0.0])
        assert reports[-1].collision != over, hysteresis


def test_another_contact_is_no_remainder(arm: cs.Robot) -> None:
    """Of a remainder's size, but against the contact before."""
    monitor = monitor_of(arm)
    run(monitor, 1.5)
    run(monitor, 0.5, [0, 8.0, 0, 4.0, 0, 0, 0])
    assert run(monitor, 5.0, [0, -0.8, 0, 0, 0, 0, 0])[-1].collision


def test_settling_is_reported(arm: cs.Robot) -> None:
    monitor = monitor_of(arm, bias_settle_time=1.0)
    run(monitor, 1.5)
    reports = run(monitor, 2.0, push(arm, 15.0))
    (learnt,) = (k for k, report in enumerate(reports) if report.remainder_learned)
    # It stands still once the observer knows it.
    assert 1.0 <= learnt * DT <= 1.2
    assert reports[learnt - 1].collision
    assert not reports[learnt].collision

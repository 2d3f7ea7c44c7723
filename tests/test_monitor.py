"""The pipeline: onset, hold, region, bias, reports, bad input."""

from __future__ import annotations

import numpy as np
import pytest

import contactsense as cs

DT = 1e-3


@pytest.fixture(scope="module")
def arm() -> cs.Robot:
    return cs.Robot.named("iiwa14")


class Still:
    """An arm at rest, with an external torque that is balanced by its motors."""

    def __init__(self, robot: cs.Robot) -> None:
        self.q = np.array([0.3, 0.6, -0.4, -1.2, 0.5, 0.9, 0.2])
        self.v = np.zeros(robot.nv)
        self.weight = robot.inverse_dynamics(self.q, self.v, self.v)

    def tick(
        self, monitor: cs.ContactMonitor, tau_ext: object = 0.0, dt: float | None = None
    ) -> cs.ContactReport:
        return monitor.update(self.q, self.v, self.weight - tau_ext, dt=dt)


def touch(
    robot: cs.Robot, still: Still, link: str, seed: int = 0
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A point of a link, a force there that enters the surface, and the external torque."""
    pose = robot.link_pose(still.q, link)
    sample = robot.surface(link).sample(1, seed=seed)
    point = pose[:3, :3] @ sample.points[0] + pose[:3, 3]
    # Tilted, so that the last joint feels it on a link that is round about its axis.
    force = pose[:3, :3] @ (-30.0 * sample.normals[0] + np.cross(sample.normals[0], [5.0, 6.0, 7.0]))
    return point, force, robot.jacobian(still.q, link, point)[:3].T @ force


def test_a_touch_is_felt_located_and_forgotten(arm: cs.Robot) -> None:
    still = Still(arm)
    monitor = cs.ContactMonitor(arm, dt=DT, observer_gain=500.0, torque_threshold=0.1, hold_time=0.01)
    point, force, tau_ext = touch(arm, still, "iiwa_link_7", seed=3)
    for _ in range(20):
        report = still.tick(monitor)
        assert not report.collision
        assert report.contacts == report.links == ()
    reports = [still.tick(monitor, tau_ext) for _ in range(60)]
    assert [report.onset for report in reports[:4]].count(True) == 1
    assert not any(report.onset for report in reports[4:])
    assert reports[3].collision
    assert reports[-1].links == ("iiwa_link_7",)
    (contact,) = reports[-1].contacts
    assert contact.located
    np.testing.assert_allclose(contact.point, point, atol=1e-9)
    np.testing.assert_allclose(contact.force, force, rtol=1e-9)
    np.testing.assert_allclose(reports[-1].external_torque, tau_ext, atol=1e-9)
    # The location is right while the force still rises behind the observer's low-pass.
    np.testing.assert_allclose(reports[2].contacts[0].point, point, atol=1e-9)
    assert reports[-1].time == pytest.approx(79 * DT)
    after = [still.tick(monitor) for _ in range(60)]
    assert after[0].collision
    assert not after[-1].collision
    assert after[-1].contacts == ()


def test_hold_time_bridges_chatter(arm: cs.Robot) -> None:
    still = Still(arm)
    monitor = cs.ContactMonitor(arm, dt=DT, observer_gain=5000.0, torque_threshold=0.5, hold_time=0.005)
    onsets = 0
    still.tick(monitor)
    for k in range(100):
        onsets += still.tick(monitor, 2.0 if k % 3 == 0 else 0.0).onset
    assert onsets == 1


def test_threshold_per_joint(arm: cs.Robot) -> None:
    still = Still(arm)
    threshold = np.array([0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 5.0])
    monitor = cs.ContactMonitor(arm, dt=DT, observer_gain=500.0, torque_threshold=threshold)
    still.tick(monitor)
    for _ in range(50):
        report = still.tick(monitor, np.full(7, 1.0))
    assert report.links == ("iiwa_link_6",)


def test_region_on_every_branch() -> None:
    robot = cs.Robot.named("atlas")
    monitor = cs.ContactMonitor(robot, dt=DT, observer_gain=500.0, torque_threshold=0.5)
    q, zero = robot.neutral(), np.zeros(robot.nv)
    # At its limit a joint's torque would be that of a stop: knees and elbows are a little bent.
    low, high = robot.position_limits[7:].T
    q[7:] = np.clip(q[7:], low + 0.1, high - 0.1)
    weight = robot.inverse_dynamics(q, zero, zero)
    tau_ext = np.zeros(robot.nv)
    for name in ("l_arm_ely", "r_leg_kny"):
        tau_ext[6 + robot.joint_names[1:].index(name)] = 5.0
    # The force that holds the base is felt at the base, before both limbs.
    for _ in range(50):
        report = monitor.update(q, zero, (weight - tau_ext)[6:])
    assert set(report.links) == {"l_uarm", "r_lleg"}


def test_bias_is_tracked_and_frozen_in_contact(arm: cs.Robot) -> None:
    still = Still(arm)
    bias = np.array([1.0, -2.0, 0.8, 0.6, -0.7, 0.3, 0.2])
    _, _, tau_ext = touch(arm, still, "iiwa_link_6", seed=1)
    monitor = cs.ContactMonitor(arm, dt=DT, observer_gain=200.0, torque_threshold=0.1, bias_time_constant=0.3)
    assert not any(still.tick(monitor, bias).collision for _ in range(3000))
    for _ in range(1000):
        report = still.tick(monitor, bias + tau_ext)
    assert report.collision
    np.testing.assert_allclose(report.external_torque, tau_ext, atol=0.02)
    for _ in range(500):
        report = still.tick(monitor, bias)
    assert not report.collision
    # A slow drift is followed.
    assert not any(still.tick(monitor, bias * (1 + 1e-4 * k)).collision for k in range(3000))


def test_without_tracking_nothing_is_subtracted(arm: cs.Robot) -> None:
    still = Still(arm)
    monitor = cs.ContactMonitor(arm, dt=DT, observer_gain=500.0, torque_threshold=10.0)
    for _ in range(100):
        report = still.tick(monitor, 1.0)
    np.testing.assert_allclose(report.external_torque, 1.0, rtol=1e-9)


def test_reset_starts_anew(arm: cs.Robot) -> None:
    still = Still(arm)
    monitor = cs.ContactMonitor(arm, dt=DT, observer_gain=500.0, torque_threshold=0.1)
    first = [still.tick(monitor, 1.0).external_torque for _ in range(30)]
    monitor.reset()
    second = [still.tick(monitor, 1.0).external_torque for _ in range(30)]
    np.testing.assert_array_equal(first, second)


def test_reports_keep_their_values(arm: cs.Robot) -> None:
    still = Still(arm)
    monitor = cs.ContactMonitor(arm, dt=DT, observer_gain=500.0, torque_threshold=0.1)
    still.tick(monitor)
    early = still.tick(monitor, 1.0)
    before = early.external_torque
    for _ in range(20):
        still.tick(monitor, 5.0)
    np.testing.assert_array_equal(early.external_torque, before)
    with pytest.raises(ValueError, match="read-only"):
        early.external_torque[:] = 7.0


@pytest.mark.parametrize("position", range(3))
@pytest.mark.parametrize(
    "bad",
    [np.full(7, np.nan), np.array([0, 0, np.inf, 0, 0, 0, 0.0]), np.zeros(6), np.zeros((7, 1)), "x", None],
)
def test_bad_input_is_named_and_is_a_missed_sample(arm: cs.Robot, position: int, bad: object) -> None:
    still = Still(arm)
    monitors = [
        cs.ContactMonitor(arm, dt=DT, observer_gain=500.0, torque_threshold=0.1, bias_time_constant=0.005)
        for _ in range(2)
    ]
    for k in range(20):
        tau_ext = 1.0 if k > 10 else 0.1
        # A refused sample changes nothing but the time since the last one; before the first there is no time.
        clean = still.tick(monitors[0], tau_ext, dt=2 * DT if k > 0 else None)
        arguments: list[object] = [still.q, still.v, still.weight]
        arguments[position] = bad
        with pytest.raises(cs.InputError, match=("q", "v", "tau")[position]):
            monitors[1].update(*arguments)
        disturbed = still.tick(monitors[1], tau_ext)
        np.testing.assert_array_equal(clean.external_torque, disturbed.external_torque)
        assert clean.time == pytest.approx(disturbed.time, abs=1e-12)
        assert (clean.collision, clean.onset) == (disturbed.collision, disturbed.onset)


@pytest.mark.parametrize(
    ("options", "name"),
    [
        ({"dt": -1.0}, "dt"),
        ({"dt": DT, "observer_gain": 0.0}, "gain"),
        ({"dt": DT, "torque_threshold": -1.0}, "torque_threshold"),
        ({"dt": DT, "bias_time_constant": 0.0}, "bias_time_constant"),
        ({"dt": DT, "bias_limit": 0.0}, "bias_limit"),
        ({"dt": DT, "bias_limit": np.nan}, "bias_limit"),
        ({"dt": DT, "bias_settle_time": 0.0}, "bias_settle_time"),
        ({"dt": DT, "hysteresis": 1.0}, "hysteresis"),
        ({"dt": DT, "hysteresis": -0.1}, "hysteresis"),
        ({"dt": DT, "hysteresis": np.zeros(6)}, "hysteresis"),
        ({"dt": DT, "hold_time": -0.1}, "hold_time"),
        ({"dt": DT, "hold_time": np.nan}, "hold_time"),
        ({"dt": DT, "max_contacts": 0}, "max_contacts"),
        ({"dt": 10**400}, "dt"),
        ({"dt": "fast"}, "dt"),
        ({"dt": DT, "hold_time": "long"}, "hold_time"),
    ],
)
def test_bad_settings_are_named(arm: cs.Robot, options: dict[str, object], name: str) -> None:
    with pytest.raises(cs.InputError, match=name):
        cs.ContactMonitor(arm, **options)

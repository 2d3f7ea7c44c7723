"""Thresholds and gains can be read and changed while an object runs; wrong ones change nothing."""

import types

import numpy as np
import pytest

import contactsense as cs

DT = 1e-3
Q, ZEROS = np.array([0.3, 0.8, -0.4, 0.9, 0.5, 0.7, 0.0]), np.zeros(7)


@pytest.fixture(scope="module")
def robot():
    return cs.Robot.named("iiwa14")


@pytest.fixture
def torque(robot):
    return robot.inverse_dynamics(Q, ZEROS, ZEROS)


def test_a_gain_goes_on_from_the_external_torque(robot, torque):
    observer = cs.MomentumObserver(robot, dt=DT, gain=50.0)
    for _ in range(10):
        before = observer.update(Q, ZEROS, torque - 3.0)
    observer.gain = 200.0
    assert np.array_equal(observer.external_torque, before)
    after = observer.update(Q, ZEROS, torque - 3.0)
    assert np.allclose(after, 3.0 + np.exp(-200.0 * DT) * (before - 3.0), atol=1e-9)
    assert (observer.robot, observer.dt) == (robot, DT)
    assert np.array_equal(observer.gain, np.full(7, 200.0))


def learnt(robot, torque, **options):
    """A monitor that has learnt a bias of 1 Nm."""
    monitor = cs.ContactMonitor(robot, dt=DT, bias_time_constant=0.1, torque_threshold=2.0, **options)
    for _ in range(200):
        monitor.update(Q, ZEROS, torque - 1.0)
    assert np.allclose(monitor.bias, 1.0, atol=0.1)
    return monitor


def test_a_threshold_keeps_bias_and_observer(robot, torque):
    monitor, other = learnt(robot, torque), learnt(robot, torque)
    bias = monitor.bias
    monitor.torque_threshold = 0.5
    assert np.array_equal(monitor.torque_threshold, np.full(7, 0.5))
    assert np.array_equal(monitor.bias, bias)
    for _ in range(200):
        low, high = (it.update(Q, ZEROS, torque - 2.2) for it in (monitor, other))
    assert low.collision
    assert not high.collision
    bias = monitor.bias
    monitor.observer_gain = 10.0
    assert np.array_equal(monitor.bias, bias)
    report = monitor.update(Q, ZEROS, torque - 2.2)
    assert np.allclose(report.external_torque, low.external_torque, atol=0.05)


@pytest.mark.parametrize(
    ("name", "wrong"),
    [
        ("torque_threshold", -1.0),
        ("torque_threshold", [1.0, 2.0]),
        ("torque_threshold", "much"),
        ("wrench_threshold", 0.0),
        ("wrench_threshold", np.ones((2, 6))),
        ("observer_gain", 0.0),
        ("observer_gain", np.nan),
        ("wrench_gain", -1.0),
    ],
)
def test_wrong_values_change_nothing(robot, torque, name, wrong):
    sensors = [cs.ForceTorqueSensor("wrist", robot.link_names[-1])]
    monitor = cs.ContactMonitor(robot, dt=DT, sensors=sensors)
    monitor.update(Q, ZEROS, torque, np.zeros((1, 6)))
    readable = ("torque_threshold", "wrench_threshold", "observer_gain", "wrench_gain", "bias", "dt")
    before = [getattr(monitor, attribute) for attribute in readable]
    with pytest.raises(cs.InputError, match=name):
        setattr(monitor, name, wrong)
    after = [getattr(monitor, attribute) for attribute in readable]
    assert all(np.array_equal(a, b) for a, b in zip(after, before, strict=True))


def test_gains_of_wrenches_follow_unless_given(robot):
    sensors = [cs.ForceTorqueSensor("wrist", robot.link_names[-1])]
    monitor = cs.ContactMonitor(robot, dt=DT, sensors=sensors)
    monitor.observer_gain = 80.0
    assert monitor.wrench_gain == 80.0
    monitor.wrench_gain = 20.0
    monitor.observer_gain = 90.0
    assert monitor.wrench_gain == 20.0
    monitor.wrench_gain = None
    assert monitor.wrench_gain == 90.0
    monitor.wrench_threshold = [1, 2, 3, 4, 5, 6]
    assert np.array_equal(monitor.wrench_threshold, [[1, 2, 3, 4, 5, 6]])
    assert monitor.sensors == tuple(sensors)
    assert cs.ContactMonitor(robot, dt=DT).wrench_gain is None


def test_a_filter_is_made_again_from_its_options(robot):
    options = {
        "particles": 300,
        "seed": 5,
        "noise": cs.NoiseModel(torque=0.1),
        "schedule": types.MappingProxyType({"sharpness": (1.0, 20.0), "updates": 10}),
        "measurement": "friction_cone",
        "friction": 0.3,
    }
    first = cs.ContactParticleFilter(robot, **options)
    again = cs.ContactParticleFilter(first.robot, **first.options)
    assert again.options == first.options
    tau_ext = [1.0, 2.0, 0.5, 1.0, 0.1, 0.2, 0.0]
    assert np.array_equal(first.update(Q, tau_ext).point, again.update(Q, tau_ext).point)


def test_every_class_says_what_it_is(robot):
    sensors = [cs.ForceTorqueSensor("wrist", robot.link_names[-1])]
    for obj, text in (
        (cs.MomentumObserver(robot, dt=DT), "dt=0.001"),
        (cs.LoadCompensator(robot, sensors), "1 sensors"),
        (cs.ContactIsolator(robot, sensors=sensors), "1 sensors"),
        (cs.ContactMonitor(robot, dt=DT), "dt=0.001"),
        (cs.ContactParticleFilter(robot, particles=50), "particles=50"),
        (robot.surface(robot.link_names[0]), robot.link_names[0]),
        (robot.surface(robot.link_names[0]).sample(3), "3 rows"),
    ):
        assert repr(obj).startswith(type(obj).__name__ + "(")
        assert text in repr(obj)

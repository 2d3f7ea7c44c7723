"""The monitor's clock: lost samples, refused samples, jitter, with and without force/torque sensors."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

import contactsense as cs

DT = 1e-3
SENSOR = cs.ForceTorqueSensor("wrist", "iiwa_link_6")


@pytest.fixture(scope="module")
def arm() -> cs.Robot:
    return cs.Robot.named("iiwa14")


class Motion:
    """Fast free motion, sines of 0.5 to 1.1 Hz with velocities up to 1.9 rad/s, and its measurements."""

    def __init__(self, robot: cs.Robot, *, sensed: bool = False) -> None:
        self.robot = robot
        self.omega = 2 * np.pi * np.array([0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.1])
        self.phase = np.arange(7.0)
        self.compensator = cs.LoadCompensator(robot, [SENSOR]) if sensed else None

    def sample(self, time: float, tau_ext: object = 0.0) -> tuple[np.ndarray, ...]:
        angle = self.omega * time + self.phase
        q = 1.9 / self.omega * np.sin(angle)
        v = 1.9 * np.cos(angle)
        a = -1.9 * self.omega * np.sin(angle)
        tau = self.robot.inverse_dynamics(q, v, a) - tau_ext
        if self.compensator is None:
            return q, v, tau
        # What an untouched sensor reads: the wrench that a reading of zero would have to be corrected by.
        missing = self.compensator.update(q, v, a, np.zeros((1, 6)))[0]
        turn = self.robot.link_pose(q, SENSOR.link)[:3, :3].T
        return q, v, tau, -np.r_[turn @ missing[:3], turn @ missing[3:]][None]


def monitor_of(robot: cs.Robot, motion: Motion, **options: object) -> cs.ContactMonitor:
    sensors = [] if motion.compensator is None else [SENSOR]
    options = {"observer_gain": 100.0, "torque_threshold": 0.5} | options
    return cs.ContactMonitor(robot, dt=DT, sensors=sensors, **options)


def times_with_dropouts() -> Iterator[float]:
    """1 kHz for 2 s, but four times nothing for 20 ms."""
    lost = (0.300, 0.705, 1.111, 1.602)
    for tick in range(2000):
        if not any(start < tick * DT < start + 0.0195 for start in lost):
            yield tick * DT


def onsets(monitor: cs.ContactMonitor, motion: Motion, times: list[float], *, measured: bool) -> int:
    count = 0
    for before, time in zip([0.0, *times], times, strict=False):
        dt = time - before if measured and time > before else None
        count += monitor.update(*motion.sample(time), dt=dt).onset
    return count


@pytest.mark.parametrize("sensed", [False, True])
@pytest.mark.parametrize("gain", [100.0, 500.0])
def test_dropouts_raise_no_alarm(arm: cs.Robot, sensed: bool, gain: float) -> None:
    motion = Motion(arm, sensed=sensed)
    times = list(times_with_dropouts())
    monitor = monitor_of(arm, motion, observer_gain=gain)
    assert onsets(monitor, motion, times, measured=True) == 0
    # Without the time that has passed they do.
    monitor = monitor_of(arm, motion, observer_gain=gain)
    assert onsets(monitor, motion, times, measured=False) >= 4


@pytest.mark.parametrize("sensed", [False, True])
def test_jitter_raises_no_alarm(arm: cs.Robot, sensed: bool) -> None:
    motion = Motion(arm, sensed=sensed)
    times = np.cumsum(np.random.default_rng(0).uniform(0.5e-3, 20e-3, 300))
    monitor = monitor_of(arm, motion, bias_time_constant=0.2)
    assert onsets(monitor, motion, list(times), measured=True) == 0
    report = monitor.update(*motion.sample(times[-1] + DT))
    assert report.time == pytest.approx(times[-1] - times[0] + DT, abs=1e-9)
    assert np.abs(report.external_torque).max() < 0.3
    if sensed:
        assert np.abs(report.wrenches).max() < 0.5


@pytest.mark.parametrize("sensed", [False, True])
@pytest.mark.parametrize("refused", [1, 5, 30])
@pytest.mark.parametrize("bad", ["q", "v", "tau", "text", "dt", "friction"])
def test_a_refused_sample_is_a_missed_one(arm: cs.Robot, sensed: bool, refused: int, bad: str) -> None:
    motion = Motion(arm, sensed=sensed)
    monitor = monitor_of(arm, motion)
    for tick in range(400):
        sample = list(motion.sample(tick * DT))
        if not 200 <= tick < 200 + refused:
            assert not monitor.update(*sample).onset, tick
            continue
        options: dict[str, object] = {}
        if bad in ("dt", "friction"):
            options[bad] = {"dt": -1.0, "friction": np.full(7, np.nan)}[bad]
        else:
            sample[("q", "v", "tau").index(bad) if bad != "text" else 2] = np.full(7, np.nan)
        if bad == "text":
            sample[2] = "x"
        with pytest.raises(cs.InputError):
            monitor.update(*sample, **options)
    assert monitor.update(*motion.sample(0.4)).time == pytest.approx(0.4, abs=1e-12)


def test_a_long_gap_raises_no_alarm_and_ends_no_contact(arm: cs.Robot) -> None:
    motion = Motion(arm)
    push = np.array([0.0, 8.0, 0.0, 5.0, 0.0, 0.0, 0.0])
    for tau_ext in (0.0, push):
        monitor = monitor_of(arm, motion, bias_time_constant=0.2)
        for tick in range(500):
            before = monitor.update(*motion.sample(tick * DT, tau_ext if tick > 300 else 0.0))
        touched = tau_ext is push
        assert before.collision == touched
        # 0.7 s without a sample, told or refused.
        report = monitor.update(*motion.sample(0.499 + 0.7, tau_ext), dt=0.7)
        assert (report.collision, report.onset) == (touched, False)
        np.testing.assert_allclose(report.external_torque, before.external_torque, atol=1e-12)
        for _ in range(300):
            with pytest.raises(cs.InputError, match="tau"):
                monitor.update(*motion.sample(0.0)[:2], np.full(7, np.nan))
        for tick in range(200):
            report = monitor.update(*motion.sample(1.5 + tick * DT, tau_ext))
            assert (report.collision, report.onset) == (touched, False)
        np.testing.assert_allclose(report.external_torque, tau_ext, atol=0.1)
        # Released unseen: the alarm goes off once it is known.
        report = monitor.update(*motion.sample(2.5), dt=0.8)
        assert report.collision == touched
        for tick in range(1, 200):
            report = monitor.update(*motion.sample(2.5 + tick * DT))
        assert not report.collision


def test_hold_and_bias_follow_the_measured_time(arm: cs.Robot) -> None:
    q, v = np.array([0.3, 0.6, -0.4, -1.2, 0.5, 0.9, 0.2]), np.zeros(7)
    weight, slow = arm.inverse_dynamics(q, v, v), 10 * DT
    # Told that ten times as long passes, one tick does what ten did.
    fast_monitor, slow_monitor = (
        cs.ContactMonitor(arm, dt=DT, observer_gain=1e4, bias_time_constant=0.3, hold_time=0.05) for _ in "ab"
    )
    rows = []
    for tick in range(0, 1500, 10):
        tau = weight - (5.0 if 700 <= tick < 900 else 0.2)
        for _ in range(10):
            fast = fast_monitor.update(q, v, tau)
        report = slow_monitor.update(q, v, tau, dt=slow)
        rows.append((fast.collision, report.collision))
        np.testing.assert_allclose(slow_monitor.bias, fast_monitor.bias, atol=0.01)
    fast_rows, slow_rows = np.array(rows).T
    assert abs(int(fast_rows.sum()) - int(slow_rows.sum())) <= 1
    assert 20 <= slow_rows.sum() <= 27


@pytest.mark.parametrize("dt", [0.0, -1e-3, np.nan, np.inf, 1e-12, 1e12])
def test_a_bad_step_is_named(arm: cs.Robot, dt: float) -> None:
    motion = Motion(arm)
    monitor = monitor_of(arm, motion)
    with pytest.raises(cs.InputError, match="dt: must lie between"):
        monitor.update(*motion.sample(0.0), dt=dt)


def test_what_a_monitor_was_made_of(arm: cs.Robot) -> None:
    monitor = cs.ContactMonitor(arm, dt=DT)
    assert monitor.robot is arm
    assert monitor.dt == DT
    np.testing.assert_array_equal(monitor.bias, np.zeros(7))


@pytest.fixture(scope="module")
def recorded(arm: cs.Robot) -> tuple[cs.Calibration, list[Any]]:
    """A calibration of an arm with errors, and logs of 60 s each without contact at 1 kHz."""
    pytest.importorskip("mujoco", reason="the simulation needs MuJoCo: pip install contactsense[sim]")
    from contactsense import sim

    errors = sim.ImperfectArm.typical(arm, 3)
    plan = cs.exciting_motion(arm, 60.0, dt=DT, seed=7)
    log = sim.record_imperfect(arm, errors, sim.JointMotion(plan.time, plan.q, plan.v, plan.a), seed=7).log
    free = [sim.PersonScene(seconds=60.0, contacts=0, seed=seed).record(arm, errors).log for seed in (1, 2)]
    return cs.calibrate(arm, log), [*free]


def jittered_rows(time: np.ndarray, seed: int) -> np.ndarray:
    """Rows that are 0.5 to 20 ms apart, and now and then a dropped tick more."""
    rng = np.random.default_rng(seed)
    count = int(len(time) * DT / 0.5e-3)
    steps = rng.uniform(0.5e-3, 20e-3, count) + (rng.random(count) < 0.02) * rng.uniform(0.5e-3, 20e-3, count)
    times = time[0] + np.cumsum(steps)
    rows: np.ndarray = np.unique(np.searchsorted(time, times[times < time[-1]], side="right") - 1)
    return rows


@pytest.mark.parametrize("nominal", [1e-3, 10e-3])
def test_unequal_steps_of_an_arm_with_errors_raise_no_alarm(
    arm: cs.Robot, recorded: tuple[cs.Calibration, list[Any]], nominal: float
) -> None:
    calibration, logs = recorded
    for seed, log in enumerate(logs):
        monitor = cs.ContactMonitor(arm, dt=nominal, calibration=calibration)
        rows = jittered_rows(log.time, seed)
        onsets = []
        for row, step in zip(rows, np.diff(log.time[rows], prepend=log.time[rows[0]] - DT), strict=True):
            if monitor.update(log.q[row], log.v[row], log.tau[row], dt=step).onset:
                onsets.append(log.time[row])
        assert onsets == []

"""Sensors' wrenches of a standing humanoid: of one age with the external torque, free of other contacts."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import pytest

pytest.importorskip("mujoco", reason="the simulation needs MuJoCo: pip install contactsense[sim]")

import contactsense as cs
from contactsense.sim import FLOOR_TYPE, Floor, Push, SimulatedRobot, named_geoms
from contactsense.sim.atlas import FEET, SENSORS, controller, posture

DT, GAIN = 1e-3, 500.0
NAMES = [sensor.name for sensor in SENSORS]
PUSHES = {
    "chest": Push("utorso", np.array([0.25, 0.05, 0.46]), np.array([-1.0, 0.2, 0.1]), 90.0, 0.05, 0.15),
    "hand": Push("l_hand", np.array([0.0, -0.115, 0.0]), np.array([0.2, 1.0, -0.3]), 70.0, 0.05, 0.1),
    "shin": Push("r_lleg", np.array([0.085, 0.0, -0.2]), np.array([-1.0, 0.1, 0.0]), 80.0, 0.05, 0.15),
}
BEHIND = {"chest": {"utorso"}, "hand": {"utorso", "l_clav", "l_hand"}, "shin": {"r_uglut"}}


@dataclass
class Run:
    collision: np.ndarray  # (n, nv) collision torque
    true_torque: np.ndarray  # (n, nv) of the push
    wrenches: np.ndarray  # (n, sensors, 6)
    true_force: np.ndarray  # (n, 3) of the push
    arms: np.ndarray  # (n, sensors, 3) from the sensors to the push


@lru_cache
def run(name: str, *, watched_from: int = 100) -> Run:
    """A push on Atlas, which stands; monitored for 100 ms or less before it begins at 50 ms."""
    push, robot = PUSHES[name], cs.Robot.named("atlas")
    model = robot.model
    q = posture(model, 7)
    control = controller(model, q)
    geoms = named_geoms("atlas", conaffinity=FLOOR_TYPE)
    atlas = SimulatedRobot(model, dt=DT, geoms=geoms, floor=Floor(), sensors=SENSORS)
    monitor = cs.ContactMonitor(robot, dt=DT, sensors=SENSORS, wanted_contacts=FEET, observer_gain=GAIN)
    atlas.reset(q)
    rows = []
    for tick in range(-1000, 250):
        atlas.clear_forces()
        point, force = push.force_at((tick + 0.5) * DT, atlas.link_pose(push.link))
        if force.any():
            atlas.apply_force(push.link, point, force)
        sample = atlas.step(control.torque(atlas.q, atlas.v))
        if tick < -watched_from:
            continue
        report = monitor.update(sample.q, sample.v, sample.tau_mean, sample.wrenches)
        point, force = push.force_at(tick * DT, robot.link_pose(sample.q, push.link))
        torque = robot.jacobian(sample.q, push.link, point)[:3].T @ force
        arms = np.array([point - robot.link_pose(sample.q, sensor.link)[:3, 3] for sensor in SENSORS])
        rows.append((report.collision_torque, torque, report.wrenches, force, arms))
    return Run(*(np.array(column) for column in zip(*rows, strict=True)))


def low_pass(signal: np.ndarray) -> np.ndarray:
    """The observer's, for a signal (n, ...)."""
    decay, passed = np.exp(-GAIN * DT), np.zeros_like(signal)
    for k in range(1, len(signal)):
        mean = 0.5 * (signal[k] + signal[k - 1])
        passed[k] = mean + decay * (passed[k - 1] - mean)
    return passed


def of_tick(signal: np.ndarray) -> np.ndarray:
    """The mean of each tick, for a signal (n, ...); a gain of half the tick rate leaves no low-pass."""
    return 0.5 * (signal + np.concatenate([signal[:1], signal[:-1]]))


@pytest.mark.parametrize("name", PUSHES)
def test_the_collision_torque_is_that_of_the_push_alone(name: str) -> None:
    result = run(name)
    error = np.abs(result.collision - low_pass(result.true_torque))
    # Joints behind the feet's sensors, and at them, say nothing.
    error[:, [29, 35]] = 0.0
    assert np.abs(result.true_torque).max() > 40.0
    # The ground gives and takes 100 N and more meanwhile; of different age, tens of N would stay.
    assert error.max() < 0.4


@pytest.mark.parametrize("name", PUSHES)
def test_a_sensor_sees_what_is_behind_it_and_nothing_else(name: str) -> None:
    result = run(name)
    moment = np.cross(result.arms, result.true_force[:, None])
    for index, sensor in enumerate(NAMES):
        if sensor in FEET or "glut" in sensor:
            continue
        seen = result.wrenches[:, index]
        if sensor in BEHIND[name]:
            np.testing.assert_allclose(seen[:, :3], of_tick(result.true_force), atol=0.3)
            np.testing.assert_allclose(seen[:, 3:], of_tick(moment[:, index]), atol=0.15)
        else:
            assert np.abs(seen).max() < 0.15
    # The leg's sensor sees the ground on the foot, too, which the foot's own takes out.
    for side in ("l", "r"):
        leg, foot = (result.wrenches[:, NAMES.index(f"{side}_{link}"), :3] for link in ("uglut", "foot"))
        force = of_tick(result.true_force) * float(f"{side}_uglut" in BEHIND[name])
        np.testing.assert_allclose(leg - foot, force, atol=0.5)


def test_it_starts_without_a_false_contact() -> None:
    # From the first tick on, 1700 N act on the feet that neither the observer nor the sensors knew before.
    start = run("chest", watched_from=100).collision[:140]
    assert np.abs(start).max() < 0.01


@pytest.mark.parametrize("gain", [50.0, 200.0])
@pytest.mark.parametrize("silent", [(0, 1), (0, 4), (0, 40), (30, 80)])
def test_a_wanted_sensor_that_comes_back_raises_no_alarm(gain: float, silent: tuple[int, int]) -> None:
    """1700 N stand on sensors that say nothing at first, or for a while."""
    robot = cs.Robot.named("atlas")
    model = robot.model
    q = posture(model, 7)
    control = controller(model, q)
    geoms = named_geoms("atlas", conaffinity=FLOOR_TYPE)
    atlas = SimulatedRobot(model, dt=DT, geoms=geoms, floor=Floor(), sensors=SENSORS)
    monitor = cs.ContactMonitor(
        robot, dt=DT, sensors=SENSORS, wanted_contacts=FEET, observer_gain=gain, torque_threshold=0.5
    )
    atlas.reset(q)
    for _ in range(1000):
        atlas.step(control.torque(atlas.q, atlas.v))
    feet = [NAMES.index(name) for name in FEET]
    left_out = []
    for tick in range(500):
        sample = atlas.step(control.torque(atlas.q, atlas.v))
        readings = sample.wrenches.copy()
        if silent[0] <= tick < silent[1]:
            readings[feet] = np.nan
        report = monitor.update(sample.q, sample.v, sample.tau_mean, readings)
        assert not report.collision, tick
        left_out.append(len(report.joints_left_out))
    # Then the legs are watched again.
    assert max(left_out) > left_out[-1]

"""Offsets of force/torque sensors: given, calibrated, and found by taring."""

from __future__ import annotations

import json

import numpy as np
import pytest
from robots import ATLAS, BY_NAME, RobotFile, parameters
from sensor_models import SensedModel, moving_and_fixed_links

import contactsense as cs
from contactsense.sim import SimulatedRobot

FILES = parameters([BY_NAME["panda"], BY_NAME["talos"], ATLAS[1]])


def with_offsets(sensors: list[cs.ForceTorqueSensor], offsets: np.ndarray) -> list[cs.ForceTorqueSensor]:
    return [
        cs.ForceTorqueSensor(s.name, s.link, pose=s.pose, convention=s.convention, offset=offset)
        for s, offset in zip(sensors, offsets, strict=True)
    ]


def sensed(file: RobotFile, seed: int) -> SensedModel:
    moving, fixed = moving_and_fixed_links(file.require())
    rng = np.random.default_rng(seed)
    links = [str(link) for link in [*rng.permutation(moving)[:3], *rng.permutation(fixed)[:1]]]
    return SensedModel(file, links, seed=seed, conventions="mixed")


def at_rest(model: SensedModel):
    motion = model.motion()
    motion.v[:] = motion.a[:] = 0.0
    return motion


def calibration_with(robot: cs.Robot, offsets: dict[str, list[float]], mass: float = 0.0) -> cs.Calibration:
    content = json.loads(cs.Calibration.of_description(robot)._content())
    content["sensor_offsets"] = list(offsets.items())
    content["bodies"][-1]["mass"] += mass
    return cs.Calibration(json.dumps(content))


@pytest.mark.parametrize("file", FILES)
def test_offsets_are_subtracted_as_read(file: RobotFile) -> None:
    """In the sensor's own frame and convention, whichever these are, and in motion."""
    model = sensed(file, 3)
    offsets = np.random.default_rng(1).uniform(-20, 20, (4, 6))
    compensator = cs.LoadCompensator(model.robot, with_offsets(model.sensors, offsets))
    np.testing.assert_array_equal(compensator.offsets, offsets)
    for _ in range(3):
        motion = model.motion(2.0)
        readings, expected = model.evaluate(motion, 20.0)
        external = compensator.update(motion.q, motion.v, motion.a, readings + offsets)
        np.testing.assert_allclose(external, expected, atol=1e-9 * max(1.0, np.abs(readings).max()))


def test_the_monitor_subtracts_offsets() -> None:
    robot = cs.Robot.named("iiwa14")
    sensors = [
        cs.ForceTorqueSensor("elbow", "iiwa_link_4", convention="support"),
        cs.ForceTorqueSensor("wrist", "iiwa_link_7"),
    ]
    offsets = np.array([[1.0, -2.0, 30.0, 0.1, 0.2, -0.3], [5.0, 0.0, -8.0, 0.0, 0.5, 0.0]])
    calibration = calibration_with(robot, {"wrist": [*offsets[1]], "other": [9.0] * 6})
    elbow_alone = with_offsets(sensors, offsets * [[1], [0]])
    monitors = {
        "none": (cs.ContactMonitor(robot, dt=1e-3, sensors=sensors), 0.0),
        "given": (cs.ContactMonitor(robot, dt=1e-3, sensors=with_offsets(sensors, offsets)), offsets),
        "calibrated": (
            cs.ContactMonitor(robot, dt=1e-3, sensors=elbow_alone, calibration=calibration),
            offsets,
        ),
    }
    q, still = np.full(7, 0.4), np.zeros(7)
    tau = robot.inverse_dynamics(q, still, still)
    wrenches = {}
    for name, (monitor, added) in monitors.items():
        for _ in range(50):
            report = monitor.update(q, still, tau, np.full((2, 6), 3.0) + added)
        wrenches[name] = report.wrenches
    np.testing.assert_allclose(wrenches["given"], wrenches["none"], atol=1e-9)
    np.testing.assert_allclose(wrenches["calibrated"], wrenches["none"], atol=1e-6)


def test_a_simulated_sensor_reads_its_offset() -> None:
    robot = cs.Robot.named("iiwa14")
    sensor = cs.ForceTorqueSensor("wrist", "iiwa_link_7", convention="support")
    offset = [4.0, -3.0, 2.0, 0.1, 0.2, 0.3]
    (tared,) = with_offsets([sensor], [offset])
    readings = []
    for sensors in ([sensor], [tared]):
        arm = SimulatedRobot(robot.model, sensors=sensors)
        arm.reset(np.zeros(7))
        readings.append(arm.step(np.zeros(7)).wrenches)
    np.testing.assert_allclose(readings[1] - readings[0], [offset], atol=1e-12)


@pytest.mark.parametrize(
    "offset", [np.zeros(5), np.full(6, np.nan), [0, 0, np.inf, 0, 0, 0], "x", np.zeros((1, 6)), 3.0]
)
def test_bad_offsets_are_named(offset: object) -> None:
    with pytest.raises(cs.InputError, match="offset"):
        cs.ForceTorqueSensor("wrist", "hand", offset=offset)


def test_the_offset_is_part_of_the_value() -> None:
    plain, shifted = (cs.ForceTorqueSensor("wrist", "hand", offset=x) for x in (None, [0, 0, 1.5, 0, 0, 0]))
    assert plain == cs.ForceTorqueSensor("wrist", "hand", offset=np.zeros(6))
    assert plain != shifted
    assert repr(shifted).endswith("offset=[0.0, 0.0, 1.5, 0.0, 0.0, 0.0])")
    assert eval(repr(shifted), {"ForceTorqueSensor": cs.ForceTorqueSensor}) == shifted
    with pytest.raises(ValueError, match="read-only"):
        shifted.offset[2] = 0.0


@pytest.mark.parametrize("file", FILES)
def test_taring_at_one_pose_zeroes_all(file: RobotFile) -> None:
    model = sensed(file, 5)
    rng = np.random.default_rng(2)
    offsets = rng.uniform(-20, 20, (4, 6))
    compensator = cs.LoadCompensator(model.robot, model.sensors)
    here = at_rest(model)
    readings = model.evaluate(here)[0] + offsets
    scale = max(1.0, np.abs(readings).max())
    for rows in (readings, [readings - 0.5, readings + 0.5], readings[None]):
        compensator.offsets = np.zeros((4, 6))
        np.testing.assert_allclose(compensator.tare(here.q, rows), offsets, atol=1e-10 * scale)
    for _ in range(5):
        there = at_rest(model)
        readings = model.evaluate(there)[0] + offsets
        assert np.abs(compensator.update(there.q, there.v, there.a, readings)).max() < 1e-9 * scale
    # What a monitor gets from it.
    assert [s.name for s in compensator.sensors] == [s.name for s in model.sensors]
    np.testing.assert_array_equal([s.offset for s in compensator.sensors], compensator.offsets)


def test_a_sensor_without_readings_keeps_its_offset() -> None:
    model = sensed(BY_NAME["panda"], 7)
    compensator = cs.LoadCompensator(model.robot, model.sensors)
    compensator.offsets = known = np.arange(24.0).reshape(4, 6)
    here = at_rest(model)
    readings = model.evaluate(here)[0]
    rows = np.stack([readings, readings + 1.0, np.full((4, 6), np.nan)])
    rows[:, 2] = np.nan
    rows[1, 0, 3] = np.nan
    compensator.tare(here.q, rows)
    np.testing.assert_array_equal(compensator.offsets[2], known[2])
    np.testing.assert_allclose(compensator.offsets[[0, 1, 3]], [[0.0] * 6, [0.5] * 6, [0.5] * 6], atol=1e-9)


def test_bad_input_leaves_the_offsets() -> None:
    robot = cs.Robot.named("iiwa14")
    sensors = [cs.ForceTorqueSensor("a", "iiwa_link_3"), cs.ForceTorqueSensor("b", "iiwa_link_7")]
    compensator = cs.LoadCompensator(robot, sensors)
    compensator.offsets = before = np.arange(12.0).reshape(2, 6)
    infinite = np.zeros((2, 6))
    infinite[1, 2] = np.inf
    wrong = [np.zeros((1, 6)), np.zeros((0, 2, 6)), np.zeros((3, 1, 6)), np.zeros(6), infinite, None, "x"]
    for wrenches in [*wrong, [infinite, infinite]]:
        with pytest.raises(cs.InputError, match="wrenches"):
            compensator.tare(np.zeros(7), wrenches)
    with pytest.raises(cs.InputError, match="q"):
        compensator.tare(np.full(7, np.nan), np.zeros((2, 6)))
    for offsets in (np.zeros((1, 6)), infinite, np.full((2, 6), np.nan), np.zeros((2, 5)), None):
        with pytest.raises(cs.InputError, match="offsets"):
            compensator.offsets = offsets
    np.testing.assert_array_equal(compensator.offsets, before)
    none = cs.LoadCompensator(robot, [])
    assert none.tare(np.zeros(7), np.zeros((0, 6))).shape == (0, 6)


def test_a_calibration_corrects_inertias_and_offsets() -> None:
    robot = cs.Robot.named("iiwa14")
    sensors = [
        cs.ForceTorqueSensor("elbow", "iiwa_link_4", offset=[1.0] * 6),
        cs.ForceTorqueSensor("wrist", "iiwa_link_7", offset=[2.0] * 6),
    ]
    calibration = calibration_with(robot, {"wrist": [3.0] * 6}, mass=0.5)
    compensator = cs.LoadCompensator(robot, sensors, calibration=calibration)
    np.testing.assert_array_equal(compensator.offsets, [[1.0] * 6, [3.0] * 6])
    q, still = np.full(7, 0.3), np.zeros(7)
    heavier = cs.LoadCompensator(robot, sensors).update(q, still, still, [[1.0] * 6, [2.0] * 6])
    external = compensator.update(q, still, still, compensator.offsets)
    np.testing.assert_allclose(external[:, :3] - heavier[:, :3], [[0, 0, 0.5 * 9.81]] * 2, atol=1e-9)
    with pytest.raises(cs.InputError, match="calibration"):
        cs.LoadCompensator(cs.Robot.named("atlas"), [], calibration=calibration)
    with pytest.raises(cs.InputError, match="sensor_offsets"):
        calibration_with(robot, {"wrist": [1e70] * 6}).check(robot)

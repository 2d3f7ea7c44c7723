"""Force/torque sensors and the compensation of what loads them, beside Pinocchio."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest
from robots import ATLAS, BY_NAME, EXAMPLES, RobotFile, parameters
from sensor_models import SensedModel, adjoint, moving_and_fixed_links

import contactsense as cs
from contactsense import _core
from contactsense.robot import description_file

FILES = parameters([*EXAMPLES, ATLAS[1]])


def scaled(error: np.ndarray, *sizes: np.ndarray) -> float:
    return float(np.abs(error).max() / max(1.0, *(np.abs(size).max() for size in sizes)))


def choose(file: RobotFile, count: int, seed: int) -> list[str]:
    moving, fixed = moving_and_fixed_links(file.require())
    rng = np.random.default_rng(seed)
    links = [*rng.permutation(moving)[:count], *rng.permutation(fixed)[:count]]
    return [str(link) for link in links]


@pytest.mark.parametrize("push", [0.0, 50.0])
@pytest.mark.parametrize("conventions", ["load", "support", "mixed"])
@pytest.mark.parametrize("file", FILES)
def test_against_joint_forces(file: RobotFile, conventions: str, push: float) -> None:
    """Of readings from Pinocchio's joint forces, the forces that push behind the sensor are left."""
    model = SensedModel(file, choose(file, 5, 1), seed=2, conventions=conventions)
    compensator = cs.LoadCompensator(model.robot, model.sensors)
    for _ in range(5):
        motion = model.motion(2.0)
        readings, expected = model.evaluate(motion, push)
        external = compensator.update(motion.q, motion.v, motion.a, readings)
        assert external.shape == (len(model.sensors), 6)
        assert scaled(external - expected, readings) < 1e-11


@pytest.mark.parametrize("file", FILES)
def test_against_the_direct_sum(file: RobotFile) -> None:
    """Eq. 19 body by body, at every moving joint: nested sensors of all depths at once."""
    moving, _ = moving_and_fixed_links(file.require())
    links = [link for link in moving if link]
    robot, model = file.robot(), file.model()
    data = model.createData()
    sensors = [cs.ForceTorqueSensor(link, link) for link in links]
    compensator = cs.LoadCompensator(robot, sensors)
    rng = np.random.default_rng(3)
    q = pin.integrate(model, pin.neutral(model), rng.uniform(-1, 1, model.nv))
    v, a = rng.uniform(-2, 2, (2, model.nv))
    readings = rng.uniform(-50, 50, (len(links), 6))
    pin.forwardKinematics(model, data, q, v, a)
    pin.updateFramePlacements(model, data)
    external = compensator.update(q, v, a, readings)
    for k, link in enumerate(links):
        frame = model.getFrameId(link, pin.FrameType.BODY)
        place = data.oMf[frame]
        expected = np.r_[place.rotation @ readings[k, :3], place.rotation @ readings[k, 3:]]
        for body in model.subtrees[model.frames[frame].parentJoint]:
            turn, inertia = data.oMi[body].rotation, model.inertias[body]
            arm = data.oMi[body].act(inertia.lever) - place.translation
            velocity = pin.getVelocity(model, data, body, pin.LOCAL_WORLD_ALIGNED)
            rate = pin.getClassicalAcceleration(model, data, body, pin.LOCAL_WORLD_ALIGNED)
            w, dw = velocity.angular, rate.angular
            lever = turn @ inertia.lever
            acceleration = rate.linear + np.cross(dw, lever) + np.cross(w, np.cross(w, lever))
            tensor = turn @ inertia.inertia @ turn.T
            force = inertia.mass * (acceleration - model.gravity.linear)
            moment = np.cross(arm, force) + tensor @ dw + np.cross(w, tensor @ w)
            expected += np.r_[force, moment]
        assert scaled(external[k] - expected, expected) < 1e-11, link


def test_moment_arm_of_algorithm_1() -> None:
    """A wrench that passes on from T to S turns by the arm from S to T and the force of that wrench."""
    robot = cs.Robot.named("iiwa14")
    S, T = cs.ForceTorqueSensor("S", "iiwa_link_4"), cs.ForceTorqueSensor("T", "iiwa_link_6")
    both, only = cs.LoadCompensator(robot, [S, T]), cs.LoadCompensator(robot, [S])
    rng = np.random.default_rng(4)
    q, v, a = rng.uniform(-1, 1, (3, 7))
    zero = np.zeros((2, 6))
    load_s, load_t = both.update(q, v, a, zero)
    np.testing.assert_allclose(only.update(q, v, a, zero[:1])[0], load_s, rtol=1e-14)
    # With the arm cut at T, the part between the two is what remains.
    r_s, r_t = (robot.link_pose(q, link)[:3, 3] for link in ("iiwa_link_4", "iiwa_link_6"))
    between = load_s - adjoint(r_t - r_s, load_t)
    model = pin.buildModelFromUrdf(str(description_file("iiwa14")))
    data = model.createData()
    pin.forwardKinematics(model, data, q, v, a)
    expected = np.zeros(6)
    for body in (4, 5):
        expected += adjoint(data.oMi[body].translation - r_s, _newton_euler(model, data, body))
    np.testing.assert_allclose(between, expected, rtol=1e-11, atol=1e-11)


def _newton_euler(model: pin.Model, data: pin.Data, body: int) -> np.ndarray:
    """What accelerates and holds a body: world axes, body's origin."""
    inertia, velocity, rate = model.inertias[body], data.v[body], data.a[body].copy()
    turn = data.oMi[body].rotation
    rate.linear = rate.linear - turn.T @ model.gravity.linear
    wrench = inertia * rate + velocity.cross(inertia * velocity)
    return np.r_[turn @ wrench.linear, turn @ wrench.angular]


def test_fixed_joint_sensor_carries_only_what_is_behind() -> None:
    file = BY_NAME["panda"].require()
    robot = file.robot()
    wrist, hand = cs.ForceTorqueSensor("wrist", "panda_link7"), cs.ForceTorqueSensor("hand", "panda_hand")
    compensator = cs.LoadCompensator(robot, [wrist, hand])
    q, zero = robot.neutral(), np.zeros(robot.nv)
    weights = compensator.update(q, zero, zero, np.zeros((2, 6)))[:, 2] / 9.81
    model = file.model()
    fingers = sum(model.inertias[model.getJointId(f"panda_finger_joint{k}")].mass for k in (1, 2))
    np.testing.assert_allclose(weights, [1.465522 + fingers, 0.73 + fingers], rtol=1e-9)


@pytest.mark.parametrize("file", FILES)
def test_loaders_agree(file: RobotFile) -> None:
    """Link trees and the links' own inertias, seen by a sensor at every link."""
    moving, fixed = moving_and_fixed_links(file.require())
    links = [*moving, *fixed]
    sensors = [cs.ForceTorqueSensor(link, link) for link in links]
    options = {"package_dirs": list(file.package_dirs), "floating_base": file.floating_base}
    model = file.model()
    robots = [
        file.robot(),
        _core._robot_from_urdf(file.path, **options),
        cs.Robot.from_pinocchio(model, pin.GeometryModel()),
    ]
    rng = np.random.default_rng(5)
    q = pin.integrate(model, pin.neutral(model), rng.uniform(-1, 1, model.nv))
    v, a = rng.uniform(-2, 2, (2, model.nv))
    readings = rng.uniform(-10, 10, (len(links), 6))
    first, *others = [cs.LoadCompensator(robot, sensors).update(q, v, a, readings) for robot in robots]
    for other in others:
        assert scaled(other - first, first) < 1e-12


@pytest.mark.parametrize("file", [BY_NAME[name] for name in ("panda", "talos")], ids=lambda file: file.name)
def test_locked_joints_keep_what_is_behind_them(file: RobotFile) -> None:
    """A joint that is locked is as good as a fixed one, for a sensor at it and before it."""
    full = file.robot()
    model = file.model()
    rng = np.random.default_rng(6)
    names = [model.names[k] for k in (model.njoints - 1, model.njoints - 4, model.njoints - 5)]
    moving, fixed = moving_and_fixed_links(file)
    sensors = [cs.ForceTorqueSensor(link, link) for link in [*moving, *fixed]]
    q = pin.integrate(model, pin.neutral(model), rng.uniform(-0.5, 0.5, model.nv))
    v, a = rng.uniform(-2, 2, (2, model.nv))
    held, keep_q, keep_v = {}, np.ones(model.nq, bool), np.ones(model.nv, bool)
    for name in names:
        joint = model.joints[model.getJointId(name)]
        held[name] = q[joint.idx_q]
        keep_q[joint.idx_q], keep_v[joint.idx_v] = False, False
        v[joint.idx_v] = a[joint.idx_v] = 0.0
    readings = rng.uniform(-10, 10, (len(sensors), 6))
    expected = cs.LoadCompensator(full, sensors).update(q, v, a, readings)
    options = {"package_dirs": list(file.package_dirs), "floating_base": file.floating_base}
    locked = file.robot(locked_joints=held)
    native = _core._robot_from_urdf(file.path, locked=list(held.items()), **options)
    reduced_model = pin.buildReducedModel(model, [model.getJointId(name) for name in names], q)
    reduced = cs.Robot.from_pinocchio(reduced_model, pin.GeometryModel())
    assert any("locked joints hang from" in warning for warning in reduced.warnings)
    for robot in (locked, native, reduced):
        # A link that a joint held on the world, or of unknown parent, is not compared.
        usable = [k for k, sensor in enumerate(sensors) if _can_sense(robot, sensor)]
        assert len(usable) >= len(sensors) - 2
        some = [sensors[k] for k in usable]
        external = cs.LoadCompensator(robot, some).update(q[keep_q], v[keep_v], a[keep_v], readings[usable])
        errors = np.abs(external - expected[usable]).max(axis=1) / np.abs(expected).max()
        if robot is not reduced:
            assert errors.max() < 1e-12
    assert np.median(errors) < 1e-12


def _can_sense(robot: cs.Robot, sensor: cs.ForceTorqueSensor) -> bool:
    try:
        cs.LoadCompensator(robot, [sensor])
    except cs.InputError:
        return False
    return True


def test_a_reading_left_out_leaves_the_others() -> None:
    model = SensedModel(BY_NAME["talos"], ["arm_left_3_link", "arm_left_7_link", "leg_left_6_link"])
    compensator = cs.LoadCompensator(model.robot, model.sensors)
    motion = model.motion()
    readings, expected = model.evaluate(motion, 20.0)
    for component in range(6):
        broken = readings.copy()
        broken[1, component] = np.nan
        external = compensator.update(motion.q, motion.v, motion.a, broken)
        assert np.isnan(external[1]).all()
        np.testing.assert_allclose(external[[0, 2]], expected[[0, 2]], atol=1e-9)


def test_bad_input_is_named() -> None:
    robot = cs.Robot.named("iiwa14")
    sensors = [cs.ForceTorqueSensor("a", "iiwa_link_3"), cs.ForceTorqueSensor("b", "iiwa_link_7")]
    compensator = cs.LoadCompensator(robot, sensors)
    good: list[object] = [np.zeros(7), np.zeros(7), np.zeros(7), np.zeros((2, 6))]
    infinite = np.zeros((2, 6))
    infinite[1, 2] = np.inf
    bad = {
        0: [np.full(7, np.nan), np.zeros(6), None],
        1: [np.full(7, np.inf), np.zeros(8)],
        2: [np.full(7, np.nan), np.zeros((7, 1)), "x"],
        3: [
            np.zeros((1, 6)),
            np.zeros((3, 6)),
            np.zeros(6),
            np.zeros((2, 5)),
            infinite,
            None,
            [["x"] * 6] * 2,
        ],
    }
    for position, values in bad.items():
        for value in values:
            arguments = list(good)
            arguments[position] = value
            with pytest.raises(cs.InputError, match=("q", "v", "a", "wrenches")[position]):
                compensator.update(*arguments)
    with pytest.raises(cs.InputError, match=r"row 1 \('b'\)"):
        compensator.update(*good[:3], infinite)
    assert cs.LoadCompensator(robot, []).update(*good[:3], np.zeros((0, 6))).shape == (0, 6)


@pytest.mark.parametrize(
    ("sensors", "message"),
    [
        ([("a", "nothing", {})], "'nothing'.*iiwa_link_3"),
        ([("a", "iiwa_link_0", {})], "fixed to the world"),
        ([("a", "iiwa_link_3", {}), ("a", "iiwa_link_4", {})], "two are named 'a'"),
        ([("a", "iiwa_link_3", {}), ("b", "iiwa_link_3", {})], "'a' and 'b' both sit"),
        (
            [("a", "iiwa_link_3", {"pose": np.diag([1.0, 1, -1, 1])})],
            "pose: must be a rotation.*determinant is -1",
        ),
        ([("a", "iiwa_link_3", {"pose": 2 * np.eye(4)})], "pose: .*last row"),
        ([("a", "iiwa_link_3", {"pose": np.eye(3)})], "pose: expected"),
        ([("a", "iiwa_link_3", {"pose": np.full((4, 4), np.nan)})], "pose"),
        ([("a", "iiwa_link_3", {"convention": "up"})], "convention: must be 'load' or 'support', not 'up'"),
        ([(3, "iiwa_link_3", {})], "name: expected a string"),
    ],
)
def test_bad_sensors_are_named(sensors: list, message: str) -> None:
    with pytest.raises(cs.InputError, match=message):
        cs.LoadCompensator(
            cs.Robot.named("iiwa14"),
            [cs.ForceTorqueSensor(name, link, **options) for name, link, options in sensors],
        )


@pytest.mark.parametrize("sensors", [cs.ForceTorqueSensor("a", "iiwa_link_3"), ["iiwa_link_3"], None])
def test_sensors_must_be_sensors(sensors: object) -> None:
    with pytest.raises(cs.InputError, match="sensors: expected an iterable of ForceTorqueSensor"):
        cs.LoadCompensator(cs.Robot.named("iiwa14"), sensors)


def test_floating_root_carries_no_sensor() -> None:
    with pytest.raises(cs.InputError, match="is the root"):
        cs.LoadCompensator(cs.Robot.named("atlas"), [cs.ForceTorqueSensor("a", "pelvis")])


def test_sensor_is_a_value() -> None:
    pose = np.eye(4)
    pose[:3, 3] = [0.1, 0.2, 0.3]
    sensor = cs.ForceTorqueSensor("wrist", "hand", pose=pose, convention="support")
    same = cs.ForceTorqueSensor("wrist", "hand", pose=pose.tolist(), convention="support")
    assert sensor == same
    assert hash(sensor) == hash(same)
    assert sensor != cs.ForceTorqueSensor("wrist", "hand", pose=pose)
    assert sensor != "wrist"
    assert (sensor.name, sensor.link, sensor.convention) == ("wrist", "hand", "support")
    np.testing.assert_array_equal(sensor.pose, pose)
    with pytest.raises(ValueError, match="read-only"):
        sensor.pose[:] = 0.0
    assert repr(sensor) == "ForceTorqueSensor('wrist', 'hand', convention='support')"
    with pytest.raises(AttributeError):
        sensor.name = "other"

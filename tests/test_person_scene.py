"""Scenes of an imperfect arm and a person: what is true, what an observer sees of it, what is refused."""

from __future__ import annotations

import pickle
from functools import cache

import numpy as np
import pinocchio as pin
import pytest

pytest.importorskip("mujoco", reason="the simulation needs MuJoCo: pip install contactsense[sim]")

from robots import parameters, robot_named

import contactsense as cs
from contactsense import sim

ARMS = parameters(["iiwa14", "panda", "ur5", "kinova"])
GAIN = 300.0  # of the observer [1/s]
IIWA = cs.Robot.named("iiwa14")
SCENE = sim.PersonScene(seconds=25.0, contacts=10, contact_free=5.0, seed=2)


@cache
def recorded(name: str) -> sim.ImperfectRun:
    robot = robot_named(name)
    return SCENE.record(robot, sim.ImperfectArm(payload=_payload(robot), mass_error=0.02, seed=1))


def _payload(robot: cs.Robot) -> sim.Payload:
    return sim.Payload(robot.link_names[-1], 0.5, (0.0, 0.0, 0.05))


@pytest.mark.parametrize("name", ARMS)
def test_moves_are_smooth_within_limits_and_clear_of_the_floor(name: str) -> None:
    robot = robot_named(name)
    motion = sim.random_moves(robot, 20.0, speed=(0.3, 0.5), seed=4)
    model = robot.model
    steps = np.array([pin.difference(model, a, b) for a, b in zip(motion.q[:-1], motion.q[1:], strict=True)])
    np.testing.assert_allclose(steps / 1e-3, 0.5 * (motion.v[1:] + motion.v[:-1]), atol=1e-4)
    np.testing.assert_allclose(
        np.diff(motion.v, axis=0) / 1e-3, 0.5 * (motion.a[1:] + motion.a[:-1]), atol=0.2
    )
    assert (np.abs(motion.v) <= 0.5 * model.velocityLimit + 1e-9).all()
    assert (np.abs(motion.v).max(axis=0) > 0.02 * model.velocityLimit).all()
    low, high = robot.position_limits.T
    assert (motion.q >= low - 1e-12).all()
    assert (motion.q <= high + 1e-12).all()
    still = (motion.v == 0.0).all(axis=1)
    assert 0.1 < still.mean() < 0.9
    far = [link for link in robot.link_names if model.frames[model.getBodyId(link)].parentJoint > 1]
    for q in motion.q[::500]:
        for link in far:
            pose = robot.link_pose(q, link)
            assert (robot.surface(link).vertices @ pose[2, :3] + pose[2, 3]).min() > -0.02


def test_trapezoidal_moves_accelerate_go_on_and_brake() -> None:
    motion = sim.random_moves(IIWA, 20.0, dt=1e-3, profile="trapezoidal", rest=(0.3, 0.5), seed=4)
    np.testing.assert_allclose(
        np.diff(motion.q, axis=0) / 1e-3, 0.5 * (motion.v[1:] + motion.v[:-1]), atol=2e-3
    )
    joint = int(np.abs(motion.v).max(axis=0).argmax())
    jumps = np.flatnonzero(np.abs(np.diff(motion.a[:, joint])) > 0.02)
    smooth = np.setdiff1d(np.arange(len(motion) - 1), np.concatenate([jumps - 1, jumps, jumps + 1]))
    np.testing.assert_allclose(np.diff(motion.v[:, joint])[smooth], 1e-3 * motion.a[smooth, joint], atol=1e-9)
    first = motion.time[jumps[:4]]
    # A third of the time each, and no speed left at the end.
    np.testing.assert_allclose(np.diff(first), (first[3] - first[0]) / 3.0, atol=2e-3)
    assert not motion.v[[jumps[0], jumps[3] + 1]].any()


@pytest.mark.parametrize("name", parameters(["iiwa14", "panda", "ur5"]))
def test_links_that_are_far_apart_in_the_chain_do_not_touch(name: str) -> None:
    robot = robot_named(name)
    shapes = robot.geometry_model.copy()
    joint = [int(shape.parentJoint) for shape in shapes.geometryObjects]
    for j in range(len(joint)):
        for i in range(j):
            if abs(joint[i] - joint[j]) >= 3:
                shapes.addCollisionPair(pin.CollisionPair(i, j))
    data, found = robot.model.createData(), shapes.createData()
    motion = sim.random_moves(robot, 60.0, dt=0.02, seed=6)
    assert not any(pin.computeCollisions(robot.model, data, shapes, found, q, True) for q in motion.q)
    anywhere = [robot.random_configuration(seed) for seed in range(200)]
    assert any(pin.computeCollisions(robot.model, data, shapes, found, q, True) for q in anywhere)


@pytest.mark.parametrize("name", ARMS)
def test_contacts_are_pushes_on_the_surface(name: str) -> None:
    robot, truth = robot_named(name), recorded(name).truth
    assert len(truth.contacts) == 10
    data = robot.model.createData()
    for number, each in enumerate(truth.contacts):
        push = each.contact
        assert 3.0 <= np.linalg.norm(each.force) <= 60.0
        assert 0.1 <= push.duration <= 1.0
        assert push.start >= 5.0
        np.testing.assert_array_equal(
            np.flatnonzero(truth.contact == number), np.arange(*each.rows.indices(10**6))
        )
        nearest = robot.surface(push.link).closest_points(push.point_local)
        assert nearest.distances[0] < 1e-6
        inward = -push.force_local @ nearest.normals[0] / np.linalg.norm(push.force_local)
        # At an edge of the surface, the nearest normal is that of either side.
        assert inward > 0.0
        q = truth.q[each.rows][np.argmin(np.abs(truth.time[each.rows] - each.time))]
        pin.forwardKinematics(robot.model, data, q)
        frame = robot.model.getFrameId(push.link, pin.FrameType.BODY)
        placed = pin.updateFramePlacement(robot.model, data, frame)
        np.testing.assert_allclose(placed.act(push.point_local), each.point, atol=1e-9)
        wrench = np.concatenate([each.force, np.cross(each.point - placed.translation, each.force)])
        jacobian = pin.computeFrameJacobian(robot.model, data, q, frame, pin.LOCAL_WORLD_ALIGNED)
        np.testing.assert_allclose(each.external_torque, jacobian.T @ wrench, atol=1e-9)
    np.testing.assert_array_equal(truth.external_torque[truth.contact_free], 0.0)


def test_directions_fill_the_friction_cone() -> None:
    motion = sim.random_moves(IIWA, 120.0, dt=0.01, seed=1)
    angles = []
    for each in sim.random_contacts(IIWA, motion, 80, friction=0.5, seed=1):
        normal = IIWA.surface(each.link).closest_points(each.point_local).normals[0]
        angles.append(np.arccos(-each.force_local @ normal / np.linalg.norm(each.force_local)))
    assert np.mean(np.array(angles) <= np.arctan(0.5) + 1e-6) > 0.95
    assert np.median(angles) > 0.5 * np.arctan(0.5)


@pytest.mark.parametrize("name", ARMS)
def test_an_observer_of_the_true_robot_sees_the_contacts(name: str) -> None:
    run = recorded(name)
    described, true = (
        _observed(robot, run) - run.truth.external_torque for robot in (robot_named(name), run.truth.robot)
    )
    # The observer is late by 1 / gain.
    steepest = np.abs(np.gradient(run.truth.external_torque, 1e-3, axis=0)).max(axis=0)
    assert (np.abs(true).max(axis=0) <= steepest / GAIN + 0.01).all()
    free = run.truth.time < 5.0
    assert np.abs(true[free]).max() < 0.01
    assert np.abs(described[free]).max() > 0.3


def _observed(robot: cs.Robot, run: sim.ImperfectRun) -> np.ndarray:
    observer = cs.MomentumObserver(robot, dt=1e-3, gain=GAIN)
    rows = zip(run.log.q, run.log.v, run.log.tau, strict=True)
    return np.array([observer.update(q, v, tau) for q, v, tau in rows])


def test_a_compliant_arm_gives_way() -> None:
    motion = sim.random_moves(IIWA, 10.0, seed=3)
    contacts = sim.random_contacts(IIWA, motion, 4, force=(50.0, 60.0), links=["iiwa_link_6"], seed=3)
    soft = sim.record_imperfect(IIWA, sim.ImperfectArm(compliance=1e-3), motion, contacts).truth
    np.testing.assert_allclose(soft.q - motion.q, 1e-3 * soft.external_torque, rtol=0, atol=1e-6)
    assert np.abs(soft.q - motion.q).max() > 5e-3
    np.testing.assert_allclose(np.gradient(soft.q, 1e-3, axis=0), soft.v, atol=1e-3)
    np.testing.assert_allclose(
        soft.tau + soft.external_torque,
        [IIWA.inverse_dynamics(q, v, a) for q, v, a in zip(soft.q, soft.v, soft.a, strict=True)],
        atol=1e-9,
    )


@pytest.mark.parametrize("name", ARMS)
@pytest.mark.parametrize("preset", [sim.ImperfectArm.typical, sim.ImperfectArm.motor_currents])
def test_presets_fit_the_size_of_each_joint(name: str, preset) -> None:
    robot = robot_named(name)
    rated = sim.rated_torque(robot)
    arm = preset(robot, 3)
    assert arm == preset(robot, 3)
    assert arm != preset(robot, 4)
    assert (np.array(arm.torque_noise) < 0.02 * rated).all()
    assert (np.abs(arm.torque_bias) < 0.05 * rated).all()
    seen = np.array(arm.friction.seen) * np.array(arm.friction.coulomb)
    assert (seen < 0.1 * rated).all()
    assert (seen > 0.0).all()


def test_the_same_seed_is_the_same_scene_of_the_same_arm() -> None:
    arm = sim.ImperfectArm.typical(IIWA, 1)
    scene = sim.PersonScene(seconds=6.0, contacts=3, contact_free=1.0, seed=5)
    first, again = scene.record(IIWA, arm), scene.record(IIWA, arm)
    for column in ("time", "q", "v", "tau"):
        np.testing.assert_array_equal(getattr(first.log, column), getattr(again.log, column))
    np.testing.assert_array_equal(first.truth.external_torque, again.truth.external_torque)
    other = sim.record_imperfect(IIWA, arm, sim.random_moves(IIWA, 6.0, seed=5), seed=6)
    plain = sim.record_imperfect(IIWA, arm, sim.random_moves(IIWA, 6.0, seed=5), seed=7)
    assert np.abs(other.log.tau[:1000] - plain.log.tau[:1000]).max() > 0.01
    np.testing.assert_array_equal(
        other.truth.robot.model.inertias[3].mass, plain.truth.robot.model.inertias[3].mass
    )
    copy = pickle.loads(pickle.dumps(first))
    np.testing.assert_array_equal(copy.truth.tau, first.truth.tau)


@pytest.mark.parametrize(
    ("change", "name"),
    [
        ({"torque_noise": -0.1}, "torque_noise"),
        ({"torque_bias": np.nan}, "torque_bias"),
        ({"torque_scale": 0.0}, "torque_scale"),
        ({"hysteresis": "much"}, "hysteresis"),
        ({"encoder_bits": 0}, "encoder_bits"),
        ({"encoder_bits": 12.5}, "encoder_bits"),
        ({"velocity_cutoff": 0.0}, "velocity_cutoff"),
        ({"velocity_order": 3}, "velocity_order"),
        ({"dropped_ticks": 1.0}, "dropped_ticks"),
        ({"mass_error": -0.1}, "mass_error"),
        ({"friction": 0.1}, "friction"),
        ({"payload": 1.0}, "payload"),
        ({"seed": -1}, "seed"),
    ],
)
def test_settings_that_make_no_sense_are_refused(change: dict[str, object], name: str) -> None:
    with pytest.raises(cs.InputError, match=name):
        sim.ImperfectArm(**change)  # type: ignore[arg-type]


def test_what_does_not_fit_the_robot_is_refused() -> None:
    motion = sim.random_moves(IIWA, 2.0, seed=0)
    with pytest.raises(cs.InputError, match="torque_bias"):
        sim.record_imperfect(IIWA, sim.ImperfectArm(torque_bias=[0.1, 0.2]), motion)
    arm = sim.ImperfectArm(payload=sim.Payload("nothing", 1.0, (0.0, 0.0, 0.0)))
    with pytest.raises(cs.InputError, match="nothing"):
        sim.record_imperfect(IIWA, arm, motion)
    with pytest.raises(cs.InputError, match="motion"):
        sim.record_imperfect(robot_named("ur5"), sim.ImperfectArm(), motion)
    late = sim.PersonContact("iiwa_link_6", [0, 0, 0], [1, 0, 0], 1.5, 1.0, 0.2)
    with pytest.raises(cs.InputError, match=r"contacts\[0\]"):
        sim.record_imperfect(IIWA, sim.ImperfectArm(), motion, [late])
    for options, name in (
        ({"contacts": 5}, "contacts"),
        ({"contacts": 1, "links": ["none"]}, "links"),
        ({"contacts": 1, "force": (5.0, 3.0)}, "force"),
        ({"contacts": -1}, "contacts"),
        ({"contacts": 1, "friction": -1.0}, "friction"),
    ):
        with pytest.raises(cs.InputError, match=name):
            sim.random_contacts(IIWA, motion, **options)  # type: ignore[arg-type]
    for options, name in (
        ({"seconds": 0.0}, "seconds"),
        ({"seed": 0.5}, "seed"),
        ({"speed": (0.5, 1.5)}, "speed"),
        ({"floor": 5.0}, "floor"),
        ({"profile": "s-curve"}, "profile"),
    ):
        with pytest.raises(cs.InputError, match=name):
            sim.random_moves(IIWA, **{"seconds": 2.0, **options})  # type: ignore[arg-type]
    with pytest.raises(cs.InputError, match="fixed base"):
        sim.random_moves(cs.Robot.named("atlas"), 2.0)
    for options, name in (
        ({"coulomb": -1.0}, "coulomb"),
        ({"seen": 1.5}, "seen"),
        ({"presliding": -1.0}, "presl"),
    ):
        with pytest.raises(cs.InputError, match=name):
            sim.Friction(**options)  # type: ignore[arg-type]
    with pytest.raises(cs.InputError, match="a: must have 2 rows"):
        sim.JointMotion([0.0, 1.0], np.zeros((2, 7)), np.zeros((2, 7)), np.zeros((3, 7)))
    with pytest.raises(cs.InputError, match="rise"):
        sim.PersonContact("iiwa_link_6", [0, 0, 0], [1, 0, 0], 0.0, 1.0, 0.6)

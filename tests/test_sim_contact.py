"""Penalty contact and soft control: statics in closed form, friction's bounds, MuJoCo's contact beside it."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

pytest.importorskip("mujoco", reason="the simulation needs MuJoCo: pip install contactsense[sim]")

from mujoco_contact import MujocoContact, hull_parts
from robots import packaged, panda

from contactsense.errors import InputError
from contactsense.sim import (
    HandImpedanceController,
    ImpedanceController,
    PenaltyContact,
    SimulatedRobot,
    SphereObstacle,
    joint_torque,
    named_geoms,
    touch_scene,
)

POSE = np.array([0.3, 0.7, -0.2, -1.2, 0.4, 0.7, 0.1])


def test_normal_force_is_a_spring_and_never_pulls() -> None:
    robot = packaged()
    scene = touch_scene(robot, "iiwa_link_4", seed=1)
    contact = scene.contact(robot)
    still = np.zeros(7)
    (force,) = contact.forces(scene.q, still)
    assert force.link == "iiwa_link_4"
    np.testing.assert_allclose(force.force, scene.force, atol=1e-9)
    np.testing.assert_allclose(force.force, -scene.stiffness * force.penetration * force.normal)
    # The external torque is the derivative of the spring's energy.
    numeric = np.zeros(7)
    for k, step in enumerate(1e-6 * np.eye(7)):
        for sign in (1.0, -1.0):
            found = contact.forces(scene.q + sign * step, still)
            depth = found[0].penetration if found else 0.0
            numeric[k] -= sign * 0.5 * scene.stiffness * depth**2 / 2e-6
    np.testing.assert_allclose(joint_torque(robot, scene.q, [force]), numeric, atol=1e-4)
    # Pulled away faster than the spring follows, it lets go.
    damped = scene.contact(robot, dissipation=5.0)
    jacobian = robot.jacobian(scene.q, force.link, force.point)[:3]
    away = -np.linalg.pinv(jacobian) @ force.normal
    assert np.linalg.norm(damped.forces(scene.q, away)[0].force) == 0.0
    harder = np.linalg.norm(damped.forces(scene.q, -0.1 * away)[0].force)
    assert harder == pytest.approx(1.5 * np.linalg.norm(scene.force))


def test_friction_opposes_slip_and_stays_in_the_cone() -> None:
    robot = packaged()
    scene = touch_scene(robot, "iiwa_link_5", seed=2)
    contact = scene.contact(robot, friction=0.2)
    rng = np.random.default_rng(0)
    for speed in (1e-5, 1e-2, 1.0):
        v = speed * rng.normal(size=7)
        (found,) = contact.forces(scene.q, v)
        velocity = robot.jacobian(scene.q, found.link, found.point)[:3] @ v
        slip = velocity - (velocity @ found.normal) * found.normal
        tangential = found.force - (found.force @ found.normal) * found.normal
        normal = -found.force @ found.normal
        size = np.linalg.norm(slip)
        share = np.linalg.norm(tangential) / (0.2 * normal)
        np.testing.assert_allclose(tangential, -0.2 * normal * share * slip / size, atol=1e-9)
        # In a millisecond it does not turn the slip round.
        jacobian = robot.jacobian(scene.q, found.link, found.point)[:3]
        change = 1e-3 * jacobian @ np.linalg.solve(robot.mass_matrix(scene.q), jacobian.T @ tangential)
        assert 0.0 > change @ slip > -1.001 * size**2
        assert share <= size / contact.slip_speed
    assert 0.98 < share < 1.0
    light = PenaltyContact(robot, scene.obstacle, stiffness=scene.stiffness, friction=1e-3, slip_speed=0.1)
    (found,) = light.forces(scene.q, v)
    tangential = found.force - (found.force @ found.normal) * found.normal
    expected = -1e-3 * normal * slip / np.hypot(size, 0.1)
    np.testing.assert_allclose(tangential, expected, atol=1e-9)
    np.testing.assert_allclose(contact.forces(scene.q, np.zeros(7))[0].force, scene.force, atol=1e-9)


def test_a_core_that_is_reached_is_refused() -> None:
    robot = packaged()
    scene = touch_scene(robot, "iiwa_link_5", kind="cylinder", seed=3)
    pose = robot.link_pose(scene.q, "iiwa_link_5")
    center = pose[:3, :3] @ robot.surface("iiwa_link_5").vertices.mean(axis=0) + pose[:3, 3]
    moved = type(scene.obstacle)(center, scene.obstacle.axis, 0.01, 0.5)
    with pytest.raises(InputError, match=r"stiffness: 'iiwa_link_\d' .* rounder"):
        PenaltyContact(robot, moved, stiffness=1e3).forces(scene.q, np.zeros(7))


def test_wrong_settings_are_named() -> None:
    robot = packaged()
    ball = SphereObstacle([0, 0, 0], 1.0)
    for name, value in {"stiffness": 0.0, "friction": -1.0, "slip_speed": 0.0, "dissipation": -1.0}.items():
        options = {"stiffness": 1.0} | {name: value}
        with pytest.raises(InputError, match=name):
            PenaltyContact(robot, ball, **options)
    for name, value in {"stiffness": np.inf, "friction": -1.0, "damping": -1.0}.items():
        options = {"stiffness": 1.0} | {name: value}
        with pytest.raises(InputError, match=name):
            MujocoContact(ball, (), **options)


def _run(arm: SimulatedRobot, control, goal: np.ndarray, contact=None, ticks: int = 1500) -> None:
    for _ in range(ticks):
        arm.clear_forces()
        if contact is not None:
            contact.apply(arm)
        arm.step(control.torque(arm.q, arm.v, goal))


def test_soft_joints_give_way_by_stiffness() -> None:
    robot = packaged()
    model = robot.model
    control = ImpedanceController(model, stiffness=[800.0] * 4 + [50.0] * 3, bandwidth=1e4)
    arm = SimulatedRobot(model)
    arm.reset(POSE)
    push, point = np.array([10.0, -8.0, 5.0]), robot.link_pose(POSE, "iiwa_link_6")[:3, 3]
    for _ in range(3000):
        arm.clear_forces()
        arm.apply_force("iiwa_link_6", point, push)
        arm.step(control.torque(arm.q, arm.v, POSE))
        point = arm.link_pose("iiwa_link_6")[:3, 3]
    expected = arm.external_torque() / control.stiffness
    np.testing.assert_allclose(arm.q - POSE, expected, atol=1e-5)
    assert np.abs(expected).max() > 0.005
    assert np.abs(arm.v).max() < 1e-5


def test_every_mode_is_damped_as_asked_and_none_is_too_fast() -> None:
    model = packaged().model
    data = model.createData()
    control = ImpedanceController(model, stiffness=1000.0, damping_ratio=0.7, bandwidth=150.0)
    # Linear about POSE at rest: torque's derivatives are -K and -D.
    rest = control.torque(POSE, np.zeros(7), POSE)
    np.testing.assert_allclose(rest, pin.computeGeneralizedGravity(model, data, POSE), atol=1e-12)
    step = 1e-4 * np.eye(7)
    spring = np.array([control.torque(POSE, np.zeros(7), POSE + s) - rest for s in step]).T / 1e-4
    damper = np.array([control.torque(POSE, np.zeros(7), POSE, s) - rest for s in step]).T / 1e-4
    mass = np.triu(pin.crba(model, data, POSE))
    mass = mass + np.triu(mass, 1).T
    squares, modes = np.linalg.eig(np.linalg.solve(mass, spring))
    assert np.sqrt(squares.real.max()) == pytest.approx(150.0, rel=1e-6)
    rates = np.diag(np.linalg.solve(modes, np.linalg.solve(mass, damper) @ modes)).real
    np.testing.assert_allclose(rates, 2 * 0.7 * np.sqrt(squares.real), rtol=1e-5)
    # Modes below the bandwidth have the stiffness asked for.
    slow = modes[:, squares.real < 0.98 * 150.0**2].real
    assert slow.shape[1] >= 3
    np.testing.assert_allclose(spring @ slow, 1000.0 * slow, rtol=1e-6, atol=1e-3)


def test_hand_stays_while_the_elbow_moves() -> None:
    robot = packaged()
    model = robot.model
    control = HandImpedanceController(model, "iiwa_link_7")
    arm = SimulatedRobot(model)
    arm.reset(POSE)
    hand, elbow = (robot.link_pose(POSE, f"iiwa_link_{k}") for k in (7, 4))
    _, _, rest = np.linalg.svd(robot.jacobian(POSE, "iiwa_link_7"))
    goal = POSE
    for _ in range(1000):
        # Along the null space as it turns.
        _, _, now = np.linalg.svd(robot.jacobian(goal, "iiwa_link_7"))
        rest[6] = now[6] * np.sign(now[6] @ rest[6])
        goal = goal + 3e-4 * rest[6]
        arm.step(control.torque(arm.q, arm.v, goal))
    _run(arm, control, goal, ticks=500)
    assert np.linalg.norm(arm.link_pose("iiwa_link_7")[:3, 3] - hand[:3, 3]) < 1e-3
    assert np.linalg.norm(arm.link_pose("iiwa_link_4")[:3, 3] - elbow[:3, 3]) > 0.02
    # A hand that is pushed gives way by its stiffness, whatever the null space does.
    for _ in range(2000):
        arm.clear_forces()
        arm.apply_force("iiwa_link_7", arm.link_pose("iiwa_link_7")[:3, 3], [0.0, 10.0, 0.0])
        arm.step(control.torque(arm.q, arm.v, goal))
    held = robot.link_pose(goal, "iiwa_link_7")[:3, 3]
    shift = arm.link_pose("iiwa_link_7")[:3, 3] - held
    np.testing.assert_allclose(shift, [0.0, 10.0 / 2000.0, 0.0], atol=2e-4)


def test_controllers_name_what_is_wrong() -> None:
    model = packaged().model
    free = pin.Model()
    free.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "free")
    for make, name in [
        (lambda: ImpedanceController(free), "model"),
        (lambda: ImpedanceController(model, stiffness=[1.0, -1.0, 1, 1, 1, 1, 1]), "stiffness"),
        (lambda: HandImpedanceController(model, "palm"), "palm"),
        (lambda: HandImpedanceController(model, "iiwa_link_7", rotation=0.0), "rotation"),
    ]:
        with pytest.raises(InputError, match=name):
            make()


@pytest.mark.parametrize("kind", ["sphere", "cube", "cylinder"])
def test_mujoco_finds_the_same_contact_on_convex_links(kind: str) -> None:
    robot = panda()
    model = robot.model
    judged = 0
    for link in ("panda_link3", "panda_link4", "panda_link5", "panda_link6"):
        scene = touch_scene(robot, link, kind=kind, seed=5)
        other = MujocoContact(
            scene.obstacle, hull_parts(robot, [link]), stiffness=scene.stiffness, damping=20.0
        )
        arm = other.arm(model)
        arm.reset(scene.q)
        control = ImpedanceController(model)
        for _ in range(300):
            arm.step(control.torque(arm.q, arm.v, scene.q, None, -scene.external_torque))
        (ours,) = scene.contact(robot).present(arm)
        (theirs,) = other.present(arm)
        assert ours.link == theirs.link == link
        assert np.linalg.norm(ours.point - theirs.point) < 1.5e-3
        size = np.linalg.norm(ours.force)
        assert size > 3.0
        assert np.linalg.norm(ours.force - theirs.force) < 0.05 * size
        judged += np.linalg.norm(ours.force - theirs.force) < 1e-4 * size
        # The arm rests where the penalty contact left it: MuJoCo's spring has the same stiffness.
        assert np.abs(arm.q - scene.q).max() < 2e-3
    assert judged >= 3


def test_mujoco_sums_primitives_and_knows_friction() -> None:
    robot = packaged()
    model = robot.model
    scene = touch_scene(robot, "iiwa_link_6", seed=1)
    parts = [geom for geom in named_geoms("iiwa14") if geom.name.startswith("iiwa_link_6:")]
    other = MujocoContact(scene.obstacle, parts, stiffness=scene.stiffness, friction=0.3)
    arm = other.arm(model)
    arm.reset(scene.q)
    (theirs,) = other.present(arm)
    (ours,) = scene.contact(robot).present(arm)
    assert theirs.link == "iiwa_link_6"
    assert np.linalg.norm(theirs.point - ours.point) < 5e-3
    stray = [*parts, type(parts[0])("palm:0", 1, "sphere", (0.1,))]
    with pytest.raises(InputError, match=r"parts: .*'palm'"):
        MujocoContact(scene.obstacle, stray, stiffness=1.0).arm(model)

"""Vectors from joint names, integration, limits and payloads, as Pinocchio has them."""

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given
from hypothesis import strategies as st
from robots import EXAMPLES
from urdf_text import ARM, write

import contactsense as cs


@pytest.fixture(scope="module")
def arm(tmp_path_factory):
    """Revolute, continuous and sliding joints on a floating base."""
    return cs.Robot.from_urdf(write(tmp_path_factory.mktemp("arm"), ARM), floating_base=True)


BASE = np.array([1.0, 2.0, 3.0, 0.0, 0.0, np.sin(0.3), np.cos(0.3)])


def test_configuration_takes_names_in_any_order(arm):
    q = arm.configuration({"rail": 0.4, "shoulder": -0.2, "elbow": 2.5}, base=BASE)
    np.testing.assert_allclose(q, [*BASE, -0.2, np.cos(2.5), np.sin(2.5), 0.4], atol=1e-15)
    matrix = pin.XYZQUATToSE3(BASE).homogeneous
    np.testing.assert_allclose(arm.configuration({}, base=matrix)[:7], BASE, atol=1e-12)
    np.testing.assert_array_equal(arm.configuration({}), arm.neutral())


def test_velocity_and_torque_take_names_in_any_order(arm):
    v = arm.velocity({"rail": 3, "shoulder": 1}, base=[1, 2, 3, 4, 5, 6])
    np.testing.assert_array_equal(v, [1, 2, 3, 4, 5, 6, 1, 0, 3])
    np.testing.assert_array_equal(arm.torque({"elbow": -5.0}), [0] * 7 + [-5, 0])
    assert cs.MomentumObserver(arm, dt=1e-3).update(arm.neutral(), v, arm.torque({})).shape == (9,)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda arm: arm.configuration({"wrist": 1.0}), "no joint 'wrist'.*shoulder, elbow, rail"),
        (lambda arm: arm.configuration({"root_joint": 1.0}), "no joint 'root_joint'"),
        (lambda arm: arm.velocity({"elbow": np.nan}), "velocities: the value of 'elbow' must be finite"),
        (lambda arm: arm.torque({"elbow": "1"}), "torques: expected {joint name: number}"),
        (lambda arm: arm.torque([1, 2, 3]), "torques: expected {joint name: number}"),
        (lambda arm: arm.configuration({}, base=[0, 0, 0, 0, 0, 0, 0.5]), "quaternion"),
        (lambda arm: arm.configuration({}, base=np.zeros((4, 4))), "base: .*last row 0, 0, 0, 1"),
        (lambda arm: arm.configuration({}, base=np.diag([1.0, 1, -1, 1])), "base: .*determinant is -1"),
        (lambda arm: arm.configuration({}, base=np.diag([1.0, 1, 1.1, 1])), "base: .*off orthonormal"),
        (lambda arm: arm.velocity({}, base=[1, 2]), "base: expected 6 numbers"),
        (lambda arm: arm.integrate(arm.neutral(), np.zeros(3)), "v: expected 9 numbers"),
        (lambda arm: arm.random_configuration(-1), "seed: expected a whole number"),
    ],
)
def test_wrong_names_and_values_are_refused(arm, call, message):
    with pytest.raises(cs.InputError, match=message):
        call(arm)


def test_fixed_base_takes_no_base():
    robot = cs.Robot.named("iiwa14")
    for call in (robot.configuration, robot.velocity):
        with pytest.raises(cs.InputError, match="base: this robot's base is fixed"):
            call({}, base=np.zeros(7)[: 7 if call == robot.configuration else 6])


@given(seed=st.integers(0, 2**32 - 1), scale=st.sampled_from([0.0, 1e-9, 1e-5, 1e-3, 1.0, 3.0]))
def test_integration_is_pinocchios(arm, seed, scale):
    v = scale * np.random.default_rng(seed).standard_normal(arm.nv)
    q = arm.random_configuration(seed)
    np.testing.assert_allclose(
        same_hemisphere(arm.integrate(q, v), q),
        same_hemisphere(pin.integrate(arm.model, q, v), q),
        atol=1e-12,
    )


def same_hemisphere(q, reference):
    q = np.array(q)
    q[3:7] *= np.sign(q[3:7] @ reference[3:7]) or 1.0
    return q


@pytest.mark.parametrize("file", EXAMPLES, ids=lambda file: file.name)
def test_integration_and_limits_of_published_robots(file):
    robot = file.robot()
    rng = np.random.default_rng(5)
    for seed in range(5):
        q = robot.random_configuration(seed)
        np.testing.assert_array_equal(q, robot.random_configuration(seed))
        assert np.all(q >= robot.position_limits[:, 0])
        assert np.all(q <= robot.position_limits[:, 1])
        v = rng.standard_normal(robot.nv)
        expected = pin.integrate(robot.model, q, v)
        found = robot.integrate(q, v)
        if robot.floating_base:
            found, expected = same_hemisphere(found, q), same_hemisphere(expected, q)
        np.testing.assert_allclose(found, expected, atol=1e-12)
        positions = {
            name: np.arctan2(q[joint.idx_q + 1], q[joint.idx_q]) if joint.nq == 2 else q[joint.idx_q]
            for name in robot.actuated_joint_names
            for joint in [robot.model.joints[robot.model.getJointId(name)]]
        }
        base = q[:7] if robot.floating_base else None
        shuffled = dict(sorted(positions.items(), reverse=True))
        np.testing.assert_allclose(robot.configuration(shuffled, base=base), q, atol=1e-14)
    assert robot.mass == pytest.approx(pin.computeTotalMass(robot.model))
    assert set(robot.link_names) <= set(robot.all_link_names)


@pytest.mark.parametrize("inertia", [None, np.diag([0.02, 0.03, 0.04])])
def test_payload_moves_with_its_link(arm, inertia):
    com = np.array([0.1, -0.2, 0.3])
    loaded = arm.with_payload("tool", 2.5, com, inertia)
    model = arm.model.copy()
    frame = model.frames[model.getFrameId("tool", pin.FrameType.BODY)]
    about_com = np.zeros((3, 3)) if inertia is None else inertia
    model.inertias[frame.parentJoint] += frame.placement.act(pin.Inertia(2.5, com, about_com))
    rng = np.random.default_rng(1)
    q, (v, a) = arm.random_configuration(4), rng.standard_normal((2, arm.nv))
    expected = pin.rnea(model, model.createData(), q, v, a)
    np.testing.assert_allclose(loaded.inverse_dynamics(q, v, a), expected, atol=1e-12)
    np.testing.assert_allclose(
        pin.rnea(loaded.model, loaded.model.createData(), q, v, a), expected, atol=1e-12
    )
    assert loaded.mass == pytest.approx(arm.mass + 2.5)
    assert loaded.link_names == arm.link_names
    # The robot without it is as it was.
    unloaded = pin.rnea(arm.model, arm.model.createData(), q, v, a)
    np.testing.assert_allclose(arm.inverse_dynamics(q, v, a), unloaded, atol=1e-12)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("hand", 1.0, [0, 0, 0]), "there is no 'hand'"),
        (("tool", -1.0, [0, 0, 0]), "mass: must be finite and not negative"),
        (("tool", np.nan, [0, 0, 0]), "mass: must be finite"),
        (("tool", 1.0, [0, 0]), "com: expected 3 numbers"),
        (("tool", 1.0, [0, 0, np.nan]), "com: must be 3 finite"),
        (("tool", 1.0, [0, 0, 0], -np.eye(3)), "inertia: must be"),
        (("tool", 1.0, [0, 0, 0], np.eye(2)), "inertia: expected an array of shape"),
        (("tool", "heavy", [0, 0, 0]), "mass: expected a number"),
    ],
)
def test_wrong_payload_is_refused(arm, arguments, message):
    with pytest.raises(cs.InputError, match=message):
        arm.with_payload(*arguments)

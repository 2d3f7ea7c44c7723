"""Motion that calibration learns from: limits, collisions and excitation, judged by Pinocchio and coal."""

import copy
import itertools
import pickle

import numpy as np
import pinocchio as pin
import pytest
from robots import BY_NAME, example, robot_named

import contactsense as cs

ARMS = ["iiwa14", "panda", "ur5", "kinova", "xarm7"]
# Velocity at which Coulomb friction has 76 % of its torque [rad/s].
FRICTION_VELOCITY = 0.05


@pytest.fixture(scope="module", params=ARMS)
def planned(request):
    robot = robot_named(request.param)
    return robot, cs.exciting_motion(robot, 20.0, seed=3)


def speed_limits(robot):
    known = np.isfinite(robot.velocity_limits) & (robot.velocity_limits > 0)
    usual = [0.25 if kind == "prismatic" else 1.0 for kind in robot.joint_kinds]
    return np.where(known, 0.5 * np.where(known, robot.velocity_limits, 0.0), usual)


def test_it_is_within_limits_from_rest_to_rest(planned):
    robot, motion = planned
    lower, upper = robot.position_limits.T
    assert ((lower <= motion.q) & (motion.q <= upper)).all()
    limits = speed_limits(robot)
    assert (np.abs(motion.v) <= limits * (1 + 1e-9)).all()
    assert (np.abs(motion.a) <= 4 * limits * (1 + 1e-9)).all()
    for ends in (motion.v[[0, -1]], motion.a[[0, -1]]):
        np.testing.assert_allclose(ends, 0.0, atol=1e-9)
    assert (motion.time[0], motion.time[-1], motion.duration) == (0.0, 20.0, 20.0)


def test_velocities_and_accelerations_are_derivatives(planned):
    robot, motion = planned
    model = robot.model
    h = 1e-3
    for k in range(1, len(motion) - 1, 97):
        v = pin.difference(model, motion.q[k - 1], motion.q[k + 1]) / (2 * h)
        np.testing.assert_allclose(v, motion.v[k], atol=1e-3)
        # The slope of the acceleration, up to some 100 rad/s^3, jumps between moves.
        np.testing.assert_allclose((motion.v[k + 1] - motion.v[k - 1]) / (2 * h), motion.a[k], atol=0.05)


def test_efforts_are_within_limits(planned):
    robot, motion = planned
    data = robot.model.createData()
    for q, v, a in zip(motion.q[::20], motion.v[::20], motion.a[::20], strict=True):
        tau = pin.rnea(robot.model, data, q, v, a)
        assert (np.abs(tau) <= robot.effort_limits).all()


def collision_pairs(robot):
    """Of all links but neighbours and those that coal finds in collision in nearly all random poses."""
    model, geometry = robot.model, robot.geometry_model.copy()
    geometry.removeAllCollisionPairs()
    parents = list(model.parents)
    for one, other in itertools.combinations(range(len(geometry.geometryObjects)), 2):
        joints = [geometry.geometryObjects[k].parentJoint for k in (one, other)]
        if joints[0] != joints[1] and parents[joints[0]] != joints[1] and parents[joints[1]] != joints[0]:
            geometry.addCollisionPair(pin.CollisionPair(one, other))
    data, shapes, collide = model.createData(), geometry.createData(), 0
    for seed in range(100):
        pin.computeCollisions(model, data, geometry, shapes, robot.random_configuration(seed), False)
        collide += np.array([result.isCollision() for result in shapes.collisionResults], int)
    by_design = [pair for pair, count in zip(geometry.collisionPairs, collide, strict=True) if count > 90]
    for pair in by_design:
        geometry.removeCollisionPair(pair)
    return geometry


@pytest.mark.parametrize("seed", [0, 1])
@pytest.mark.parametrize("name", ARMS)
def test_no_links_collide(name, seed):
    robot = robot_named(name)
    motion = cs.exciting_motion(robot, 20.0, seed=seed)
    geometry = collision_pairs(robot)
    assert len(geometry.collisionPairs) > 8
    data, shapes = robot.model.createData(), geometry.createData()
    for q in motion.q[::20]:
        assert not pin.computeCollisions(robot.model, data, geometry, shapes, q, True)


def regressor(model, q, v, a):
    """Torque by inertial parameters, and by bias, friction and rotor inertia of each joint."""
    data, eye, rows = model.createData(), np.eye(model.nv), []
    for one in zip(q, v, a, strict=True):
        inertial = np.array(pin.computeJointTorqueRegressor(model, data, *one))
        terms = [np.diag(x) for x in (np.tanh(one[1] / FRICTION_VELOCITY), one[1], one[2])]
        rows.append(np.hstack([inertial, eye, *terms]))
    return np.vstack(rows)


def base_parameters(robot, scale):
    """Directions of the parameters that random states excite."""
    rng = np.random.default_rng(0)
    q = [robot.random_configuration(k) for k in range(300)]
    v, a = rng.uniform(-1, 1, (300, robot.nv)), rng.uniform(-4, 4, (300, robot.nv))
    rows = regressor(robot.model, q, v, a)
    scale[:] = np.sqrt((rows**2).mean(axis=0))
    scale[scale == 0.0] = 1.0
    _, values, directions = np.linalg.svd(rows / scale, full_matrices=False)
    return directions[values > 1e-5 * values[0]].T


def test_it_excites_all_that_random_states_excite(planned):
    robot, motion = planned
    scale = np.empty(14 * robot.nv)
    base = base_parameters(robot, scale)
    values = np.linalg.svd(
        regressor(robot.model, motion.q[::50], motion.v[::50], motion.a[::50]) / scale @ base,
        compute_uv=False,
    )
    assert np.sum(values > 1e-6 * values[0]) == base.shape[1]


@pytest.mark.parametrize("name", ["iiwa14", "ur5", "xarm7"])
def test_it_tells_more_than_random_sines(name):
    """The fastest ones within the same limits, as long, which may even collide; by the logarithm of singular
    values."""
    robot = robot_named(name)
    scale = np.empty(14 * robot.nv)
    base = base_parameters(robot, scale)
    limits = np.clip(robot.position_limits, -2 * np.pi, 2 * np.pi)

    def told(q, v, a):
        rows = regressor(robot.model, q, v, a) / scale @ base
        return np.mean(np.log(np.linalg.svd(rows / np.sqrt(len(rows)), compute_uv=False)))

    def sines(seed):
        rng, time = np.random.default_rng(seed), np.arange(0.0, 20.0, 0.05)[:, None, None]
        frequency = 2 * np.pi * rng.uniform(0.05, 0.3, (3, robot.nv))
        amplitude = rng.uniform(0.0, 1.0, (3, robot.nv))
        amplitude *= speed_limits(robot) / (amplitude * frequency).sum(axis=0)
        amplitude *= np.minimum(1.0, 0.9 * np.ptp(limits, axis=1) / 2 / amplitude.sum(axis=0))
        angle = frequency * time + rng.uniform(0.0, 2 * np.pi, (3, robot.nv))
        q, v = amplitude * np.sin(angle), amplitude * frequency * np.cos(angle)
        return told(q.sum(axis=1) + limits.mean(axis=1), v.sum(axis=1), -(frequency**2 * q).sum(axis=1))

    def planned_one(seed):
        motion = cs.exciting_motion(robot, 20.0, seed=seed)
        return told(motion.q[::50], motion.v[::50], motion.a[::50])

    # By half on average, in each direction.
    assert min(planned_one(seed) for seed in range(3)) > max(sines(seed) for seed in range(3)) + np.log(1.5)


def test_it_reaches_far(planned):
    """In 20 s, most joints see much of their range, or as much as two seconds at their largest speed."""
    robot, motion = planned
    moved = [kind not in ("continuous", "prismatic") for kind in robot.joint_kinds]
    if robot.nq != robot.nv:
        pytest.skip("positions of continuous joints are cosine and sine")
    seen = np.ptp(motion.q, axis=0)
    wanted = np.minimum(0.5 * np.ptp(robot.position_limits, axis=1), 2.0 * speed_limits(robot))
    assert np.mean((seen >= wanted)[moved]) > 0.5


def test_it_has_slow_and_fast_parts_of_both_signs(planned):
    robot, motion = planned
    share = motion.v / speed_limits(robot)
    arm = [kind != "prismatic" for kind in robot.joint_kinds]
    for sign in (1, -1):
        slow = (sign * share > 0.01) & (sign * share < 0.15)
        assert (slow.mean(axis=0)[arm] > 0.05).all()
        # Faster than any slow move.
        assert (np.max(sign * share, axis=0)[arm] > 0.15).all()


def test_the_same_seed_gives_the_same_motion():
    robot = cs.Robot.named("iiwa14")
    one, same, other = (cs.exciting_motion(robot, 3.0, seed=seed) for seed in (5, 5, 6))
    np.testing.assert_array_equal(one.q, same.q)
    assert not np.array_equal(one.q, other.q)


def test_only_chosen_joints_move_and_the_others_help():
    robot = cs.Robot.named("iiwa14")
    motion = cs.exciting_motion(robot, 6.0, joints=["iiwa_joint_4", "iiwa_joint_6"])
    moving = np.ptp(motion.q, axis=0) > 0.0
    assert list(np.flatnonzero(moving)) == [3, 5]
    weights = [robot.inverse_dynamics(q, np.zeros(7), np.zeros(7)) for q in motion.q[::50]]
    upright = [robot.inverse_dynamics(robot.neutral(), np.zeros(7), np.zeros(7))]
    assert np.abs(weights)[:, 3].max() > np.abs(upright)[0, 3] + 5.0


def test_speeds_asked_for_are_kept():
    robot = cs.Robot.named("iiwa14")
    wanted = np.array([0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7])
    motion = cs.exciting_motion(robot, 5.0, max_velocity=wanted)
    assert (np.abs(motion.v) <= wanted * (1 + 1e-9)).all()
    assert np.abs(cs.exciting_motion(robot, 5.0, max_velocity=0.3).v).max() <= 0.3 * (1 + 1e-9)


def test_the_limits_of_the_robot_bound_speeds_that_are_asked_for():
    robot = cs.Robot.named("iiwa14")
    motion = cs.exciting_motion(robot, 6.0, dt=0.01, max_velocity=100.0)
    assert (np.abs(motion.v) <= robot.velocity_limits * (1 + 1e-9)).all()
    assert np.abs(motion.v).max() > 0.5 * robot.velocity_limits.max()
    assert (np.abs(motion.a) <= 4 * robot.velocity_limits * (1 + 1e-9)).all()
    wanted = np.array([0.1, *[100.0] * 6])
    assert np.abs(cs.exciting_motion(robot, 6.0, dt=0.01, max_velocity=wanted).v[:, 0]).max() <= 0.1 * (
        1 + 1e-9
    )


def test_a_continuous_joint_is_cosine_and_sine():
    robot = cs.Robot.from_urdf(
        example("kinova_description/robots/kinova.urdf"), package_dirs=BY_NAME["kinova"].package_dirs
    )
    motion = cs.exciting_motion(robot, 3.0)
    assert "continuous" in robot.joint_kinds
    assert motion.q.shape == (3001, robot.nq)
    for q, after, v in zip(motion.q[:-1:50], motion.q[1::50], motion.v[:-1:50], strict=True):
        assert pin.isNormalized(robot.model, q, 1e-9)
        np.testing.assert_allclose(robot.integrate(q, 1e-3 * v), after, atol=1e-4)


def test_it_can_be_sampled_pickled_and_written():
    motion = cs.exciting_motion(cs.Robot.named("iiwa14"), 2.0, dt=0.01)
    assert (len(motion), motion.q.shape, motion.v.shape, motion.a.shape) == (201, *[(201, 7)] * 3)
    q, v, a = motion.at(motion.time[77])
    for one, rows in ((q, motion.q), (v, motion.v), (a, motion.a)):
        np.testing.assert_array_equal(one, rows[77])
        assert not rows.flags.writeable
    np.testing.assert_array_equal(motion.at(-1.0)[0], motion.q[0])
    np.testing.assert_allclose(motion.at(99.0)[0], motion.q[-1], atol=1e-12)
    for again in (pickle.loads(pickle.dumps(motion)), copy.deepcopy(motion)):
        np.testing.assert_array_equal(again.q, motion.q)
        assert again.unchecked == motion.unchecked
        np.testing.assert_array_equal(again.at(0.7)[1], motion.at(0.7)[1])
    assert motion.to_dict()["q"] == motion.q.tolist()
    assert repr(motion).startswith("Motion(2.000 s, 201 rows")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"seconds": 0.5}, "seconds: must be from 1 to 600"),
        ({"seconds": 601}, "seconds"),
        ({"seconds": float("nan")}, "seconds"),
        ({"seconds": "ten"}, "seconds"),
        ({"max_velocity": 0.0}, "max_velocity: must be positive"),
        ({"max_velocity": [1.0, 1.0]}, "max_velocity: expected one number or 7"),
        ({"max_velocity": float("inf")}, "max_velocity"),
        ({"max_velocity": []}, "max_velocity"),
        ({"seed": -1}, "seed"),
        ({"dt": 0.0}, "dt"),
        ({"dt": float("nan")}, "dt"),
        ({"dt": 1e-9}, "dt"),
        ({"dt": 10.0}, "dt"),
        ({"joints": ["elbow"]}, "joints: .*no 'elbow'.*iiwa_joint_1"),
        ({"joints": "iiwa_joint_1"}, "joints: expected names"),
        ({"joints": []}, "joints"),
    ],
)
def test_wrong_arguments_are_named(arguments, message):
    with pytest.raises(cs.InputError, match=message):
        cs.exciting_motion(cs.Robot.named("iiwa14"), **{"seconds": 5.0, **arguments})


def test_a_floating_base_is_refused():
    with pytest.raises(cs.InputError, match="robot: its base is free to move"):
        cs.exciting_motion(cs.Robot.named("atlas"), 5.0)

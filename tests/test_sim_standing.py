"""Floating bases in the simulation: ground, force/torque sensors, and a humanoid that stands."""

from __future__ import annotations

from xml.etree import ElementTree as ET

import numpy as np
import pinocchio as pin
import pytest

pytest.importorskip("mujoco", reason="the simulation needs MuJoCo: pip install contactsense[sim]")

import mujoco

from contactsense import ForceTorqueSensor, Robot
from contactsense.errors import InputError, ModelError
from contactsense.sim import (
    FLOOR_TYPE,
    Floor,
    Push,
    SimulatedRobot,
    Sole,
    StandingController,
    WrenchNoise,
    mjcf_tree,
    named_geoms,
)
from contactsense.sim.atlas import FEET, SENSOR_LINKS, SENSORS, controller, posture

# What turns more slowly has turned less than the posture's tolerance of 2 mrad after 10 s [rad/s, m/s].
STILL = 2e-4


def _turned() -> np.ndarray:
    pose = np.eye(4)
    pose[:3, :3] = pin.rpy.rpyToMatrix(0.3, -0.7, 1.1)
    pose[:3, 3] = [0.02, -0.05, 0.01]
    return pose


def _standing(**options: object) -> SimulatedRobot:
    geoms = named_geoms("atlas", conaffinity=FLOOR_TYPE)
    return SimulatedRobot(Robot.named("atlas").model, geoms=geoms, floor=Floor(), sensors=SENSORS, **options)


def _load(model: pin.Model, link: str, q: np.ndarray, v: np.ndarray, a: np.ndarray) -> np.ndarray:
    """What the bodies behind a link's joint put on it by weight and inertia, at its origin, link's axes."""
    data = model.createData()
    pin.rnea(model, data, q, v, a)
    return -data.f[model.frames[model.getFrameId(link)].parentJoint].vector


def test_loads_in_free_flight_are_those_of_newton_and_euler() -> None:
    model = Robot.named("atlas").model
    pose = _turned()
    sensors = (
        *SENSORS,
        ForceTorqueSensor("turned", "r_ufarm", pose=pose),
        ForceTorqueSensor("held", "l_hand", convention="support"),
    )
    robot = SimulatedRobot(model, sensors=sensors)
    rng = np.random.default_rng(4)
    pin.seed(4)
    q = pin.randomConfiguration(model, np.full(model.nq, -1.0), np.full(model.nq, 1.0))
    v, tau = rng.normal(size=model.nv), 5.0 * rng.normal(size=30)
    robot.reset(q, v)
    measured = robot.step(tau)
    a = pin.aba(model, model.createData(), q, v, np.concatenate([np.zeros(6), tau]))
    expected = [_load(model, sensor.link, q, v, a) for sensor in sensors]
    expected[-2] = pin.SE3(pose[:3, :3], pose[:3, 3]).actInv(pin.Force(expected[-2])).vector
    expected[-1] = -expected[-1]
    assert np.abs(expected).max() > 50.0
    np.testing.assert_allclose(measured.wrenches, expected, atol=1e-8)


def test_a_hand_at_rest_gives_its_weight() -> None:
    robot = _standing()
    q = posture(robot.model, 0)
    robot.reset(q)
    control = controller(robot.model, q)
    for _ in range(1000):
        measured = robot.step(control.torque(robot.q, robot.v))
    turn = robot.link_pose("l_hand")[:3, :3]
    np.testing.assert_allclose(turn @ measured.wrenches[0, :3], [0.0, 0.0, -0.5839 * 9.81], atol=1e-3)


def test_readings_are_the_mean_over_the_jump_of_the_torque() -> None:
    model = Robot.named("atlas").model
    robot = SimulatedRobot(model, sensors=SENSORS)
    first, second = np.random.default_rng(1).normal(scale=5.0, size=(2, 30))
    robot.step(first)
    q, v = robot.q, robot.v
    measured = robot.step(second)
    data = model.createData()
    a = [pin.aba(model, data, q, v, np.concatenate([np.zeros(6), tau])).copy() for tau in (first, second)]
    expected = [_load(model, link, q, v, 0.5 * (a[0] + a[1])) for link in SENSOR_LINKS]
    np.testing.assert_allclose(measured.wrenches, expected, atol=1e-7)


def test_it_stands_still_for_ten_seconds() -> None:
    robot = _standing()
    q = posture(robot.model, 3)
    robot.reset(q)
    control = controller(robot.model, q)
    for _ in range(10_000):
        measured = robot.step(control.torque(robot.q, robot.v))
    np.testing.assert_allclose(robot.q, q, atol=2e-3)
    # What the contact solver leaves depends on the processor: 1e-6 to 3e-6 rad/s were seen.
    assert np.abs(robot.v).max() < STILL
    # The ground carries it by the feet, and by them alone.
    model = robot.model
    still = np.zeros(model.nv)
    weight = pin.computeTotalMass(model) * 9.81
    external = [
        measured.wrenches[k] - _load(model, link, robot.q, still, still)
        for k, link in enumerate(SENSOR_LINKS)
    ]
    ground = sum(robot.link_pose(foot)[:3, :3] @ external[SENSOR_LINKS.index(foot)][:3] for foot in FEET)
    np.testing.assert_allclose(ground, [0.0, 0.0, weight], atol=1e-2)
    for name in ("l_hand", "r_hand", "l_clav", "r_clav", "utorso"):
        np.testing.assert_allclose(external[SENSOR_LINKS.index(name)], 0.0, atol=1e-3)
    assert external[SENSOR_LINKS.index("l_uglut")][2] > 0.3 * weight


@pytest.mark.parametrize("direction", [(1, 0), (-1, 0), (0, 1), (0, -1)])
def test_it_withstands_long_pushes_at_the_chest(direction: tuple[int, int]) -> None:
    robot = _standing()
    q = posture(robot.model, 5)
    robot.reset(q)
    control = controller(robot.model, q)
    push = Push("utorso", np.array([0.0, 0.0, 0.5]), np.array([*direction, 0.0]), 100.0, 0.3, 0.4, "world")
    for _ in range(1200):
        robot.clear_forces()
        push.apply(robot)
        robot.step(control.torque(robot.q, robot.v))
    np.testing.assert_allclose(robot.q, q, atol=5e-3)


def test_a_push_is_in_the_loads_of_all_sensors_before_it() -> None:
    robot = _standing()
    q = posture(robot.model, 6)
    robot.reset(q)
    control, model = controller(robot.model, q), robot.model
    push = Push("l_ufarm", np.array([0.05, 0.05, 0.0]), np.array([-1.0, 0.3, 0.2]), 60.0, 0.2, 0.2)
    states, truths = [], []
    for _ in range(320):
        robot.clear_forces()
        push.apply(robot)
        truths.append(push.force_at(robot.time, robot.link_pose("l_ufarm")))
        states.append(robot.step(control.torque(robot.q, robot.v)))
    assert np.linalg.norm(truths[300][1]) > 59.0
    sample, before, after = states[300], states[299], states[301]
    a = (after.v - before.v) / (2 * robot.dt)
    for name in ("l_clav", "utorso", "r_clav", "l_hand"):
        wrench = sample.wrenches[SENSOR_LINKS.index(name)] - _load(model, name, sample.q, sample.v, a)
        data = model.createData()
        pin.framesForwardKinematics(model, data, sample.q)
        pose = data.oMf[model.getFrameId(name)]
        felt = pose.rotation @ wrench[:3], pose.rotation @ wrench[3:]
        point, force = truths[300] if name in ("l_clav", "utorso") else (pose.translation, np.zeros(3))
        # The acceleration is a difference over two ticks: 125 kg behind the chest's sensor feel its error.
        np.testing.assert_allclose(felt[0], force, atol=0.05)
        np.testing.assert_allclose(felt[1], np.cross(point - pose.translation, force), atol=0.05)


def test_wrench_noise_has_its_size_and_repeats() -> None:
    wrenches = np.full((2, 6), 30.0)
    noise = WrenchNoise(newtons=2.0, newton_metres=0.1, seed=3)
    drawn = np.array([noise.measure(wrenches) for _ in range(20_000)])
    np.testing.assert_allclose(drawn.mean(axis=0), wrenches, atol=0.06)
    np.testing.assert_allclose(drawn.std(axis=0), [[2.0] * 3 + [0.1] * 3] * 2, rtol=0.03)
    again = WrenchNoise(newtons=2.0, newton_metres=0.1, seed=3)
    np.testing.assert_array_equal(drawn[0], again.measure(wrenches))
    clean = SimulatedRobot(Robot.named("atlas").model, sensors=SENSORS)
    noisy = SimulatedRobot(Robot.named("atlas").model, sensors=SENSORS, wrench_noise=again)
    error = noisy.step(np.ones(30)).wrenches - clean.step(np.ones(30)).wrenches
    assert 0.5 < error[:, :3].std() < 4.0
    np.testing.assert_array_equal(clean.q, noisy.q)


def test_links_do_not_collide_with_each_other_and_without_a_floor_it_falls() -> None:
    geoms = named_geoms("atlas", conaffinity=FLOOR_TYPE)
    robot = SimulatedRobot(Robot.named("atlas").model, geoms=geoms)
    for _ in range(100):
        robot.step(np.zeros(30))
        assert robot.mj_data.ncon == 0
    assert robot.q[2] == pytest.approx(-0.5 * 9.81 * 0.1**2, abs=1e-2)
    assert robot.measure().wrenches.shape == (0, 6)


def test_wrong_arguments_are_named() -> None:
    model = Robot.named("atlas").model
    with pytest.raises(InputError, match=r"sensors: 'a' sits before link 'pelvis'.*moving joint"):
        SimulatedRobot(model, sensors=[ForceTorqueSensor("a", "pelvis")])
    with pytest.raises(InputError, match=r"sensors: 'a' .*'tail', which does not exist"):
        SimulatedRobot(model, sensors=[ForceTorqueSensor("a", "tail")])
    with pytest.raises(InputError, match="sensors: names must differ"):
        SimulatedRobot(model, sensors=[ForceTorqueSensor("a", "l_hand"), ForceTorqueSensor("a", "r_hand")])
    plain = ET.tostring(mjcf_tree(model), encoding="unicode")
    with pytest.raises(InputError, match="sensors: the MuJoCo model has no sensor 'l_hand:force'"):
        SimulatedRobot(model, mjcf=plain, sensors=SENSORS)
    with pytest.raises(InputError, match="floor"):
        SimulatedRobot(model, mjcf=plain, floor=Floor())
    with pytest.raises(InputError, match="time_constant"):
        Floor(time_constant=0.0)
    soles = [Sole(foot, np.zeros(3), (0.1, 0.05)) for foot in FEET]
    q = posture(model, 0)
    StandingController(model, q, soles)
    with pytest.raises(ModelError, match="free base"):
        StandingController(Robot.named("iiwa14").model, np.zeros(7), soles)
    with pytest.raises(ModelError, match="six joints of its own"):
        StandingController(model, q, [*soles, Sole("l_talus", np.zeros(3), (0.1, 0.05))])
    with pytest.raises(InputError, match="soles: no link 'tail'"):
        StandingController(model, q, [Sole("tail", np.zeros(3), (0.1, 0.05))])
    with pytest.raises(InputError, match="kp"):
        StandingController(model, q, soles, kp=-1.0)
    with pytest.raises(InputError, match="half_lengths"):
        Sole("l_foot", np.zeros(3), (0.1, 0.0))


def test_sensors_of_an_own_world_are_read() -> None:
    model = Robot.named("atlas").model
    text = ET.tostring(mjcf_tree(model, floor=Floor(), sensors=SENSORS), encoding="unicode")
    robot = SimulatedRobot(model, mjcf=text, sensors=SENSORS[::-1])
    assert mujoco.mj_name2id(robot.mj_model, mujoco.mjtObj.mjOBJ_GEOM, "floor") >= 0
    reference = SimulatedRobot(model, sensors=SENSORS)
    tau = np.linspace(-3.0, 3.0, 30)
    np.testing.assert_allclose(robot.step(tau).wrenches, reference.step(tau).wrenches[::-1], atol=1e-9)

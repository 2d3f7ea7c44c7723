"""The simulation: MuJoCo computes Pinocchio's dynamics, and measures what an observer expects."""

import importlib
import sys
from collections.abc import Callable
from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np
import pinocchio as pin
import pytest

pytest.importorskip("mujoco", reason="the simulation needs MuJoCo: pip install contactsense[sim]")

import mujoco
from described import describe_urdf
from robots import PACKAGE_DIRS, example

from contactsense import Robot
from contactsense.errors import InputError, ModelError
from contactsense.sim import (
    Coordinates,
    SimulatedRobot,
    TorqueNoise,
    geoms_of,
    mjcf_string,
    mjcf_tree,
)
from contactsense.sim.coordinates import base_rotation

DESCRIPTIONS = Path(__file__).resolve().parents[1] / "python" / "contactsense" / "descriptions"


def _example(file: str, *, floating: bool) -> pin.Model:
    return Robot.from_urdf(example(file), package_dirs=PACKAGE_DIRS, floating_base=floating).model


def _continuous() -> pin.Model:
    """A free body with a continuous and a sliding joint and a massless one, all with slanting axes."""
    model = pin.Model()
    base = model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "free")
    axis = np.array([1.0, 2.0, -2.0]) / 3
    wheel = model.addJoint(base, pin.JointModelRUBY(), pin.SE3.Random(), "wheel")
    hollow = model.addJoint(wheel, pin.JointModelRevoluteUnaligned(axis), pin.SE3.Random(), "hollow")
    tip = model.addJoint(hollow, pin.JointModelRZ(), pin.SE3.Random(), "tip")
    slide = model.addJoint(base, pin.JointModelPrismaticUnaligned(axis), pin.SE3.Random(), "slide")
    for joint in (base, wheel, slide, tip):
        inertia = pin.Inertia.FromBox(2.0, 0.1, 0.2, 0.3)
        model.appendBodyToJoint(joint, inertia, pin.SE3.Random())
    model.armature = np.concatenate([np.zeros(6), [0.1, 0.2, 0.3, 0.4]])
    return model


MODELS: dict[str, Callable[[], pin.Model]] = {
    "iiwa14": lambda: Robot.named("iiwa14").model,
    "atlas": lambda: Robot.named("atlas").model,
    "panda": lambda: _example("panda_description/urdf/panda.urdf", floating=False),
    "talos": lambda: _example("talos_data/robots/talos_reduced.urdf", floating=True),
    "continuous": _continuous,
}


def _random_state(model: pin.Model, seed: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    pin.seed(seed)
    rng = np.random.default_rng(seed)
    q = pin.randomConfiguration(model, np.full(model.nq, -2.0), np.full(model.nq, 2.0))
    return q, rng.normal(size=model.nv), rng.normal(size=model.nv)


@pytest.mark.parametrize("name", MODELS)
def test_dynamics_agree_with_pinocchio(name: str) -> None:
    model = MODELS[name]()
    data = model.createData()
    mj_model = mujoco.MjModel.from_xml_string(mjcf_string(model))
    mj_data = mujoco.MjData(mj_model)
    coordinates = Coordinates(model, mj_model)
    assert mj_model.opt.jacobian == mujoco.mjtJacobian.mjJAC_DENSE
    for seed in range(20):
        q, v, a = _random_state(model, seed)
        mj_data.qpos[:] = coordinates.qpos(q)
        np.testing.assert_allclose(coordinates.q(mj_data.qpos), q, atol=1e-12)

        mj_data.qvel[:] = 0
        mujoco.mj_forward(mj_model, mj_data)
        gravity = coordinates.v(q, mj_data.qfrc_bias)
        np.testing.assert_allclose(gravity, pin.computeGeneralizedGravity(model, data, q), atol=1e-9)

        mass = np.zeros((model.nv, model.nv))
        mujoco.mj_fullM(mj_model, mj_data, mass)
        basis = np.array([coordinates.qvel(q, row) for row in np.eye(model.nv)])
        pin.crba(model, data, q)
        expected = np.triu(data.M) + np.triu(data.M, 1).T
        np.testing.assert_allclose(basis @ mass @ basis.T, expected, atol=1e-9)

        mj_data.qvel[:] = coordinates.qvel(q, v)
        np.testing.assert_allclose(coordinates.v(q, mj_data.qvel), v, atol=1e-12)
        mj_data.qacc[:] = coordinates.qvel(q, a)
        if coordinates.floating_base:
            # MuJoCo's axes are the world's, in which the base's velocity also turns with the base.
            mj_data.qacc[:3] += base_rotation(q) @ np.cross(v[3:6], v[:3])
        mujoco.mj_inverse(mj_model, mj_data)
        tau = coordinates.v(q, mj_data.qfrc_inverse)
        np.testing.assert_allclose(tau, pin.rnea(model, data, q, v, a), atol=1e-9)


def test_joints_mujoco_lacks_are_named() -> None:
    model = pin.Model()
    model.addJoint(0, pin.JointModelSpherical(), pin.SE3.Identity(), "ball")
    with pytest.raises(ModelError, match="'ball'"):
        mjcf_string(model)
    model = pin.Model()
    model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3(np.eye(3), np.ones(3)), "base")
    with pytest.raises(ModelError, match=r"'base'.*origin"):
        mjcf_string(model)


def test_impossible_inertia_is_named() -> None:
    model = pin.Model()
    joint = model.addJoint(0, pin.JointModelRX(), pin.SE3.Identity(), "elbow")
    model.appendBodyToJoint(
        joint, pin.Inertia(1.0, np.zeros(3), np.diag([1.0, 1.0, 5.0])), pin.SE3.Identity()
    )
    with pytest.raises(ModelError, match="'elbow'"):
        mjcf_string(model)


def test_absent_mujoco_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "mujoco", None)
    monkeypatch.delitem(sys.modules, "contactsense.sim._mujoco")
    with pytest.raises(ImportError, match=r"pip install 'contactsense\[sim\]'"):
        importlib.import_module("contactsense.sim._mujoco")


def test_wrong_arguments_are_named() -> None:
    model = Robot.named("iiwa14").model
    with pytest.raises(InputError, match="dt"):
        mjcf_string(model, dt=0.0)
    with pytest.raises(InputError, match="dt"):
        SimulatedRobot(model, dt=-1.0)
    with pytest.raises(ModelError, match="MuJoCo cannot read"):
        SimulatedRobot(model, mjcf="<mujoco")
    with pytest.raises(InputError, match="integrator"):
        mjcf_string(model, integrator="Heun")  # type: ignore[arg-type]
    robot = SimulatedRobot(model)
    with pytest.raises(InputError, match=r"tau.*\(7,\)"):
        robot.step(np.zeros(6))
    with pytest.raises(InputError, match=r"tau.*entry 2"):
        robot.step([0, 0, np.nan, 0, 0, 0, 0])
    assert robot.time == 0.0
    with pytest.raises(InputError, match="iiwa_link_3"):
        robot.apply_force("link_3", np.zeros(3), np.ones(3))
    with pytest.raises(InputError, match="fixed to the world"):
        robot.apply_force("iiwa_link_0", np.zeros(3), np.ones(3))
    assert not robot.external_torque().any()


def test_geoms_lie_where_the_description_has_them() -> None:
    description = describe_urdf(DESCRIPTIONS / "iiwa14.urdf")
    model = Robot.named("iiwa14").model
    geoms = geoms_of(description.links, contype=1, conaffinity=2)
    assert len(geoms) == sum(len(link.geometry) for link in description.links)
    robot = SimulatedRobot(model, geoms=geoms)
    q = _random_state(model, 1)[0]
    robot.reset(q)
    for link in description.links:
        for number, shape in enumerate(link.geometry):
            geom = robot.mj_data.geom(f"{link.name}:{number}")
            pose = robot.link_pose(link.name) @ shape.placement
            np.testing.assert_allclose(geom.xpos, pose[:3, 3], atol=1e-12)
            np.testing.assert_allclose(geom.xmat.reshape(3, 3), pose[:3, :3], atol=1e-12)
    capsule = robot.mj_model.geom("iiwa_link_6:0")
    assert capsule.type[0] == mujoco.mjtGeom.mjGEOM_CAPSULE
    assert (capsule.contype[0], capsule.conaffinity[0]) == (1, 2)
    # Shapes carry no mass: the dynamics stay the model's.
    np.testing.assert_allclose(robot.mj_model.body_subtreemass[0], sum(i.mass for i in model.inertias[1:]))


@pytest.mark.parametrize("name", ["iiwa14", "atlas"])
def test_forces_act_as_the_jacobian_says(name: str) -> None:
    model = Robot.named(name).model
    robot = SimulatedRobot(model)
    data = model.createData()
    for seed, link in enumerate(
        ["iiwa_link_3", "iiwa_link_ee"] if name == "iiwa14" else ["l_larm", "pelvis"]
    ):
        q, v, _ = _random_state(model, seed)
        robot.reset(q, v)
        rng = np.random.default_rng(seed)
        local, force = rng.normal(size=(2, 3))
        frame = model.getFrameId(link, pin.FrameType.BODY)
        pin.computeJointJacobians(model, data, q)
        pin.updateFramePlacements(model, data)
        np.testing.assert_allclose(robot.link_pose(link), data.oMf[frame].homogeneous, atol=1e-12)
        point = data.oMf[frame].act(local)
        jacobian = pin.getFrameJacobian(model, data, frame, pin.ReferenceFrame.LOCAL_WORLD_ALIGNED)
        arm = point - data.oMf[frame].translation
        expected = jacobian.T @ np.concatenate([force, np.cross(arm, force)])
        robot.apply_force(link, point, 0.25 * force)
        robot.apply_force(link, point, 0.75 * force)
        np.testing.assert_allclose(robot.external_torque(), expected, atol=1e-10)
        mujoco.mj_forward(robot.mj_model, robot.mj_data)
        felt = robot.coordinates.v(q, np.array(robot.mj_data.qfrc_smooth + robot.mj_data.qfrc_bias))
        np.testing.assert_allclose(felt, expected, atol=1e-10)
        robot.clear_forces()
        assert not robot.external_torque().any()


def test_free_fall_of_a_floating_robot() -> None:
    model = Robot.named("atlas").model
    robot = SimulatedRobot(model)
    data = model.createData()
    start = pin.centerOfMass(model, data, robot.q).copy()
    for _ in range(200):
        robot.step(np.zeros(30))
    end = pin.centerOfMass(model, data, robot.q)
    np.testing.assert_allclose(end - start, [0, 0, -0.5 * 9.81 * 0.2**2], atol=1e-9)


def test_measurement_belongs_to_the_beginning_of_its_step() -> None:
    model = Robot.named("iiwa14").model
    robot = SimulatedRobot(model, dt=0.001)
    q, v, _ = _random_state(model, 5)
    robot.reset(q, v)
    start = robot.measure()
    np.testing.assert_allclose(start.q, q)
    np.testing.assert_array_equal(start.tau, 0)
    first = robot.step(np.full(7, 2.0))
    assert first.time == 0.0
    np.testing.assert_allclose(first.q, q)
    np.testing.assert_allclose(first.v, v)
    np.testing.assert_array_equal(first.tau, 2.0)
    np.testing.assert_array_equal(first.tau_mean, 2.0)
    reached = robot.q
    second = robot.step(np.full(7, 4.0))
    assert second is robot.measure()
    assert second.time == pytest.approx(0.001)
    np.testing.assert_array_equal(second.q, reached)
    np.testing.assert_array_equal(second.tau, 4.0)
    np.testing.assert_array_equal(second.tau_mean, 3.0)
    # The torque of the first tick is what moved the robot between the two.
    acceleration = (second.v - first.v) / robot.dt
    expected = pin.aba(model, model.createData(), q, v, np.full(7, 2.0))
    np.testing.assert_allclose(acceleration, expected, rtol=0.02, atol=0.5)


def test_substeps_and_integrator_agree() -> None:
    model = Robot.named("iiwa14").model
    ends = []
    for substeps in (1, 10):
        robot = SimulatedRobot(model, substeps=substeps)
        robot.reset(*_random_state(model, 2)[:2])
        for _ in range(100):
            robot.step(np.zeros(7))
        ends.append(robot.q)
    np.testing.assert_allclose(ends[0], ends[1], atol=1e-8)


def test_noise_has_its_size_and_repeats() -> None:
    tau = np.array([100.0, 0.0])
    noise = TorqueNoise(percent=2.0, newton_metres=0.5, seed=3)
    drawn = np.array([noise.measure(tau) for _ in range(20_000)])
    np.testing.assert_allclose(drawn.mean(axis=0), tau, atol=0.05)
    np.testing.assert_allclose(drawn.std(axis=0), [np.hypot(2.0, 0.5), 0.5], rtol=0.03)
    again = TorqueNoise(percent=2.0, newton_metres=0.5, seed=3)
    np.testing.assert_array_equal(drawn[0], again.measure(tau))
    clean, noisy = (SimulatedRobot(Robot.named("iiwa14").model, noise=n) for n in (None, again))
    torques = np.full(7, 10.0)
    assert (clean.step(torques).tau == torques).all()
    assert (noisy.step(torques).tau != torques).all()
    # The sensor errs, the motor does not.
    np.testing.assert_array_equal(clean.q, noisy.q)


def test_own_world_replaces_the_bare_one() -> None:
    model = Robot.named("iiwa14").model
    root = mjcf_tree(model)
    world = root.find("worldbody")
    assert world is not None
    ET.SubElement(world, "geom", name="wall", type="box", size="1 1 0.1", pos="0 0 3")
    robot = SimulatedRobot(model, mjcf=ET.tostring(root, encoding="unicode"))
    assert robot.mj_model.geom("wall").id == 0
    with pytest.raises(ModelError, match="has no joint"):
        SimulatedRobot(Robot.named("atlas").model, mjcf=ET.tostring(root, encoding="unicode"))

"""Poses, Jacobians and dynamics against Pinocchio at random states: 1e-10 relative."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest
from robots import ATLAS, EXAMPLES, IIWA14, RobotFile, parameters

import contactsense as cs

STATES = 20
TOLERANCE = 1e-10


def random_configuration(model: pin.Model, rng: np.random.Generator) -> np.ndarray:
    """Uniform within limits (two turns where unlimited); a base anywhere within metres, any orientation."""
    lower, upper = model.lowerPositionLimit.copy(), model.upperPositionLimit.copy()
    lower[~(np.abs(lower) < 1e3)] = -6.0
    upper[~(np.abs(upper) < 1e3)] = 6.0
    q = rng.uniform(lower, upper)
    for joint in list(model.joints)[1:]:
        i = joint.idx_q
        if joint.nq == 7:
            q[i : i + 3] = rng.uniform(-5.0, 5.0, 3)
            q[i + 3 : i + 7] = rng.standard_normal(4)
            q[i + 3 : i + 7] /= np.linalg.norm(q[i + 3 : i + 7])
        elif joint.nq == 2:
            angle = rng.uniform(-np.pi, np.pi)
            q[i : i + 2] = np.cos(angle), np.sin(angle)
    return q


def assert_close(ours: np.ndarray, theirs: np.ndarray, what: str) -> None:
    error = np.max(np.abs(ours - theirs)) / max(1.0, np.max(np.abs(theirs)))
    assert error < TOLERANCE, f"{what}: relative error {error:.2e}"


def compare(robot: cs.Robot, model: pin.Model, seed: int) -> None:
    rng = np.random.default_rng(seed)
    data = model.createData()
    assert (robot.nq, robot.nv) == (model.nq, model.nv)
    assert robot.joint_names == tuple(model.names)[1:]
    assert_close(robot.neutral(), pin.neutral(model), "neutral")
    bodies = [frame for frame in model.frames if frame.type == pin.FrameType.BODY]
    for _ in range(STATES):
        q = random_configuration(model, rng)
        v, a, tau_ext = rng.uniform(-2.0, 2.0, (3, model.nv))
        tau = rng.uniform(-20.0, 20.0, model.nv - 6 * robot.floating_base)
        full = np.concatenate([np.zeros(6 * robot.floating_base), tau]) + tau_ext
        mass = pin.crba(model, data, q)
        mass = np.triu(mass) + np.triu(mass, 1).T
        assert_close(robot.mass_matrix(q), mass, "mass matrix")
        assert_close(robot.inverse_dynamics(q, v, a), pin.rnea(model, data, q, v, a), "inverse dynamics")
        if np.linalg.cond(mass) < 1e8:
            ours = robot.forward_dynamics(q, v, tau, tau_ext)
            theirs = pin.aba(model, data, q, v, full)
            assert_close(ours, theirs, "forward dynamics")
        pin.forwardKinematics(model, data, q)
        pin.updateFramePlacements(model, data)
        pin.computeJointJacobians(model, data, q)
        for frame in bodies:
            index = model.getFrameId(frame.name, pin.FrameType.BODY)
            assert_close(robot.link_pose(q, frame.name), data.oMf[index].homogeneous, frame.name)
            jacobian = pin.getFrameJacobian(model, data, index, pin.LOCAL_WORLD_ALIGNED)
            assert_close(robot.jacobian(q, frame.name), jacobian, frame.name)
            offset = rng.uniform(-0.5, 0.5, 3)
            moved = jacobian.copy()
            moved[:3] -= pin.skew(offset) @ jacobian[3:]
            point = data.oMf[index].translation + offset
            assert_close(robot.jacobian(q, frame.name, point), moved, frame.name)


@pytest.mark.parametrize("file", parameters([*EXAMPLES, *ATLAS, IIWA14]))
def test_agrees_with_pinocchio(file: RobotFile) -> None:
    compare(file.robot(), file.model(), seed=1)


@pytest.mark.parametrize("name", ["iiwa14", "atlas"])
def test_packaged_robots_agree_with_pinocchio(name: str) -> None:
    from contactsense.robot import description_file

    root = pin.JointModelFreeFlyer() if name == "atlas" else None
    text = description_file(name).read_text()
    model = pin.buildModelFromXML(text, root) if root else pin.buildModelFromXML(text)
    compare(cs.Robot.named(name), model, seed=2)


def test_base_far_away_costs_no_digits() -> None:
    robot = cs.Robot.named("atlas")
    q, v = robot.neutral(), np.random.default_rng(3).uniform(-1, 1, robot.nv)
    near = robot.inverse_dynamics(q, v, v)
    q[:3] = 1e4, -2e4, 3e3
    assert_close(robot.inverse_dynamics(q, v, v), near, "far base")

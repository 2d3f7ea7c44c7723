"""Robots cross processes: a copy by pickle gives the same answers to the last bit."""

import copy
import multiprocessing
import pickle

import numpy as np
import pytest
from robots import EXAMPLES
from urdf_text import ARM, write

import contactsense as cs


def answers(robot):
    """Bits of what a robot answers."""
    q = robot.random_configuration(7)
    v, a = np.random.default_rng(7).standard_normal((2, robot.nv))
    parts = [
        robot.mass_matrix(q),
        robot.inverse_dynamics(q, v, a),
        robot.forward_dynamics(q, v, a[-robot.nv :]),
    ]
    for name in robot.link_names:
        surface = robot.surface(name)
        parts += [robot.link_pose(q, name), surface.vertices, surface.sample(20, seed=1).points]
    return [part.tobytes() for part in parts], robot.warnings, robot.link_names


def robots(tmp_path):
    arm = cs.Robot.from_urdf(write(tmp_path, ARM), floating_base=True, locked_joints={"elbow": 0.3})
    yield arm
    yield arm.with_payload("tool", 1.5, [0, 0, 0.1]).with_payload("tool", 0.5, [0, 0.1, 0], 0.1 * np.eye(3))
    yield cs.Robot.from_pinocchio(arm.model, arm.geometry_model)
    yield cs.Robot.named("atlas")


def test_pickle_gives_the_same_answers(tmp_path):
    for robot in robots(tmp_path):
        again = pickle.loads(pickle.dumps(robot))
        assert type(again) is cs.Robot
        assert answers(again) == answers(robot)
        assert again.model == robot.model
        assert again.geometry_model.ngeoms == robot.geometry_model.ngeoms
        assert copy.copy(robot) is robot
        assert copy.deepcopy({"robot": robot})["robot"] is robot


@pytest.mark.parametrize(
    "file", [entry for entry in EXAMPLES if entry.name in ("panda", "talos")], ids=lambda f: f.name
)
def test_meshes_cross_too(file):
    robot = file.robot()
    assert answers(pickle.loads(pickle.dumps(robot))) == answers(robot)


@pytest.mark.parametrize("method", ["spawn", "fork"])
def test_robot_crosses_a_process_pool(method, tmp_path):
    if method not in multiprocessing.get_all_start_methods():
        pytest.skip(f"this system does not {method} processes")
    robot = next(robots(tmp_path))
    with multiprocessing.get_context(method).Pool(1) as pool:
        assert pool.apply(answers, (robot,)) == answers(robot)

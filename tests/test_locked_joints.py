"""Locked joints leave the model; their links stay where the joint holds them."""

import math
from importlib import resources

import numpy as np
import pinocchio as pin
import pytest
from described import describe_urdf
from urdf_text import ARM, joint, link, robot, write

import contactsense as cs
from contactsense.errors import InputError
from contactsense.robot import description_file


@pytest.fixture
def arm(tmp_path):
    return write(tmp_path, ARM)


def world_poses(description):
    """Link poses with every remaining joint at neutral."""
    joints = [np.eye(4)]
    for each in description.joints:
        joints.append(joints[each.parent] @ each.placement)
    return {link.name: joints[link.joint] @ link.placement for link in description.links}


def rotated(axis, angle):
    return pin.SE3(pin.AngleAxis(angle, np.array(axis)).matrix(), np.zeros(3))


@pytest.mark.parametrize("floating_base", [False, True])
def test_links_behind_locked_joints_stay(arm, floating_base):
    free = describe_urdf(arm, floating_base=floating_base)
    locked = describe_urdf(arm, floating_base=floating_base, locked_joints={"elbow": 0.7, "rail": 0.2})
    assert [link.name for link in locked.links] == [link.name for link in free.links]
    assert [joint.name for joint in locked.joints if joint.kind != "free_flyer"] == ["shoulder"]
    assert sum(joint.mass for joint in locked.joints) == pytest.approx(
        sum(joint.mass for joint in free.joints)
    )
    elbow, rail = free.joints[-2:]
    lower = pin.SE3(world_poses(free)["upper"]) * pin.SE3(elbow.placement) * rotated(elbow.axis, 0.7)
    slide = lower * pin.SE3(rail.placement) * pin.SE3(np.eye(3), 0.2 * rail.axis)
    np.testing.assert_allclose(world_poses(locked)["lower"], lower.homogeneous, atol=1e-12)
    np.testing.assert_allclose(world_poses(locked)["slide"], slide.homogeneous, atol=1e-12)


def test_names_alone_are_held_at_neutral(arm):
    by_name = describe_urdf(arm, locked_joints=["elbow"])
    by_position = describe_urdf(arm, locked_joints={"elbow": 0})
    assert [joint.name for joint in by_name.joints] == ["shoulder", "rail"]
    for name, pose in world_poses(by_name).items():
        np.testing.assert_array_equal(pose, world_poses(by_position)[name])


def test_all_joints_may_be_locked(arm):
    description = describe_urdf(arm, locked_joints=("shoulder", "elbow", "rail"))
    assert description.joints == []
    assert {link.joint for link in description.links} == {0}


def nothing(rows):
    return np.zeros((rows, 0))


SENSOR = cs.ForceTorqueSensor("wrist", "iiwa_link_4")


@pytest.mark.parametrize(
    "use",
    [
        lambda robot: cs.ContactMonitor(robot, dt=0.01),
        lambda robot: cs.ContactMonitor(robot, dt=0.01, sensors=[SENSOR]),
        lambda robot: cs.MomentumObserver(robot, dt=0.01),
        lambda robot: cs.Calibration.of_description(robot),
        lambda robot: cs.calibrate(robot, cs.Log(0.01 * np.arange(2000), *[nothing(2000)] * 3)),
        lambda robot: cs.diagnose(robot, nothing(2000), nothing(2000), nothing(2000)),
        lambda robot: cs.exciting_motion(robot, 5.0),
        lambda robot: cs.ContactIsolator(robot),
        lambda robot: cs.ContactMap(robot),
        lambda robot: cs.ContactParticleFilter(robot),
        lambda robot: cs.StaticObstacleSampler(robot),
        lambda robot: cs.ContactMemory(robot),
        lambda robot: cs.ContactClassifier(robot, dt=0.01),
        lambda robot: cs.Reaction(robot, dt=0.01),
        lambda robot: cs.identify_tool(robot, SENSOR, nothing(5), np.zeros((5, 6))),
    ],
)
def test_what_feels_with_joints_refuses_a_robot_without(use):
    with resources.as_file(description_file("iiwa14")) as path:
        names = [f"iiwa_joint_{number}" for number in range(1, 8)]
        robot = cs.Robot.from_urdf(path, locked_joints=names)
    assert robot.nv == 0
    with pytest.raises(cs.InputError, match=r"^robot: .*(no|a) (joint|link) that moves"):
        use(robot)


def test_a_base_that_floats_is_enough_to_feel(arm):
    robot = cs.Robot.from_urdf(arm, floating_base=True, locked_joints=["shoulder", "elbow", "rail"])
    monitor = cs.ContactMonitor(robot, dt=0.01)
    for _ in range(10):
        report = monitor.update(robot.neutral(), np.zeros(6), [])
    assert report.collision  # what holds it against gravity


def test_position_outside_the_limits_is_warned_of(arm):
    assert describe_urdf(arm, locked_joints={"shoulder": 1.9}).warnings == []
    assert describe_urdf(arm, locked_joints={"shoulder": 2.1}).warnings == [
        "These joints are locked outside their limits: 'shoulder'"
    ]


@pytest.mark.parametrize(
    "locked", ["elbow", 3, ["wrist"], {"wrist": 0.0}, ["flange"], [0], {"root_joint": 0.0}, [["elbow"]]]
)
def test_bad_names_list_the_valid_ones(arm, locked):
    with pytest.raises(InputError, match="valid names: 'shoulder', 'elbow', 'rail'"):
        describe_urdf(arm, floating_base=True, locked_joints=locked)


@pytest.mark.parametrize("position", [math.nan, math.inf, None, "0.1", True, [0.1, 0.2], 10**400])
def test_bad_position_names_the_joint(arm, position):
    with pytest.raises(InputError, match="'elbow' must be a finite number"):
        describe_urdf(arm, locked_joints={"elbow": position})


def test_a_joint_may_share_its_links_name(tmp_path):
    text = robot(
        link("base"),
        link("wrist"),
        link("tool"),
        joint("wrist", "base", "wrist"),
        joint("tool", "wrist", "tool"),
    )
    description = describe_urdf(write(tmp_path, text), locked_joints=["wrist"])
    assert [joint.name for joint in description.joints] == ["tool"]
    assert [link.name for link in description.links] == ["base", "wrist", "tool"]

"""Which columns and topics are taken for the pose and velocity of a floating base."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
from humanoid_logs import POSE, TWIST, assert_same_motion, columns, humanoid, swaying
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from log_files import arm, pushed, write_csv

import contactsense as cs

pytest.importorskip("rosbags")
pytest.importorskip("mcap")

from bag_files import write_mcap
from humanoid_bags import bag
from ros_messages import Writer

BY_FIELD = [*(f"position_{axis}" for axis in "xyz"), *(f"orientation_{axis}" for axis in "xyzw")]
ARRAYS = [*(f"base_pos[{k}]" for k in range(3)), *(f"base_quat[{k}]" for k in (1, 2, 3, 0))]


@pytest.mark.parametrize(
    ("pose", "twist", "given"),
    [
        (tuple(f"pelvis_{name}" for name in BY_FIELD), (), {}),
        (tuple(f"pose.{name.replace('_', '.')}" for name in BY_FIELD), TWIST, {}),
        (("x", "y", "z", "qx", "qy", "qz", "qw"), ("vx", "vy", "vz", "wx", "wy", "wz"), {}),
        (tuple(f"mocap_{k}" for k in range(7)), (), {"base_pose": "mocap_*"}),
        (tuple("abcdefg"), tuple("hijklm"), {"base_pose": list("abcdefg"), "base_twist": list("hijklm")}),
        (tuple(ARRAYS), (), {"base_pose": ARRAYS}),
        (
            POSE,
            tuple(f"base_lin_vel_{it}" for it in "xyz") + tuple(f"base_ang_vel_{it}" for it in "xyz"),
            {},
        ),
    ],
)  # fmt: skip
def test_names_of_columns(
    tmp_path: Path, pose: tuple[str, ...], twist: tuple[str, ...], given: dict[str, object]
) -> None:
    file = write_csv(tmp_path / "a.csv", columns(pose, twist))
    read = cs.read_log(file, humanoid(), columns=given)
    inner = slice(10, -10)
    assert_same_motion(read[inner], swaying()[inner], v=1e-12 if twist else 2e-4)


def test_what_fits_twice_or_not_at_all_is_named(tmp_path: Path) -> None:
    writer, log = Writer("cdr"), swaying()
    with pytest.raises(cs.InputError, match="nothing says where the base is: nav_msgs/Odometry"):
        cs.read_log(bag(tmp_path, []), humanoid())
    given = [writer.pose("/table", time, q) for time, q in zip(log.time, log.q, strict=True)]
    with pytest.raises(cs.InputError, match=r"columns={'base_pose'.*; there are other poses: .* of /table"):
        cs.read_log(bag(tmp_path, given), humanoid())
    read = cs.read_log(bag(tmp_path, given), humanoid(), columns={"base_pose": "/table"})
    np.testing.assert_array_equal(read.q[:, :3], log.q[:, :3])
    for topic in ("/odom", "/ground_truth"):
        rows = zip(log.time, log.q, log.v, strict=True)
        given += [writer.odometry(topic, time, q, v, "pelvis") for time, q, v in rows]
    with pytest.raises(cs.InputError, match=r"several fit as the pose of the base: .*/odom.*/ground_truth"):
        cs.read_log(bag(tmp_path, given), humanoid())
    assert_same_motion(
        cs.read_log(bag(tmp_path, given), humanoid(), columns={"base_pose": "/ground_truth"}), log
    )
    with pytest.raises(cs.InputError, match=r"columns: base_pose: nothing that '/nosuch' names has the 7"):
        cs.read_log(bag(tmp_path, given), humanoid(), columns={"base_pose": "/nosuch"})


def test_a_component_that_is_there_twice_is_named(tmp_path: Path) -> None:
    found = columns()
    found["base_px"], found["base_vel_x"] = found["base_x"] + 1.0, found["base_vx"] + 1.0
    file = write_csv(tmp_path / "a.csv", found)
    with pytest.raises(cs.InputError, match=r"several fit as the pose of the base: 'base_x'.*'base_px'"):
        cs.read_log(file, humanoid())
    with pytest.raises(
        cs.InputError, match=r"several fit as the velocity of the base: 'base_vx'.*'base_vel_x'"
    ):
        cs.read_log(file, humanoid(), columns={"base_pose": list(POSE)})
    read = cs.read_log(file, humanoid(), columns={"base_pose": list(POSE), "base_twist": list(TWIST)})
    file = write_csv(tmp_path / "b.csv", {**columns(), "base_py": found["base_y"]})
    with pytest.raises(cs.InputError, match=r"base_x, base_y, base_z.*; base_x, base_py, base_z"):
        cs.read_log(file, humanoid())
    assert_same_motion(read, swaying())


def test_an_external_torque_says_nothing_of_the_base(tmp_path: Path) -> None:
    found = {name.replace("effort", "tau_ext"): rows for name, rows in columns().items()}
    with pytest.raises(
        cs.InputError, match="has nothing of the floating base; torques of the motors are needed"
    ):
        cs.read_log(write_csv(tmp_path / "a.csv", found), humanoid())
    read = cs.read_log(write_csv(tmp_path / "a.csv", {**columns(), **found}), humanoid())
    assert read.external_torque is None
    assert read.reading is not None
    assert "external_torque" in read.reading.left_out[0]


def test_a_fixed_base_lists_odometry_as_left_out(tmp_path: Path) -> None:
    writer, log = Writer("cdr"), pushed()[:50]
    given = writer.joints(log, tuple(arm().actuated_joint_names), 7)
    given += [writer.odometry("/odom", time, np.eye(7)[6], np.zeros(6), "base") for time in log.time]
    read = cs.read_log(write_mcap(tmp_path / "a.mcap", given), arm())
    assert read.reading is not None
    assert read.reading.left_out == ("/odom (nav_msgs/msg/Odometry): no measurements of joints or forces",)


WORD = st.sampled_from(
    ["base", "x", "y", "z", "w", "q", "qx", "vx", "pose", "position", "rot", "hand", "cmd", "0"]
)


@settings(max_examples=80, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(extra=st.lists(st.lists(WORD, min_size=1, max_size=4).map("_".join), max_size=14))
def test_columns_beside_those_of_the_base_are_left_alone(tmp_path: Path, extra: list[str]) -> None:
    own = {name: rows[:12] for name, rows in columns().items()}
    others = {name: -1.0 - np.arange(12.0) for name in extra if name not in own}
    file = write_csv(tmp_path / "a.csv", {**others, **own})
    try:
        log = cs.read_log(file, humanoid())
    except cs.InputError:
        if extra:
            return
        raise
    assert_same_motion(log, swaying()[:12])


def test_the_joint_of_the_base_may_be_anywhere(tmp_path: Path) -> None:
    body = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
    (tmp_path / "a.urdf").write_text(
        f"""<robot name="r"><link name="world"/><link name="hull">{body}</link><link name="arm">{body}</link>
        <joint name="f" type="floating"><parent link="world"/><child link="hull"/>
          <origin xyz="0.1 0.2 1.0" rpy="0.3 -0.2 0.5"/></joint>
        <joint name="j" type="continuous"><parent link="hull"/><child link="arm"/><axis xyz="0 0 1"/></joint>
        </robot>"""
    )
    robot = cs.Robot.from_urdf(tmp_path / "a.urdf")
    log = swaying()
    found = {"time": log.time, **{f"{name}_j": 0.1 * log.time for name in ("pos", "vel", "effort")}}
    found |= {name.replace("base", "hull"): log.q[:, k] for k, name in enumerate(POSE)}
    read = cs.read_log(write_csv(tmp_path / "a.csv", found), robot)
    for row in (0, 100, 249):
        pose = pin.SE3(robot.link_pose(read.q[row], "hull"))
        gap = pin.log(pose.inverse() * pin.XYZQUATToSE3(log.q[row, :7])).vector
        np.testing.assert_allclose(gap, 0.0, atol=1e-12)
    np.testing.assert_allclose(read.q[:, 7:], np.column_stack([f(0.1 * log.time) for f in (np.cos, np.sin)]))
    cs.replay(read, cs.ContactMonitor(robot, dt=0.002)).to_mcap(tmp_path / "a.mcap")
    again = cs.read_log(tmp_path / "a.mcap", robot, topics=["/joint_states", "/base"])
    np.testing.assert_allclose(again.q, read.q, atol=1e-12)

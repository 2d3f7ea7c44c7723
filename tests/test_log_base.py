"""Pose and velocity of a floating base in logs: every format, other frames and rates, and what is missing."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
from humanoid_logs import DT, FEET, POSE, assert_same_motion, columns, humanoid, swaying, table
from log_files import write_csv

import contactsense as cs

pytest.importorskip("rosbags")
pytest.importorskip("mcap")

from bag_files import write_bag, write_mcap, write_sqlite
from humanoid_bags import bag, joint_messages
from ros_messages import Message, Writer


def whole(encoding: str) -> list[Message]:
    """All that a humanoid records: joints, odometry and two sensors."""
    writer, log = Writer(encoding), swaying()
    assert log.wrenches is not None
    found = joint_messages(encoding)
    for time, q, v, wrenches in zip(log.time, log.q, log.v, log.wrenches, strict=True):
        found.append(writer.odometry("/odom", time, q, v, "pelvis"))
        found += [
            writer.wrench(f"/{it.name}/wrench", time, row, it.link)
            for it, row in zip(FEET, wrenches, strict=True)
        ]
    return found


FORMATS: dict[str, Callable[[Path], Path]] = {
    "mcap": lambda folder: write_mcap(folder / "a.mcap", whole("cdr")),
    "mcap_ros1": lambda folder: write_mcap(folder / "a.mcap", whole("ros1"), "ros1"),
    "rosbag2": lambda folder: write_sqlite(folder / "a.db3", whole("cdr")),
    "rosbag1": lambda folder: write_bag(folder / "a.bag", whole("ros1")),
    "csv": lambda folder: table(folder, "csv"),
    "parquet": lambda folder: table(folder, "parquet"),
    "npz": lambda folder: table(folder, "npz"),
}


@pytest.mark.parametrize("name", FORMATS)
def test_every_format_has_the_motion_of_the_base(tmp_path: Path, name: str) -> None:
    log, expected = cs.read_log(FORMATS[name](tmp_path), humanoid(), sensors=FEET), swaying()
    assert_same_motion(log, expected)
    np.testing.assert_array_equal(log.tau, expected.tau)
    np.testing.assert_array_equal(log.wrenches, expected.wrenches)
    assert log.reading is not None
    assert log.reading.left_out == log.reading.mended == ()
    assert any(line.startswith("pose of the base from ") for line in log.reading.chosen)


def monitor(log: cs.Log) -> cs.ContactMonitor:
    return cs.ContactMonitor(
        humanoid(),
        dt=float(np.median(np.diff(log.time))),
        sensors=FEET,
        wanted_contacts=[sensor.name for sensor in FEET],
        torque_threshold=3.0,
        wrench_threshold=10.0,
    )


@pytest.mark.parametrize("name", ["mcap", "csv"])
def test_a_replay_says_what_the_live_loop_says_bit_for_bit(tmp_path: Path, name: str) -> None:
    log = cs.read_log(FORMATS[name](tmp_path), humanoid(), sensors=FEET)
    result, live = cs.replay(log, monitor(log)), monitor(log)
    steps = [None, *np.diff(log.time).tolist()]
    assert log.tau is not None
    assert log.wrenches is not None
    rows = zip(log.q, log.v, log.tau, log.wrenches, steps, strict=True)
    reports = [live.update(*row, dt=dt) for *row, dt in rows]
    np.testing.assert_array_equal([it.external_torque for it in reports], result.ticks["external_torque"])
    contacts = [contact for report in reports for contact in report.contacts]
    np.testing.assert_array_equal([it.point for it in contacts], result.contact_ticks["point"])
    (contact,) = result.contacts
    assert contact.link == "utorso"
    assert 0.2 <= contact.start < 0.22
    assert 60.0 < contact.peak_force < 100.0
    # What is written is a log itself.
    result.to_mcap(tmp_path / "out.mcap")
    own = ["/joint_states", "/base", *(f"/{sensor.name}/wrench" for sensor in FEET)]
    again = cs.read_log(tmp_path / "out.mcap", humanoid(), topics=own, sensors=FEET)
    assert_same_motion(again, log)
    np.testing.assert_array_equal(again.tau, log.tau)
    np.testing.assert_array_equal(again.wrenches, log.wrenches)


def test_without_a_twist_the_pose_is_differentiated(tmp_path: Path) -> None:
    writer, log = Writer("cdr"), swaying()
    signs = np.where(np.arange(len(log)) % 7 < 3, 1.0, -1.0)  # a quaternion and its opposite are one rotation
    given = []
    for time, q, sign in zip(log.time, log.q, signs, strict=True):
        scaled = np.concatenate([q[:3], 1.5 * sign * q[3:7]])
        given.append(writer.pose("/base/pose", time, scaled))
    read = cs.read_log(bag(tmp_path, given), humanoid())
    inner = slice(10, -10)
    assert_same_motion(read[inner], log[inner], v=2e-4)
    assert np.all(np.sum(read.q[1:, 3:7] * read.q[:-1, 3:7], axis=1) > 0.99)
    assert read.reading is not None
    assert "velocity of the base: central differences of its pose" in read.reading.chosen


@pytest.mark.parametrize("axes", ["base", "world"])
@pytest.mark.parametrize("frame", ["named", "told by the motion"])
def test_a_twist_may_be_in_axes_of_the_base_or_the_world(tmp_path: Path, axes: str, frame: str) -> None:
    writer, log = Writer("cdr"), swaying()
    name = {"base": "pelvis", "world": "map"}[axes] if frame == "named" else "somewhere"
    given = []
    for time, q, v in zip(log.time, log.q, log.v, strict=True):
        turn = pin.Quaternion(q[3:7]).matrix() if axes == "world" else np.eye(3)
        given.append(writer.pose("/base/pose", time, q))
        given.append(writer.twist("/base/twist", time, np.concatenate([turn @ v[:3], turn @ v[3:6]]), name))
    read = cs.read_log(bag(tmp_path, given), humanoid())
    assert_same_motion(read, log)
    assert read.reading is not None
    assert f"[m/s, rad/s], in axes of the {axes}" in str(read.reading)


def test_axes_of_linear_and_angular_velocity_may_differ(tmp_path: Path) -> None:
    found, log = columns(), swaying()
    world = np.array([pin.Quaternion(q[3:7]).matrix() @ v[:3] for q, v in zip(log.q, log.v, strict=True)])
    found |= {f"base_v{axis}": world[:, k] for k, axis in enumerate("xyz")}  # as MuJoCo's qvel
    read = cs.read_log(write_csv(tmp_path / "a.csv", found), humanoid())
    assert_same_motion(read, log)
    assert "linear in axes of the world and angular in axes of the base" in str(read.reading)


def test_a_twist_that_fits_in_no_axes_is_left_out(tmp_path: Path) -> None:
    found = columns()
    found["base_vx"] = 30.0 * np.cos(40.0 * found["time"])
    read = cs.read_log(write_csv(tmp_path / "a.csv", found), humanoid())
    assert read.reading is not None
    assert "fits the differences of the pose in no axes" in read.reading.left_out[0]
    inner = slice(10, -10)
    assert_same_motion(read[inner], swaying()[inner], v=2e-4)


def test_the_pose_of_a_link_that_the_base_carries_is_moved_to_the_base(tmp_path: Path) -> None:
    urdf = tmp_path / "a.urdf"
    body = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
    urdf.write_text(
        f"""<robot name="r"><link name="root">{body}</link><link name="imu"/><link name="arm">{body}</link>
        <joint name="f" type="fixed"><parent link="root"/><child link="imu"/>
          <origin xyz="0.1 -0.2 0.3" rpy="0.4 0.5 -0.6"/></joint>
        <joint name="j" type="revolute"><parent link="root"/><child link="arm"/><axis xyz="0 0 1"/>
          <limit effort="1" velocity="1" lower="-1" upper="1"/></joint></robot>"""
    )
    robot = cs.Robot.from_urdf(urdf, floating_base=True)
    writer, log = Writer("cdr"), swaying()
    place = pin.SE3(robot.link_pose(robot.neutral(), "imu"))
    data, frame = robot.model.createData(), robot.model.getFrameId("imu")
    q, v = log.q[:, :8], log.v[:, :7]
    given = writer.joints(cs.Log(log.time, q, v, v[:, 6:]), ("j",), 1)
    for time, row, speed in zip(log.time, q, v, strict=True):
        pose = pin.SE3ToXYZQUAT(pin.XYZQUATToSE3(row[:7]) * place)
        pin.forwardKinematics(robot.model, data, row, speed)
        twist = pin.getFrameVelocity(robot.model, data, frame, pin.LOCAL).vector
        given.append(writer.odometry("/odom", time, pose, twist, "imu"))
        given.append(writer.imu("/imu", time, pose[3:], twist[3:], "imu"))
    read = cs.read_log(write_mcap(tmp_path / "a.mcap", given), robot)
    assert read.reading is not None
    assert "which is that of 'imu', moved to the base" in str(read.reading)
    assert read.reading.left_out == ("/imu (sensor_msgs/msg/Imu): the base is known without it",)
    np.testing.assert_allclose(np.abs(np.sum(read.q[:, 3:7] * q[:, 3:7], axis=1)), 1.0, atol=1e-12)
    np.testing.assert_allclose(read.q[:, :3], q[:, :3], atol=1e-12)
    np.testing.assert_allclose(read.v, v, atol=1e-12)
    only_imu = [message for message in given if message[0] != "/odom"]
    turned = cs.read_log(write_mcap(tmp_path / "b.mcap", only_imu), robot)
    np.testing.assert_allclose(np.abs(np.sum(turned.q[:, 3:7] * q[:, 3:7], axis=1)), 1.0, atol=1e-12)
    np.testing.assert_allclose(turned.v[:, 3:], v[:, 3:], atol=1e-12)
    assert np.all(turned.q[:, :3] == 0.0)
    assert np.all(turned.v[:, :3] == 0.0)


def test_an_imu_gives_rotation_and_says_what_is_missing(tmp_path: Path) -> None:
    writer, log = Writer("cdr"), swaying()
    rows = zip(log.time, log.q, log.v, strict=True)
    given = [writer.imu("/imu/data", time, q[3:7], v[3:6], "imu_link") for time, q, v in rows]
    read = cs.read_log(bag(tmp_path, given), humanoid())
    expected_q, expected_v = log.q.copy(), log.v.copy()
    expected_q[:, :3], expected_v[:, :3] = 0.0, 0.0
    assert_same_motion(read, cs.Log(log.time, expected_q, expected_v, log.tau))
    assert "position and linear velocity of the base are zero" in str(read.reading)
    given += [writer.pose("/mocap/7", time, q) for time, q in zip(log.time, log.q, strict=True)]
    read = cs.read_log(bag(tmp_path, given), humanoid())
    assert read.reading is not None
    assert read.reading.left_out == (
        "/mocap/7 (geometry_msgs/msg/PoseStamped): not named as that of the base (base_pose, base_twist)",
    )
    # One that does not know how it is turned says so.
    rows = zip(log.time, log.q, log.v, strict=True)
    given = [writer.imu("/imu/data", time, q[3:7], v[3:6], "imu_link", -1.0) for time, q, v in rows]
    with pytest.raises(cs.InputError, match="nothing says where the base is"):
        cs.read_log(bag(tmp_path, given), humanoid())
    # One that moves against the base does not say how the base is turned.
    rows = zip(log.time, log.q, log.v, strict=True)
    given = [writer.imu("/imu/data", time, q[3:7], v[3:6], "utorso") for time, q, v in rows]
    with pytest.raises(cs.InputError, match="nothing says where the base is"):
        cs.read_log(bag(tmp_path, given), humanoid())


def test_other_rates_hold_the_last_pose_and_its_own_velocity(tmp_path: Path) -> None:
    writer, log = Writer("cdr"), swaying()
    stamped = np.arange(20, len(log), 5)
    given = [writer.pose("/base_pose", log.time[row], log.q[row]) for row in stamped]
    read = cs.read_log(bag(tmp_path, given), humanoid())
    held = stamped[np.searchsorted(stamped, np.arange(20, len(log)), side="right") - 1]
    np.testing.assert_allclose(read.q[:, :7], log.q[held, :7], rtol=0.0, atol=1e-15)
    np.testing.assert_allclose(read.v[10:-10, :6], log.v[held[10:-10], :6], atol=1e-3)
    np.testing.assert_allclose(read.time, log.time[20:], atol=1e-6)


def test_rotations_are_interpolated_on_the_shortest_arc(tmp_path: Path) -> None:
    found = columns()
    coarse = {name: rows[::10] for name, rows in found.items()}
    for name in POSE[3:]:
        coarse[name] = np.where(np.arange(25) % 2 == 0, 1.0, -1.0) * coarse[name]
    read = cs.read_log(write_csv(tmp_path / "a.csv", coarse), humanoid(), rate=1.0 / DT)
    np.testing.assert_allclose(np.linalg.norm(read.q[:, 3:7], axis=1), 1.0, atol=1e-12)
    np.testing.assert_allclose(
        np.abs(np.sum(read.q[:, 3:7] * swaying().q[:241, 3:7], axis=1)), 1.0, atol=1e-8
    )
    np.testing.assert_allclose(
        read.q[::10], swaying().q[:241:10] * np.sign(read.q[::10] * swaying().q[:241:10] + 1e-300), atol=1e-9
    )


def test_quaternions_of_length_zero_and_missing_values_are_counted(tmp_path: Path) -> None:
    found = columns()
    for name in POSE[3:]:
        found[name] = found[name].copy()
        found[name][[30, 31, 50]] = 0.0
    found["base_x"] = found["base_x"].copy()
    found["base_x"][[70, 71]] = np.nan
    read = cs.read_log(write_csv(tmp_path / "a.csv", found), humanoid())
    assert read.reading is not None
    assert read.reading.mended == (
        "3 quaternions of the base of length zero left out",
        "2 rows without pose of the base; the last one before is kept",
    )
    assert len(read) == len(swaying())
    np.testing.assert_allclose(read.q[[30, 31, 50, 70]][:, 3:7], swaying().q[[29, 29, 49, 69]][:, 3:7])

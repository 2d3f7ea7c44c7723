"""The bridge as a node of `rclpy`, with stand-ins for it and for the messages of ROS 2."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

pytest.importorskip("rosbags")
pytest.importorskip("typer")
from bridge_arm import CONFIGURATION, NAMES, START, STEP, ZERO, Q, efforts, is_the_push
from ros2_library import Message, Node, class_of, install

from contactsense.bridge.values import LinkWrench
from contactsense.cli.app import run

TOPICS = {
    "/contactsense/external_torque",
    "/contactsense/contacts",
    "/contactsense/contacts_not_located",
    "/contactsense/markers",
    "/diagnostics",
}
Spin = Callable[[Node], None]


class Ros:
    """What a test does while the node spins, and the modules of ROS 2."""

    def __init__(self) -> None:
        self.spin: Spin = lambda node: None
        self.modules: dict[str, ModuleType] = install(lambda node: self.spin(node))


@pytest.fixture
def ros(monkeypatch: pytest.MonkeyPatch) -> Ros:
    found = Ros()
    for name, module in found.modules.items():
        monkeypatch.setitem(sys.modules, name, module)
    Node.made.clear()
    return found


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "bridge.yaml"
    path.write_text(CONFIGURATION, encoding="utf-8")
    return path


def header(stamp: int) -> Message:
    seconds, rest = divmod(stamp, 10**9)
    time = class_of("builtin_interfaces/msg/Time")(sec=seconds, nanosec=rest)
    return class_of("std_msgs/msg/Header")(stamp=time, frame_id="")


def state(tick: int, effort: np.ndarray, names: tuple[str, ...] = NAMES) -> Message:
    rows = {"position": Q, "velocity": ZERO, "effort": effort}
    lists = {name: row.tolist() for name, row in rows.items()}
    return class_of("sensor_msgs/msg/JointState")(
        header=header(START + STEP * tick), name=list(names), **lists
    )


def push(node: Node) -> None:
    for tick, row in enumerate(efforts(800, range(200, 600))):
        node.send("/joint_states", state(tick, row))
    for _, callback in node.timers:
        callback()


def test_a_push_is_published_as_messages_of_ros(
    ros: Ros, file: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    ros.spin = push
    assert run(["bridge", str(file), "--transport", "ros2"]) == 0
    (node,) = Node.made
    assert (node.name, set(node.publishers)) == ("contactsense", TOPICS)
    torques = node.on("/contactsense/external_torque")
    assert len(torques) == 800
    assert tuple(torques[7].name) == NAMES
    assert (torques[7].header.stamp.sec, torques[7].header.stamp.nanosec) == (START // 10**9, 7 * STEP)
    wrench = [it for it in node.on("/contactsense/contacts") if it.header.stamp.nanosec < 600 * STEP][-1]
    parts = [getattr(part, axis) for part in (wrench.wrench.force, wrench.wrench.torque) for axis in "xyz"]
    assert is_the_push(LinkWrench(0, wrench.header.frame_id, np.array(parts)))
    arrays = node.on("/contactsense/markers")
    assert {it.ns for array in arrays for it in array.markers} == {"point", "force", "text"}
    assert all(it.action == 2 for it in arrays[-1].markers)
    (diagnostics,) = node.on("/diagnostics")
    assert {it.key: it.value for it in diagnostics.status[0].values}["contacts"] == "1"
    assert node.is_destroyed
    assert ros.modules["rclpy"].contexts == ["init", "shutdown"]
    assert capsys.readouterr().out == "800 joint states, 800 taken in, 0 refused, 0 lost; 1 contacts\n"


def test_joint_states_and_sensors_have_the_qos_of_sensors(ros: Ros, file: Path) -> None:
    file.write_text(
        f"{CONFIGURATION}sensors: {{wrist: {{link: iiwa_link_7, topic: /w}}}}\n", encoding="utf-8"
    )

    def spin(node: Node) -> None:
        assert {topic: it[2] for topic, it in node.subscriptions.items()} == dict.fromkeys(
            ("/joint_states", "/w"), "sensor data"
        )
        vector = class_of("geometry_msgs/msg/Vector3")
        wrench = class_of("geometry_msgs/msg/Wrench")(force=vector(x=40.0, y=0.0, z=0.0), torque=vector())
        for tick, row in enumerate(efforts(200)):
            node.send("/w", class_of("geometry_msgs/msg/WrenchStamped")(header=header(0), wrench=wrench))
            node.send("/joint_states", state(tick, row))

    ros.spin = spin
    assert run(["bridge", str(file), "--transport", "ros2"]) == 0
    found = [
        it for topic in TOPICS if topic.startswith("/contactsense/contacts") for it in Node.made[0].on(topic)
    ]
    assert found
    assert {it.header.frame_id for it in found} <= {"iiwa_link_7", "iiwa_link_ee"}


def test_messages_that_cannot_be_used_are_counted(
    ros: Ros, file: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    def spin(node: Node) -> None:
        node.send("/joint_states", class_of("sensor_msgs/msg/JointState")())
        node.send("/joint_states", state(0, np.full(7, np.nan)))
        node.send("/joint_states", state(1, np.zeros(0)))
        node.send("/joint_states", state(2, efforts(1)[0], NAMES[:3]))

    ros.spin = spin
    assert run(["bridge", str(file), "--transport", "ros2"]) == 0
    told = capsys.readouterr().out
    assert told.startswith(
        "4 joint states, 0 taken in, 3 refused (last: name: joints are missing: iiwa_joint_4"
    )


def test_ctrl_c_ends_it_with_a_summary(ros: Ros, file: Path, capsys: pytest.CaptureFixture[str]) -> None:
    def spin(node: Node) -> None:
        raise KeyboardInterrupt

    ros.spin = spin
    assert run(["bridge", str(file), "--transport", "ros2"]) == 130
    assert capsys.readouterr().out.startswith("0 joint states")
    assert Node.made[0].is_destroyed


def test_the_end_of_ros_ends_it(ros: Ros, file: Path) -> None:
    def spin(node: Node) -> None:
        raise ros.modules["rclpy.executors"].ExternalShutdownException

    ros.spin = spin
    assert run(["bridge", str(file), "--transport", "ros2"]) == 0


def test_without_ros_the_message_says_what_to_do(
    file: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(sys.modules, "rclpy", None)
    assert run(["bridge", str(file), "--transport", "ros2"]) == 2
    assert "transport: rclpy is not there; source a ROS 2 workspace first" in capsys.readouterr().err

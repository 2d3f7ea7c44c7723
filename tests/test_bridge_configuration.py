"""Configurations of a bridge are read strictly."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from bridge_arm import CONFIGURATION, ROBOT, configuration, node

import contactsense as cs
from contactsense.bridge.assemble import monitor_of, robot_of
from contactsense.bridge.configuration import Configuration, SensorTopic
from contactsense.bridge.read_configuration import configuration_of, read_configuration

ALL = """
robot: arm.urdf
package_dirs: [share, /opt/share]
geometry: collision_or_visual
locked_joints: {finger: 0.02}
calibration: arm.yaml
torque_threshold: [2.0, 1]
wrench_threshold: 3
observer_gain: 80.0
bias_time: 4.0
effort: external
torque_constants: [-1.0, 0.1]
rate: 500
sensors:
  wrist: {link: tool, topic: wrist/wrench, convention: support, wanted: true}
wrench_timeout: 0.2
joint_states: /arm/joint_states
prefix: touch
diagnostics: /arm/diagnostics
frame: base
marker_rate: 10
node: touch
domain: 7
type_hash: false
"""


def test_every_parameter_is_read() -> None:
    found = configuration_of("f", ALL, Path("/robot"))
    assert found == Configuration(
        robot="/robot/arm.urdf",
        package_dirs=(Path("/robot/share"), Path("/opt/share")),
        geometry="collision_or_visual",
        locked_joints={"finger": 0.02},
        calibration=Path("/robot/arm.yaml"),
        torque_threshold=[2.0, 1.0],
        wrench_threshold=3.0,
        observer_gain=80.0,
        bias_time=4.0,
        effort="external",
        torque_constants=[-1.0, 0.1],
        rate=500.0,
        sensors={"wrist": SensorTopic("tool", "/wrist/wrench", "support", True)},
        wrench_timeout=0.2,
        joint_states="/arm/joint_states",
        prefix="/touch",
        diagnostics="/arm/diagnostics",
        frame="base",
        marker_rate=10.0,
        node="touch",
        domain=7,
        type_hash=False,
    )
    assert found.contacts_topic == "/touch/contacts"
    # The test above names each of them.
    assert set(vars(found)) == {line.split(":")[0] for line in ALL.splitlines() if line[:1].strip()}


@pytest.mark.parametrize("name", ["contactsense", "/**"])
def test_a_parameter_file_of_ros_is_the_same(name: str) -> None:
    lines = "".join(f"    {line}\n" for line in ALL.splitlines())
    found = configuration_of("f", f"{name}:\n  ros__parameters:\n{lines}", Path("/robot"))
    assert found == configuration_of("f", ALL, Path("/robot"))


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("rate: 100", "f: rate: must be a mapping of names to values, not 100"),
        ("rate: 100\nnode: a", r"f: robot \(a text\) is missing"),
        ("robot: iiwa14\nthreshold: 2", "threshold"),
        ("robot: 3", "f: robot: must be a text"),
        ("robot: iiwa14\nrate: fast", "f: rate: must be a positive number"),
        ("robot: iiwa14\nrate: 0", "f: rate: must be a positive number"),
        ("robot: iiwa14\nrate: .nan", "f: rate: must be a positive number"),
        ("robot: iiwa14\nrate: true", "f: rate: must be a positive number"),
        ("robot: iiwa14\nrate: 10\nrate: 20", "'rate' stands twice"),
        ("robot: iiwa14\ntorque_threshold: [1, x]", "f: torque_threshold: must be a positive number"),
        ("robot: iiwa14\ntorque_threshold: []", "f: torque_threshold: must be a positive number"),
        (
            "robot: iiwa14\ntorque_constants: 0",
            "f: torque_constants: must be a finite number other than zero",
        ),
        ("robot: iiwa14\neffort: current", "f: effort must be motor or external, not 'current'"),
        ("robot: iiwa14\njoint_states: 'a b'", "f: joint_states must be a topic such as /joint_states"),
        ("robot: iiwa14\nprefix: a/*", "f: prefix must be a topic"),
        ("robot: iiwa14\nnode: a/b", "f: node must be letters"),
        ("robot: iiwa14\ndomain: 1.5", "f: domain must be a whole number from 0 to 232"),
        ("robot: iiwa14\ndomain: 233", "f: domain must be a whole number from 0 to 232"),
        ("robot: iiwa14\ntype_hash: 1", "f: type_hash: must be true or false"),
        ("robot: iiwa14\nlocked_joints: [a]", "f: locked_joints: must be a mapping"),
        ("robot: iiwa14\nsensors: {a: {link: b}}", r"f: sensors: a: topic \(a text\) is missing"),
        ("robot: iiwa14\nsensors: {a: {link: b, topic: c, x: 1}}", r"f: sensors: a: .*x"),
        (
            "robot: iiwa14\nsensors: {a: {link: b, topic: c}, d: {link: e, topic: /c}}",
            "f: sensors: each must have a topic of its own",
        ),
        ("a: {b: {robot: iiwa14}}", r"f: a: ros__parameters .* is missing"),
        ("[1]", "f: must be a mapping"),
        ("robot: [", "f: is no YAML"),
    ],
)
def test_what_is_wrong_is_named(text: str, problem: str) -> None:
    with pytest.raises(cs.InputError, match=problem):
        configuration_of("f", text, Path())


def test_a_file_that_is_not_there_is_named(tmp_path: Path) -> None:
    with pytest.raises(cs.InputError, match=r"config: cannot read .*nothing\.yaml"):
        read_configuration(tmp_path / "nothing.yaml")


def test_paths_are_relative_to_the_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "bridge.yaml").write_text("robot: robots/arm.urdf\n")
    monkeypatch.chdir(tmp_path.parent)
    found = read_configuration(f"{tmp_path.name}/bridge.yaml")
    assert found.robot == str(tmp_path / "robots" / "arm.urdf")


def test_the_monitor_is_that_of_the_configuration() -> None:
    text = (
        "observer_gain: 80\nrate: 500\nsensors: {wrist: {link: iiwa_link_7, topic: w, convention: support}}\n"
    )
    found = configuration(text)
    monitor = monitor_of(found, robot_of(found))
    assert monitor.dt == pytest.approx(0.002)
    assert np.array_equal(monitor.observer_gain, np.full(7, 80.0))
    assert np.array_equal(monitor.torque_threshold, np.full(7, 0.8))
    assert [(it.name, it.link, it.convention) for it in monitor.sensors] == [
        ("wrist", "iiwa_link_7", "support")
    ]


def test_a_threshold_for_each_joint() -> None:
    found = configuration_of("f", f"robot: iiwa14\ntorque_threshold: {[1.0] * 7}", Path())
    assert len(monitor_of(found, ROBOT).torque_threshold) == 7
    wrong = configuration_of("f", "robot: iiwa14\ntorque_threshold: [1.0, 2.0]", Path())
    with pytest.raises(cs.InputError, match="torque_threshold"):
        monitor_of(wrong, ROBOT)


def test_what_does_not_fit_the_robot_is_refused() -> None:
    with pytest.raises(cs.InputError, match="torque_constants: has 2 numbers for 7 joints"):
        node("torque_constants: [1.0, 2.0]\n")
    with pytest.raises(cs.InputError, match="nowhere"):
        node("sensors: {wrist: {link: nowhere, topic: w}}\n")
    with pytest.raises(cs.InputError, match="floating base"):
        robot_of(configuration_of("f", CONFIGURATION.replace("iiwa14", "atlas"), Path()))

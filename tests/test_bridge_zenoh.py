"""Joint states go over Zenoh to a process of `contactsense bridge`, and contacts come back."""

from __future__ import annotations

import os
import re
import signal
import sys
import time
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("zenoh")
pytest.importorskip("rosbags")
pytest.importorskip("typer")
from bridge_arm import CONFIGURATION, HELD, NAMES, START, STEP, ZERO, Q, efforts, is_the_push
from bridge_process import MESSAGES, PATIENCE, BridgeProcess, Robot, free_port, wait_until

import contactsense as cs
from contactsense.bridge.endpoints import Endpoints
from contactsense.bridge.rmw_zenoh import NO_HASH
from contactsense.bridge.values import LinkWrench
from contactsense.offline.ros_messages import JOINT_STATE

TORQUE, CONTACTS, MARKERS = (f"contactsense/{name}" for name in ("external_torque", "contacts", "markers"))
# The system may take a core away for longer than Zenoh's queues last; not each time.
ATTEMPTS = 3


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "bridge.yaml"
    path.write_text(CONFIGURATION, encoding="utf-8")
    return path


def state(tick: int, effort: np.ndarray = HELD) -> bytes:
    return MESSAGES.pack(MESSAGES.joint_state(START + STEP * tick, NAMES, Q, ZERO, effort), JOINT_STATE)


def send(robot: Robot, rows: np.ndarray, first: int = 0) -> None:
    """At 1 kHz, or what the machine allows."""
    due = time.monotonic()
    for tick, row in enumerate(rows):
        due = max(due + 1e-3, time.monotonic())
        time.sleep(max(0.0, due - time.monotonic()))
        robot.send(state(first + tick, row))


def test_a_contact_arrives(file: Path) -> None:
    with BridgeProcess(file) as bridge, Robot(bridge.address) as robot:
        assert bridge.told == f"/joint_states -> /contactsense/... at {bridge.address}; Ctrl-C ends it\n"
        robot.wait_for_the_bridge()
        send(robot, efforts(800, range(200, 600)))
        wait_until(lambda: robot.count(TORQUE) >= 790, "torques")
        # The force of the observer fades after the contact.
        wrench = [it for it in robot.messages(CONTACTS) if it.header.stamp.nanosec < 600 * STEP][-1]
        parts = [
            getattr(part, axis) for part in (wrench.wrench.force, wrench.wrench.torque) for axis in "xyz"
        ]
        assert is_the_push(LinkWrench(0, wrench.header.frame_id, np.array(parts)))
        assert wrench.header.stamp.sec == START // 10**9
        texts = {it.text for array in robot.messages(MARKERS) for it in array.markers if it.ns == "text"}
        assert any(text.startswith("iiwa_link_6, 40 N") for text in texts)
        # After the contact, all that was drawn is removed.
        assert all(it.action == 2 for it in robot.messages(MARKERS)[-1].markers)
        wait_until(lambda: robot.diagnostics()["contacts"] == "1", "diagnostics of the contact")
        # What is attached counts the messages of each topic.
        numbers = [int.from_bytes(attached[:8], "little") for _, attached in robot.received[TORQUE]]
        assert numbers[0] >= 1
        assert np.all(np.diff(numbers) >= 1)
        code, printed = bridge.interrupt()
        assert code == 130
        assert re.fullmatch(r"\d+ joint states, \d+ taken in, 0 refused, \d+ lost; 1 contacts\n", printed)


def test_nothing_is_lost_at_a_thousand_hertz(file: Path) -> None:
    ticks = 5000
    rows = efforts(ticks, range(1000, 4000))
    received = []
    with BridgeProcess(file) as bridge, Robot(bridge.address) as robot:
        robot.wait_for_the_bridge()
        for attempt in range(ATTEMPTS):
            before = robot.count(TORQUE)
            send(robot, rows, first=attempt * 10 * ticks)
            wait_until(lambda: robot.diagnostics()["rate [Hz]"] == "0.0", "the end of the joint states")
            received.append(robot.count(TORQUE) - before)
            if received[-1] == ticks:
                break
        assert received[-1] == ticks, received
        # And what came is what was sent.
        stamps = [message.header.stamp for message in robot.messages(TORQUE)[-ticks:]]
        nanoseconds = np.array([it.sec * 10**9 + it.nanosec for it in stamps])
        assert np.all(np.diff(nanoseconds) == STEP)


def test_whatever_arrives_is_counted(file: Path) -> None:
    rng = np.random.default_rng(0)
    with BridgeProcess(file) as bridge, Robot(bridge.address) as robot:
        robot.wait_for_the_bridge()
        for length in range(100):
            robot.send(rng.bytes(length))
            time.sleep(1e-3)
        wait_until(lambda: int(robot.diagnostics()["refused"]) >= 95, "refusals")
        assert "is no JointState" in robot.diagnostics()["last refused"]
        send(robot, efforts(100))
        wait_until(lambda: robot.count(TORQUE) >= 95, "torques after all")


def test_a_bridge_that_dies_does_not_hold_up_the_robot(file: Path) -> None:
    with BridgeProcess(file) as bridge, Robot(bridge.address) as robot:
        robot.wait_for_the_bridge()
        send(robot, efforts(200))
        wait_until(lambda: robot.count(TORQUE) > 0, "torques")
        bridge.kill()
        before = robot.count(TORQUE)
        begun = time.monotonic()
        send(robot, efforts(500), first=1000)  # raises nothing, and comes to its end
        assert time.monotonic() - begun < PATIENCE
        assert robot.count(TORQUE) - before < 100
        # Another one at the same address takes its place.
        with BridgeProcess(file, port=int(bridge.address.rpartition(":")[2])):
            robot.wait_for_the_bridge()
            send(robot, efforts(200), first=2000)
            wait_until(lambda: robot.count(TORQUE) > before + 100, "torques of the new bridge")


@pytest.mark.skipif(not hasattr(signal, "SIGSTOP"), reason="processes cannot be stopped")
def test_a_bridge_that_hangs_does_not_hold_up_the_robot(file: Path) -> None:
    with BridgeProcess(file) as bridge, Robot(bridge.address) as robot:
        robot.wait_for_the_bridge()
        bridge.process.send_signal(signal.SIGSTOP)
        before = robot.count(TORQUE)
        begun = time.monotonic()
        for tick in range(20_000):  # more than queues and sockets hold
            robot.send(state(tick))
        assert time.monotonic() - begun < PATIENCE
        bridge.process.send_signal(signal.SIGCONT)
        send(robot, efforts(200), first=20_000)
        wait_until(lambda: robot.count(TORQUE) > before, "torques after all")
        wait_until(lambda: int(robot.diagnostics()["lost"]) > 0, "what was lost")


def test_the_graph_of_ros_sees_it(file: Path) -> None:
    file.write_text(f"{CONFIGURATION}node: touch\n", encoding="utf-8")
    with BridgeProcess(file) as bridge, Robot(bridge.address) as robot:
        robot.wait_for_the_bridge()

        def tokens() -> list[list[str]]:
            replies = robot.session.liveliness().get("@ros2_lv/0/**")
            return sorted(str(it.ok.key_expr).split("/") for it in replies if it.ok is not None)

        found = tokens()
        assert [parts[5] for parts in found] == ["NN", "MP", "MP", "MP", "MP", "MP", "MS"]
        assert {parts[8] for parts in found} == {"touch"}
        assert len({tuple(parts[:4]) for parts in found}) == 1
        assert [parts[4] for parts in found] == [str(number) for number in range(7)]
        assert {parts[9] for parts in found[1:]} == {
            "%contactsense%external_torque",
            "%contactsense%contacts",
            "%contactsense%contacts_not_located",
            "%contactsense%markers",
            "%diagnostics",
            "%joint_states",
        }
        assert all(parts[11].startswith("RIHS01_") for parts in found[1:])
        bridge.interrupt()
        wait_until(lambda: not tokens(), "the end of the tokens")


def test_types_without_hashes_as_in_humble(file: Path) -> None:
    file.write_text(f"{CONFIGURATION}type_hash: false\n", encoding="utf-8")
    with BridgeProcess(file) as bridge, Robot(bridge.address, type_hash=NO_HASH) as robot:
        keys = []
        robot.session.declare_subscriber(f"0/contactsense/**/{NO_HASH}", lambda it: keys.append(it.key_expr))
        robot.wait_for_the_bridge()
        send(robot, efforts(100))
        wait_until(lambda: len(keys) > 0, "torques without a hash")


def test_by_default_only_this_machine_reaches_it() -> None:
    assert Endpoints().own == ["tcp/127.0.0.1:7448"]
    assert Endpoints(connect=["tcp/10.0.0.1:7447"]).own == ["tcp/127.0.0.1:0"]
    assert Endpoints(listen=["tcp/0.0.0.0:7448"]).own == ["tcp/0.0.0.0:7448"]
    settings = Endpoints().configuration()
    assert settings.get_json("listen/endpoints") == '["tcp/127.0.0.1:7448"]'
    assert settings.get_json("scouting/multicast/enabled") == "false"


@pytest.mark.skipif(sys.platform != "linux", reason="sockets are listed in /proc")
def test_it_listens_on_the_loopback_interface_only(file: Path) -> None:
    with BridgeProcess(file) as bridge, Robot(bridge.address) as robot:
        robot.wait_for_the_bridge()
        port = int(bridge.address.rpartition(":")[2])
        assert listening(bridge.process.pid) == [f"0100007F:{port:04X}"]


def listening(process: int) -> list[str]:
    """Addresses, in hexadecimal numbers, at which a process listens; and at which it waits for datagrams."""
    links = Path(f"/proc/{process}/fd").iterdir()
    own = {found[1] for link in links if (found := re.fullmatch(r"socket:\[(\d+)\]", os.readlink(link)))}
    found = []
    for table, waiting in (("tcp", "0A"), ("tcp6", "0A"), ("udp", "07"), ("udp6", "07")):
        for line in Path(f"/proc/{process}/net/{table}").read_text().splitlines()[1:]:
            fields = line.split()
            if fields[3] == waiting and fields[9] in own:
                found.append(fields[1])
    return found


def test_a_file_of_zenoh_says_the_rest(tmp_path: Path) -> None:
    path = tmp_path / "zenoh.json5"
    path.write_text('{mode: "client", connect: {endpoints: ["tls/robot:7447"]}}')
    settings = Endpoints(file=path).configuration()
    assert settings.get_json("connect/endpoints") == '["tls/robot:7447"]'
    assert settings.get_json("mode") == '"client"'
    path.write_text("{nothing: 1}")
    with pytest.raises(cs.InputError, match=r"zenoh-config: cannot use .*zenoh"):
        Endpoints(file=path).configuration()


@pytest.mark.parametrize("name", ["connect", "listen"])
def test_an_address_that_is_none_is_named(name: str) -> None:
    with pytest.raises(cs.InputError, match=f"{name}: "):
        Endpoints(**{name: ["127.0.0.1"]}).configuration()


def test_a_port_that_is_taken_is_an_error(file: Path) -> None:
    with BridgeProcess(file) as bridge:
        port = int(bridge.address.rpartition(":")[2])
        with BridgeProcess(file, port=port) as second:
            assert second.process.wait(60) == 2
            assert second.told.startswith("contactsense: zenoh: the session cannot be opened")


def test_options_of_zenoh_are_refused_elsewhere(file: Path) -> None:
    with BridgeProcess(file, "--transport", "ros2", port=free_port()) as bridge:
        assert bridge.process.wait(60) == 2
        assert bridge.told.startswith("contactsense: transport: --connect, --listen and --zenoh-config")

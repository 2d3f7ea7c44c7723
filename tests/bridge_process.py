"""A bridge as a process of its own, and a session of Zenoh beside it. All is on 127.0.0.1."""

from __future__ import annotations

import json
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import zenoh
from ctrl_c import HEARS_CTRL_C

from contactsense.bridge.endpoints import SETTINGS
from contactsense.bridge.rmw_zenoh import Attachments, key_expression
from contactsense.offline.ros_messages import DIAGNOSTICS, JOINT_STATE, MARKERS, WRENCH, Messages

MESSAGES = Messages()
KINDS = {
    "joint_states": JOINT_STATE,
    "contactsense/external_torque": JOINT_STATE,
    "contactsense/contacts": WRENCH,
    "contactsense/contacts_not_located": WRENCH,
    "contactsense/markers": MARKERS,
    "diagnostics": DIAGNOSTICS,
}
PATIENCE = 60.0  # [s]


def free_port() -> int:
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        return free.getsockname()[1]


def wait_until(holds: Callable[[], bool], what: str) -> None:
    end = time.monotonic() + PATIENCE
    while not holds():
        assert time.monotonic() < end, f"{what}: not within {PATIENCE:g} s"
        time.sleep(0.02)


class BridgeProcess:
    """`contactsense bridge` on a file, listening at a port."""

    def __init__(self, file: Path, *options: str, port: int = 0) -> None:
        self.address = f"tcp/127.0.0.1:{port or free_port()}"
        command = [
            sys.executable,
            "-c",
            HEARS_CTRL_C,
            "bridge",
            str(file),
            "--listen",
            self.address,
            *options,
        ]
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        assert self.process.stderr is not None
        self.told = self.process.stderr.readline()

    def interrupt(self) -> tuple[int, str]:
        """Ctrl-C; the exit code and what was printed."""
        self.process.send_signal(signal.SIGINT)
        printed, _ = self.process.communicate(timeout=PATIENCE)
        return self.process.returncode, printed

    def kill(self) -> None:
        """As the system ends what takes too much memory."""
        self.process.kill()
        self.process.communicate(timeout=PATIENCE)

    def __enter__(self) -> BridgeProcess:
        return self

    def __exit__(self, *_: object) -> None:
        if self.process.stdout is not None and not self.process.stdout.closed:
            self.kill()


class Robot:
    """Publishes joint states and keeps what is published about them."""

    def __init__(self, address: str, type_hash: str | None = None) -> None:
        settings = zenoh.Config()
        endpoints = {"connect/endpoints": [address], "listen/endpoints": ["tcp/127.0.0.1:0"]}
        for name, value in (SETTINGS | {key: json.dumps(it) for key, it in endpoints.items()}).items():
            settings.insert_json5(name, value)
        self.session: Any = zenoh.open(settings)
        self.received: dict[str, list[tuple[bytes, bytes]]] = {topic: [] for topic in KINDS}
        for topic in KINDS:
            if topic != "joint_states":
                self._subscribe(topic)
        own = MESSAGES.type_hash(JOINT_STATE) if type_hash is None else type_hash
        self.states = self.session.declare_publisher(
            key_expression(0, "joint_states", JOINT_STATE, own), express=True
        )
        self._attachments = Attachments("robot")

    def _subscribe(self, topic: str) -> None:
        kept = self.received[topic]

        def take(sample: Any) -> None:
            kept.append((sample.payload.to_bytes(), sample.attachment.to_bytes()))

        key = key_expression(0, topic, KINDS[topic], "*")
        self.session.declare_subscriber(key, zenoh.handlers.Callback(take, indirect=False))

    def wait_for_the_bridge(self) -> None:
        """Until both know of each other: it listens to joint states, and its diagnostics arrive."""
        seen = len(self.received["diagnostics"])
        wait_until(lambda: self.states.matching_status.matching, "a subscriber of the joint states")
        wait_until(lambda: len(self.received["diagnostics"]) > seen, "diagnostics")

    def send(self, data: bytes) -> None:
        self.states.put(data, attachment=self._attachments.next(time.time_ns()))

    def messages(self, topic: str) -> list[Any]:
        """What has arrived on a topic."""
        return [MESSAGES.unpack(data, KINDS[topic]) for data, _ in list(self.received[topic])]

    def count(self, topic: str) -> int:
        return len(self.received[topic])

    def diagnostics(self) -> dict[str, str]:
        """The newest."""
        (status,) = self.messages("diagnostics")[-1].status
        return {it.key: it.value for it in status.values}

    def __enter__(self) -> Robot:
        return self

    def __exit__(self, *_: object) -> None:
        self.session.close()

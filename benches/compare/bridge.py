"""`contactsense bridge` over Zenoh: from publishing a joint state to what a subscriber receives of it.

Publisher, bridge and subscriber are processes of their own on all cores of the machine, connected over
loopback. The peer is the same with a process in the middle that only passes joint states on.
"""

from __future__ import annotations

import signal
import socket
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import contactsense as cs
from contactsense.sim import ImperfectArm, JointMotion, random_contacts, record_imperfect

from .bridge_messages import CONTACTS, TORQUE
from .machine import all_cores
from .timing import Comparison, Pace, Timing

DT = 1e-3  # [s]
SECONDS, SHORT = 60.0, 3.0
CALIBRATION = 30.0  # [s]
CONTACTS_A_SECOND = 0.5
FORCE = (15.0, 60.0)  # [N]
DURATION = (0.3, 1.0)  # [s]
SEED = 1
MAX_LATENCY = 1000.0  # [us], median
PATIENCE = 60.0  # of starting a process [s]
FILE, CONFIGURATION = "states.npz", "bridge.yaml"


def compare(pace: Pace) -> list[Comparison]:
    """One run with the bridge, and one with an echo."""
    seconds = SECONDS if pace.rounds > 10 else SHORT
    with tempfile.TemporaryDirectory() as name, all_cores():
        folder = Path(name)
        _prepare(folder, seconds)
        command = [sys.executable, "-m", "contactsense", "bridge", str(folder / CONFIGURATION)]
        ours = _run(folder, "bridge", [*command, "--listen"])
        echo = _run(folder, "echo", [sys.executable, "-m", "benches.compare.bridge_echo"])
    task = f"bridge, iiwa14, {seconds:.0f} s at 1 kHz, {len(ours.torque):,} sent, external torque"
    arrived = np.isfinite(ours.torque) & np.isfinite(echo.torque)
    timings = [
        Timing("contactsense bridge", ours.torque[arrived]),
        Timing("zenoh, echo of the same bytes", echo.torque[arrived]),
    ]
    lost = int(np.count_nonzero(~np.isfinite(ours.torque)))
    found = [Comparison(task, timings, max_us=MAX_LATENCY, has_tail=True, lost=lost)]
    if len(ours.contacts):
        contacts = Timing("contactsense bridge", ours.contacts)
        found.append(Comparison("bridge, located contact", [contacts], max_us=MAX_LATENCY, has_tail=True))
    return found


class _Latencies:
    """What one run took.

    Attributes:
        torque: time from each joint state to its torque; NaN where none came [us].
        contacts: time from a joint state to each wrench of a contact [us].
    """

    def __init__(self, folder: Path) -> None:
        with np.load(folder / "sent.npz") as sent, np.load(folder / "received.npz") as received:
            stamps, times = sent["stamp"], sent["time"]
            rows, taken = _since(stamps, times, received[TORQUE])
            self.torque = np.full(len(stamps), np.nan)
            self.torque[rows] = taken
            _, self.contacts = _since(stamps, times, received[CONTACTS])


def _since(
    stamps: NDArray[np.int64], times: NDArray[np.int64], received: NDArray[np.int64]
) -> tuple[NDArray[np.intp], NDArray[np.float64]]:
    """The row of each of received `(n, 2)`, stamp and time [ns], and the time since it was sent [us]."""
    rows = np.searchsorted(stamps, received[:, 0])
    assert np.array_equal(stamps[rows], received[:, 0])
    return rows, 1e-3 * (received[:, 1] - times[rows])


def _prepare(folder: Path, seconds: float) -> None:
    """Joint states of an arm with the errors of a real one, its calibration, and a configuration."""
    robot = cs.Robot.named("iiwa14")
    arm = ImperfectArm.typical(robot, SEED)
    free = record_imperfect(robot, arm, _motion(robot, CALIBRATION, SEED), seed=SEED)
    cs.calibrate(robot, free.log).save(folder / "arm.yaml")
    motion = _motion(robot, seconds, SEED + 1)
    count = max(1, round(CONTACTS_A_SECOND * seconds))
    contacts = random_contacts(robot, motion, count, force=FORCE, duration=DURATION, seed=SEED)
    log = record_imperfect(robot, arm, motion, contacts, seed=SEED + 1).log
    assert log.tau is not None
    np.savez(folder / FILE, names=robot.joint_names, time=log.time, q=log.q, v=log.v, tau=log.tau)
    (folder / CONFIGURATION).write_text("robot: iiwa14\ncalibration: arm.yaml\n", encoding="utf-8")


def _motion(robot: cs.Robot, seconds: float, seed: int) -> JointMotion:
    plan = cs.exciting_motion(robot, seconds, dt=DT, seed=seed)
    return JointMotion(plan.time, plan.q, plan.v, plan.a)


def _run(folder: Path, name: str, command: Sequence[str]) -> _Latencies:
    """A run with a process in the middle, whose command gets the address that it listens at."""
    address = f"tcp/127.0.0.1:{_free_port()}"
    results = folder / name
    results.mkdir()
    helpers = [sys.executable, "-m"]
    with subprocess.Popen([*command, address], stdout=subprocess.PIPE, stderr=subprocess.PIPE) as middle:
        try:
            assert middle.stderr is not None
            middle.stderr.readline()  # it listens
            listening = [*helpers, "benches.compare.bridge_subscriber", address, str(results)]
            with subprocess.Popen(listening, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as subscriber:
                assert subscriber.stdout is not None
                subscriber.stdout.readline()  # it is connected
                sending = [*helpers, "benches.compare.bridge_publisher", address]
                subprocess.run([*sending, str(folder / FILE), str(results)], check=True)
                subscriber.communicate(timeout=PATIENCE)
        finally:
            middle.send_signal(signal.SIGINT)
            told, _ = middle.communicate(timeout=PATIENCE)
    print(name, told.decode().strip(), file=sys.stderr)
    return _Latencies(results)


def _free_port() -> int:
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port: int = free.getsockname()[1]
        return port

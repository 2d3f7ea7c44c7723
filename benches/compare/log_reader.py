"""One reader in a process: `python -m benches.compare.log_reader WHO BAG CALIBRATION ROWS CLOCK` prints JSON.

WHO is contactsense, which reads and replays the whole log, or a peer, which reads the first ROWS messages.
"""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

import contactsense as cs

from .log_bag import KIND, ROBOT


def contactsense(bag: Path, calibration: Path, rows: int, clock: Any) -> dict[str, Any]:
    """Seconds to read, and to replay without and with a calibration; checks that there is no contact."""
    robot = cs.Robot.named(ROBOT)
    known = cs.Calibration.load(calibration)
    start = clock()
    log = cs.read_log(bag, robot)
    seconds = {"read": clock() - start}
    step = float(np.median(np.diff(log.time)))
    for name, given in (("replay", None), ("replay, calibrated", known)):
        start = clock()
        result = cs.replay(log, cs.ContactMonitor(robot, dt=step, calibration=given))
        seconds[name] = clock() - start
        assert len(result.contacts) <= 1, f"{name}: {len(result.contacts)} contacts in a log without any"
        del result
    return {"seconds": seconds, "rows": len(log), "check": log.q[:rows].sum(axis=0).tolist(), "peak": peak()}


def by_rosbags(bag: Path) -> Iterator[Any]:
    """All messages."""
    from rosbags.highlevel import AnyReader

    with AnyReader([bag]) as reader:
        for connection, _, data in reader.messages():
            yield reader.deserialize(data, connection.msgtype)


def by_mcap(bag: Path) -> Iterator[Any]:
    """All messages; the format's own reader leaves it to others what is in them."""
    from mcap.reader import make_reader
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    (file,) = bag.glob("*.mcap")
    with file.open("rb") as stream:
        for _, _, message in make_reader(stream).iter_messages():
            yield store.deserialize_cdr(message.data, KIND)


PEERS = {"rosbags": by_rosbags, "mcap, rosbags": by_mcap}


def peer(who: str, bag: Path, rows: int, clock: Any) -> dict[str, Any]:
    """Seconds until the first rows are arrays."""
    start = clock()
    columns: tuple[list[Any], ...] = ([], [], [], [])
    for message in PEERS[who](bag):
        stamp = message.header.stamp
        read = (stamp.sec + 1e-9 * stamp.nanosec, message.position, message.velocity, message.effort)
        for column, value in zip(columns, read, strict=True):
            column.append(value)
        if len(columns[0]) == rows:
            break
    arrays = [np.array(column) for column in columns]
    seconds = {"read": clock() - start}
    return {"seconds": seconds, "rows": len(arrays[0]), "check": arrays[1].sum(axis=0).tolist()}


def peak() -> float | None:
    """Greatest memory of this process [MB]; None where the system does not tell."""
    status = Path("/proc/self/status")
    if not status.exists():
        return None
    (line,) = [line for line in status.read_text().splitlines() if line.startswith("VmHWM:")]
    return float(line.split()[1]) * 1024 / 1e6


def main() -> None:
    who, bag, calibration, rows, clock = sys.argv[1:]
    measure = getattr(time, clock)
    if who == "contactsense":
        told = contactsense(Path(bag), Path(calibration), int(rows), measure)
    else:
        told = peer(who, Path(bag), int(rows), measure)
    print(json.dumps(told))


if __name__ == "__main__":
    main()

"""Publishes the joint states of a file at their own pace, and writes when each was sent."""

from __future__ import annotations

import gc
import sys
import time
from pathlib import Path

import numpy as np

from contactsense.bridge.rmw_zenoh import Attachments
from contactsense.offline.ros_messages import JOINT_STATE, NANOSECONDS, Messages

from .bridge_messages import JOINTS, SETTLING, STAMP, STAMP_AT, key, session


def main(address: str, file: str, results: str) -> None:
    messages = Messages()
    with np.load(file) as rows:
        names, times = rows["names"].tolist(), rows["time"] - rows["time"][0]
        values = list(zip(rows["q"], rows["v"], rows["tau"], strict=True))
    packed = [bytearray(messages.pack(messages.joint_state(0, names, *row), JOINT_STATE)) for row in values]
    offsets = np.round(NANOSECONDS * times).astype(np.int64)
    sent = np.empty(len(packed), dtype=np.int64)
    attachments = Attachments("publisher")
    with session(connect=address) as opened:
        publisher = opened.declare_publisher(key(JOINTS, messages.type_hash(JOINT_STATE)), express=True)
        time.sleep(SETTLING)
        gc.collect()
        gc.freeze()
        base, begin = time.time_ns(), time.monotonic_ns()
        for row, (message, offset) in enumerate(zip(packed, offsets.tolist(), strict=True)):
            time.sleep(max(0, begin + offset - time.monotonic_ns()) / NANOSECONDS)
            STAMP.pack_into(message, STAMP_AT, *divmod(base + offset, NANOSECONDS))
            data, attached = bytes(message), attachments.next(base + offset)
            sent[row] = time.monotonic_ns()
            publisher.put(data, attachment=attached)
        time.sleep(SETTLING)
    np.savez(Path(results) / "sent.npz", stamp=base + offsets, time=sent)


if __name__ == "__main__":
    main(*sys.argv[1:])

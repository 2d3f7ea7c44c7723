"""Passes joint states on as they are, in place of a bridge, until it is interrupted."""

from __future__ import annotations

import contextlib
import sys
import threading

import zenoh

from contactsense.offline.ros_messages import JOINT_STATE, Messages

from .bridge_messages import JOINTS, TORQUE, key, session

WAITING = 1000  # messages, as in the bridge


def main(address: str) -> None:
    with session(listen=address) as opened:
        publisher = opened.declare_publisher(key(TORQUE, Messages().type_hash(JOINT_STATE)), express=True)
        states = opened.declare_subscriber(key(JOINTS), zenoh.handlers.RingChannel(WAITING))

        def work() -> None:
            for sample in states:
                publisher.put(sample.payload.to_bytes(), attachment=sample.attachment)

        threading.Thread(target=work, daemon=True).start()
        print("listens", file=sys.stderr, flush=True)
        with contextlib.suppress(KeyboardInterrupt):
            threading.Event().wait()
        states.undeclare()


if __name__ == "__main__":
    main(sys.argv[1])

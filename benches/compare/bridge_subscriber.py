"""Writes when each torque and contact was received, when its input ends."""

from __future__ import annotations

import gc
import sys
import time
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import zenoh

from .bridge_messages import CONTACTS, SETTLING, TORQUE, key, session, stamp_of


def main(address: str, results: str) -> None:
    received: dict[str, list[tuple[bytes, int]]] = {TORQUE: [], CONTACTS: []}

    def take(kept: list[tuple[bytes, int]], sample: Any) -> None:
        kept.append((sample.payload.to_bytes(), time.monotonic_ns()))

    with session(connect=address) as opened:
        for topic, kept in received.items():
            opened.declare_subscriber(
                key(topic), zenoh.handlers.Callback(partial(take, kept), indirect=False)
            )
        time.sleep(SETTLING)
        gc.disable()
        print("connected", flush=True)
        sys.stdin.read()
    rows = {topic: [(stamp_of(data), at) for data, at in kept] for topic, kept in received.items()}
    arrays = {topic: np.array(row, dtype=np.int64).reshape(-1, 2) for topic, row in rows.items()}
    np.savez(Path(results) / "received.npz", **arrays)


if __name__ == "__main__":
    main(*sys.argv[1:])

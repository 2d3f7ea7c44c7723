"""`read_log` and `replay` beside plain Python loops over the same file, each in a process of its own."""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from .log_bag import make_bag
from .timing import Comparison, Pace, Timing

ROUNDS = 3
PEERS = ("rosbags", "mcap, rosbags")
# Peers read so many messages at most; their time is given for each.
PEER_ROWS = 60_000
# For ten minutes at 1 kHz, 600,000 rows: 12 s for all, of which 3 s for the replay [us a row].
MAX_ALL_US, MAX_REPLAY_US = 20.0, 5.0
MAX_MEMORY = 500.0  # over the size of the file [MB]


def compare(pace: Pace) -> list[Comparison]:
    """Time of each row, and memory; a fresh process for each of a few rounds."""
    rows = pace.log_rows
    with tempfile.TemporaryDirectory() as folder:
        bag, calibration = make_bag(Path(folder), rows)
        size = sum(file.stat().st_size for file in bag.glob("*.mcap")) / 1e6
        rounds = [_round(bag, calibration, min(rows, PEER_ROWS), pace) for _ in range(ROUNDS)]
    for told in rounds:
        ours, *peers = told.values()
        assert ours["rows"] == rows
        assert all(np.allclose(peer["check"], ours["check"], rtol=1e-12) for peer in peers)

    def each(name: str, read: Callable[[dict[str, Any]], float]) -> np.ndarray:
        """Microseconds a row, one a round."""
        return np.array([1e6 * read(told[name]["seconds"]) / told[name]["rows"] for told in rounds])

    def ours_of(*parts: str) -> Timing:
        return Timing("contactsense", each("contactsense", lambda it: sum(it[part] for part in parts)))

    log = f"log, {rows:,} JointStates of MCAP"
    peers = [Timing(f"{name}, a Python loop", each(name, lambda it: it["read"])) for name in PEERS]
    calibrated = "replay, calibrated"
    replays = [
        Comparison(f"{log}: {name}", [ours_of(name)], max_us=MAX_REPLAY_US) for name in ("replay", calibrated)
    ]
    results = [
        Comparison(f"{log}: read", [ours_of("read"), *peers], max_us=MAX_ALL_US - MAX_REPLAY_US),
        *replays,
        Comparison(f"{log}: read, {calibrated}", [ours_of("read", calibrated)], max_us=MAX_ALL_US),
    ]
    peaks = [told["contactsense"]["peak"] for told in rounds]
    if None not in peaks:
        over = Timing("contactsense", np.array(peaks) - size)
        task = f"{log}: peak memory over its {size:.0f} MB"
        results.append(Comparison(task, [over], max_us=MAX_MEMORY, unit="MB"))
    return results


def _round(bag: Path, calibration: Path, rows: int, pace: Pace) -> dict[str, Any]:
    return {who: _run(who, bag, calibration, rows, pace) for who in ("contactsense", *PEERS)}


def _run(who: str, bag: Path, calibration: Path, rows: int, pace: Pace) -> Any:
    module = f"{__package__}.log_reader"
    command = [sys.executable, "-m", module, who, str(bag), str(calibration), str(rows), pace.clock.__name__]
    return json.loads(subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True).stdout)

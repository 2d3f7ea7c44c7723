"""`python -m benches.fleet`: ten logs with two workers beside five logs with one, with each engine.

Each is a run of `contactsense replay` in a process of its own, and its time is that on the wall: on a machine
with two free cores the ratio is one but for what the engine costs.
"""

from __future__ import annotations

import argparse
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from .compare.log_bag import ROBOT, make_bag

LOGS = 10
MAX_RATIO = 1.2


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m benches.fleet", description=__doc__)
    parser.add_argument("--rows", type=int, default=600_000, help="of a log; ten minutes at 1 kHz")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--engines", nargs="*", default=["local", "ray"])
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        bag, calibration = make_bag(folder, arguments.rows)
        logs = [folder / f"log{k}" for k in range(LOGS)]
        for log in logs:
            shutil.copytree(bag, log)
        print(f"{LOGS} logs of {arguments.rows:,} rows; times on the wall [s], median (least, greatest)")
        for engine in arguments.engines:
            few, many = [], []
            for _ in range(arguments.rounds):  # by turns: a noisy moment strikes both
                few.append(_seconds(logs[: LOGS // 2], calibration, folder / "found", engine, 1))
                many.append(_seconds(logs, calibration, folder / "found", engine, 2))
            ratio = float(np.median(np.array(many) / np.array(few)))
            told = f"{LOGS // 2} logs, one worker {_told(few)}; {LOGS} logs, two workers {_told(many)}"
            print(f"{engine}: {told}; ratio {ratio:.2f}, at most {MAX_RATIO}")
    return 0


def _seconds(logs: list[Path], calibration: Path, out: Path, engine: str, workers: int) -> float:
    shutil.rmtree(out, ignore_errors=True)
    command = [sys.executable, "-m", "contactsense", "replay", *map(str, logs), "--robot", ROBOT]
    command += ["--calibration", str(calibration), "--out", str(out), "--engine", engine]
    start = time.perf_counter()
    subprocess.run([*command, "--workers", str(workers)], check=True, capture_output=True)
    return time.perf_counter() - start


def _told(seconds: list[float]) -> str:
    return f"{np.median(seconds):.1f} ({min(seconds):.1f}, {max(seconds):.1f})"


if __name__ == "__main__":
    sys.exit(main())

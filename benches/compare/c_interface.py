"""The tick of a program in C beside that of one in Rust, on the torques of an imperfect arm with contacts."""

from __future__ import annotations

import os
import subprocess
import tempfile
from importlib import resources
from pathlib import Path

import numpy as np

import contactsense as cs
from contactsense import sim

from .timing import Comparison, Pace, Timing

ROOT = Path(__file__).resolve().parents[2]
CAPI = ROOT / "rust" / "capi"
DT = 1e-3  # [s]
SEED = 11
TICKS = 4000
ROUNDS, REPEATS = 10, 3
FORCE = 30.0  # [N]
MAX_RATIO = 1.1
SYSTEM = ("-lpthread", "-ldl", "-lm")  # what the standard library of Rust needs


def compare(pace: Pace) -> list[Comparison]:
    """Both programs in turns; a sample is a tick, the fastest of all rounds."""
    quick = pace.rounds < 10
    rounds, ticks = (1, 300) if quick else (ROUNDS, TICKS)
    with (
        tempfile.TemporaryDirectory() as folder,
        resources.as_file(resources.files("contactsense") / "descriptions" / "iiwa14.urdf") as urdf,
    ):
        rows, calibration = _rows(Path(folder), ticks)
        programs = {"contactsense, C": _c(Path(folder)), "contactsense, Rust": _rust()}
        arguments = [str(urdf), str(rows), str(calibration), str(REPEATS)]
        fastest: dict[str, np.ndarray] = {}
        for _ in range(rounds):
            for name, program in programs.items():
                done = subprocess.run([program, *arguments], capture_output=True, text=True, check=True)
                taken = np.array(done.stdout.split(), dtype=float)
                fastest[name] = np.fmin(fastest.get(name, taken), taken)
    timings = [Timing(name, 1e-3 * row) for name, row in fastest.items()]
    return [Comparison("tick of the C interface", timings, min_ratio=1.0 / MAX_RATIO, has_tail=True)]


def _rows(folder: Path, ticks: int) -> tuple[Path, Path]:
    """An arm that is calibrated moves, and is pushed for half of the time."""
    robot = cs.Robot.named("iiwa14")
    arm = sim.ImperfectArm.typical(robot, seed=SEED)
    plan = cs.exciting_motion(robot, 20.0, dt=DT, seed=0)
    motion = sim.JointMotion(plan.time, plan.q, plan.v, plan.a)
    free = sim.record_imperfect(robot, arm, motion, seed=SEED).log
    face = robot.surface("iiwa_link_6").closest_points([[0.1, 0.2, 0.1]])
    length = DT * ticks
    push = sim.PersonContact(
        "iiwa_link_6",
        face.points[0],
        -FORCE * face.normals[0],
        start=0.4 * length,
        duration=0.5 * length,
        rise=0.02,
    )
    moves = sim.random_moves(robot, length, dt=DT, seed=SEED)
    log = sim.record_imperfect(robot, arm, moves, [push], seed=SEED + 1).log
    np.hstack([log.q, log.v, log.tau]).tofile(folder / "rows.bin")
    cs.calibrate(robot, free).save(folder / "arm.yaml")
    return folder / "rows.bin", folder / "arm.yaml"


def _c(folder: Path) -> Path:
    subprocess.run(
        ["cargo", "build", "--release", "--quiet", "-p", "contactsense-capi"], cwd=ROOT, check=True
    )
    archive = _target() / "libcontactsense_c.a"
    program = folder / "ticks"
    sources = [str(CAPI / "tests" / "ticks.c"), "-I", str(CAPI / "include"), str(archive)]
    subprocess.run(["cc", "-std=c11", "-O2", *sources, *SYSTEM, "-o", str(program)], check=True)
    return program


def _rust() -> Path:
    command = ["cargo", "build", "--release", "--quiet", "-p", "contactsense-capi", "--example", "ticks"]
    subprocess.run(command, cwd=ROOT, check=True)
    return _target() / "examples" / "ticks"


def _target() -> Path:
    return Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "release"

"""Logs of a small simulated arm, as arrays and as files, that tests of reading and replaying share."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import contactsense as cs

DT = 0.001
Rows = NDArray[np.float64]


@cache
def arm() -> cs.Robot:
    return cs.Robot.named("iiwa14")


@cache
def pushed() -> cs.Log:
    """Two seconds of slow motion; a push of 25 N on the last link from 0.8 to 1.2 s."""
    robot, rng = arm(), np.random.default_rng(3)
    time = np.arange(2000) * DT
    start = np.array([0.3, 0.8, -0.4, -1.1, 0.5, 0.7, 0.0])
    phase = np.arange(7) + time[:, None]
    q, v, a = start + 0.1 * np.sin(phase), 0.1 * np.cos(phase), -0.1 * np.sin(phase)
    tau = np.array([robot.inverse_dynamics(*row) for row in zip(q, v, a, strict=True)])
    for row in range(800, 1200):
        pose = robot.link_pose(q[row], "iiwa_link_7")
        point = pose[:3, 3] + pose[:3, :3] @ [0.0, 0.0, 0.04]
        force = pose[:3, :3] @ [-25.0, 0.0, 0.0]
        tau[row] -= robot.jacobian(q[row], "iiwa_link_7", point)[:3].T @ force
    return cs.Log(time, q, v, tau + rng.normal(0.0, 0.05, tau.shape))


def named_columns(log: cs.Log, names: Sequence[str], words: Mapping[str, str]) -> dict[str, Rows]:
    """Columns `{word}_{name}` of each joint."""
    parts = {"position": log.q, "velocity": log.v, "torque": log.tau}
    return {
        f"{words[quantity]}_{name}": rows[:, joint]
        for quantity, rows in parts.items()
        if quantity in words and rows is not None
        for joint, name in enumerate(names)
    }


def write_csv(path: Path, columns: Mapping[str, Rows], delimiter: str = ",") -> Path:
    rows = np.column_stack(list(columns.values()))
    lines = [delimiter.join(columns), *(delimiter.join(map(repr, row)) for row in rows.tolist())]
    path.write_text("\n".join(lines) + "\n")
    return path

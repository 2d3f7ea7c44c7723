"""A humanoid that stands on two sensors while its trunk sways, as arrays, that tests of logs share."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
from log_files import named_columns, write_csv

import contactsense as cs

DT = 0.002
JOINTS = 30
FEET = (cs.ForceTorqueSensor("left_foot", "l_foot"), cs.ForceTorqueSensor("right_foot", "r_foot"))


@cache
def humanoid() -> cs.Robot:
    return cs.Robot.named("atlas")


NAMES = tuple(humanoid().actuated_joint_names)
WORDS = {"position": "pos", "velocity": "vel", "torque": "effort"}
POSE = ("base_x", "base_y", "base_z", "base_qx", "base_qy", "base_qz", "base_qw")
TWIST = ("base_vx", "base_vy", "base_vz", "base_wx", "base_wy", "base_wz")


@cache
def swaying() -> cs.Log:
    """Half a second of sway; a push of 80 N on the breast from 0.2 to 0.35 s."""
    robot = humanoid()
    time = np.arange(250) * DT
    # A turn by 100 degrees about the vertical, so that axes of the base are not those of the world.
    start = robot.configuration({}, base=[1.0, -2.0, 0.9, 0.0, 0.0, np.sin(0.87), np.cos(0.87)])
    speeds = np.array([0.1, -0.05, 0.04, 0.15, -0.1, 0.2, *np.linspace(-0.2, 0.2, JOINTS)])
    phase = 2.0 * np.pi * time
    q = np.array([robot.integrate(start, speeds * np.sin(it) / (2.0 * np.pi)) for it in phase])
    # Velocity and acceleration by differences of exact configurations, which central ones approach.
    step = 1e-4
    around = [
        np.array(
            [robot.integrate(start, speeds * np.sin(it + 2.0 * np.pi * d) / (2.0 * np.pi)) for it in phase]
        )
        for d in (-step, step)
    ]
    back, ahead = (
        np.array([pin.difference(robot.model, *row) for row in zip(*them, strict=True)]) / step
        for them in ((around[0], q), (q, around[1]))
    )
    v, a = 0.5 * (back + ahead), (ahead - back) / step
    tau, readings = [], []
    compensator = cs.LoadCompensator(robot, FEET)
    for row, now in enumerate(time):
        needed = robot.inverse_dynamics(q[row], v[row], a[row])
        if 0.2 <= now < 0.35:
            needed = needed - robot.jacobian(q[row], "utorso", _breast(q[row]))[:3].T @ _push(q[row])
        feet = np.vstack([robot.jacobian(q[row], sensor.link) for sensor in FEET])
        wrenches = np.linalg.lstsq(feet[:, :6].T, needed[:6], rcond=None)[0]
        tau.append((needed - feet.T @ wrenches)[6:])
        unloaded = compensator.update(q[row], v[row], a[row], np.zeros((2, 6)))
        turns = [robot.link_pose(q[row], sensor.link)[:3, :3] for sensor in FEET]
        loads = wrenches.reshape(2, 6) - unloaded
        readings.append(
            [
                np.concatenate([f @ turn, m @ turn])
                for f, m, turn in zip(loads[:, :3], loads[:, 3:], turns, strict=True)
            ]
        )
    return cs.Log(time, q, v, np.array(tau), wrenches=np.array(readings))


def _breast(q: np.ndarray) -> np.ndarray:
    pose = humanoid().link_pose(q, "utorso")
    hit = humanoid().surface("utorso").cast_rays([[2.0, 0.0, 0.2]], [[-1.0, 0.0, 0.0]])
    return pose[:3, 3] + pose[:3, :3] @ hit.point[0]


def _push(q: np.ndarray) -> np.ndarray:
    return humanoid().link_pose(q, "utorso")[:3, :3] @ [-80.0, 0.0, 0.0]


def columns(pose: tuple[str, ...] = POSE, twist: tuple[str, ...] = TWIST) -> dict[str, np.ndarray]:
    log = swaying()
    joints = cs.Log(log.time, log.q[:, 7:], log.v[:, 6:], log.tau)
    found = {"time": log.time, **named_columns(joints, NAMES, WORDS)}
    found |= {name: log.q[:, k] for k, name in enumerate(pose)}
    return found | {name: log.v[:, k] for k, name in enumerate(twist)}


def assert_same_motion(log: cs.Log, expected: cs.Log, q: float = 1e-12, v: float = 1e-12) -> None:
    for mine, other in ((log.q, expected.q), (log.v, expected.v)):
        assert mine.shape == other.shape
    gap = np.array([pin.difference(humanoid().model, *rows) for rows in zip(log.q, expected.q, strict=True)])
    assert np.abs(gap).max() < q
    assert np.abs(log.v - expected.v).max() < v


def table(folder: Path, kind: str) -> Path:
    log = swaying()
    assert log.wrenches is not None
    found = columns()
    for k, sensor in enumerate(FEET):
        for part, name in enumerate(("force_x", "force_y", "force_z", "torque_x", "torque_y", "torque_z")):
            found[f"{sensor.name}_{name}"] = log.wrenches[:, k, part]
    file = folder / f"a.{kind}"
    if kind == "csv":
        return write_csv(file, found)
    if kind == "npz":
        np.savez(file, **found)
    else:
        pa, writer = pytest.importorskip("pyarrow"), pytest.importorskip("pyarrow.parquet")
        writer.write_table(pa.table(found), file)
    return file

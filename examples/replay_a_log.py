"""Contacts in a log file: read, replayed, printed, and written as Parquet tables.

Requires pyarrow: pip install '.[log]'
"""

import tempfile
from pathlib import Path

import numpy as np
from pyarrow import parquet

import contactsense as cs

DT = 0.005  # [s]
robot = cs.Robot.named("iiwa14")


def write_csv(path: Path) -> None:
    """Stands in for your recorder: an arm that sways is pushed at 3 s and 5 s; bias and noise of torques."""
    rng = np.random.default_rng(0)
    time = np.arange(0.0, 7.0, DT)
    sway = 0.3 * np.ones(robot.nv)
    q = np.array([0.0, 0.5, 0.0, -1.4, 0.0, 0.9, 0.0]) + np.outer(np.sin(time), sway)
    v, a = np.outer(np.cos(time), sway), np.outer(-np.sin(time), sway)
    tau = np.array([robot.inverse_dynamics(*row) for row in zip(q, v, a, strict=True)])
    tau += rng.normal(0.0, 0.6, robot.nv) + rng.normal(0.0, 0.05, tau.shape)  # [Nm]
    face = robot.surface("iiwa_link_7").closest_points([[0.2, 0.0, 0.03]])
    for row in np.flatnonzero(((time >= 3.0) & (time < 3.4)) | ((time >= 5.0) & (time < 5.4))):
        pose = robot.link_pose(q[row], "iiwa_link_7")
        point = pose[:3, :3] @ face.points[0] + pose[:3, 3]
        force = pose[:3, :3] @ (-30.0 * face.normals[0] + [0.0, 10.0, 0.0])  # [N]
        tau[row] -= robot.jacobian(q[row], "iiwa_link_7", point)[:3].T @ force
    # Milliseconds, degrees and no velocities: units follow from the names, velocities from the positions.
    positions = [f"position_{joint}_deg" for joint in robot.joint_names]
    names = ["time_ms", *positions, *(f"effort_{joint}" for joint in robot.joint_names)]
    table = np.column_stack([1e3 * time, np.rad2deg(q), tau])
    np.savetxt(path, table, delimiter=";", fmt="%.5f", header=";".join(names), comments="")


with tempfile.TemporaryDirectory() as folder:
    write_csv(Path(folder) / "arm.csv")
    log = cs.read_log(Path(folder) / "arm.csv", robot)
    for line in log.reading.chosen:  # also: mended, left_out, damage
        print(f"read: {line}")

    monitor = cs.ContactMonitor(
        robot,
        dt=DT,
        observer_gain=30.0,  # [1/s]
        torque_threshold=0.5,  # [Nm]; better: calibration=
        bias_time_constant=1.0,  # [s] the arm must be free of contact during the first second
    )
    result = cs.replay(log, monitor)
    for contact in result.contacts:
        print(f"contact from {contact.start:.2f} to {contact.end:.2f} s: {contact.link}, ", end="")
        where = f"point {np.round(contact.point_local, 3)} m in its frame" if contact.located else "no point"
        print(f"{contact.peak_force:.0f} N, {where}")

    # What was found in every tick is in `result.ticks` and in one of the tables.
    row = np.abs(result.ticks["external_torque"]).max(axis=1).argmax()
    print(f"largest external torque at {result.ticks['time'][row]:.2f} s")
    result.to_parquet(Path(folder) / "found")
    for path in sorted((Path(folder) / "found").iterdir()):
        table = parquet.read_table(path)
        print(f"{path.name}: {table.num_rows} rows, {table.num_columns} columns")

"""Contacts in a log of joint positions, velocities and torques, with noise and a model error.

The log is computed here. Replace it with the columns of your own log.
"""

import numpy as np

import contactsense as cs

DT = 0.005  # [s]
CONTACTS = ((2.0, 2.6), (4.0, 4.5))  # [s] start, end

robot = cs.Robot.named("iiwa14")


def make_log() -> tuple[np.ndarray, ...]:
    """Time (n,) [s], q, v, tau (n, 7): an arm at rest on which a force acts twice, on link 7."""
    rng = np.random.default_rng(0)
    time = np.arange(0.0, 6.0, DT)
    q = np.tile([0.0, 0.5, 0.0, -1.4, 0.0, 0.9, 0.0], (len(time), 1))
    rest = np.zeros(robot.nv)
    pose = robot.link_pose(q[0], "iiwa_link_7")
    side = robot.surface("iiwa_link_7").closest_points([[0.2, 0.0, 0.03]])
    point = pose[:3, :3] @ side.points[0] + pose[:3, 3]
    force = pose[:3, :3] @ (-30.0 * side.normals[0] + [0.0, 10.0, 0.0])
    push = robot.jacobian(q[0], "iiwa_link_7", point)[:3].T @ force
    bias = np.array([0.3, -0.6, 0.2, 0.4, 0.1, -0.1, 0.05])  # [Nm] error of the model
    pushed = np.any([(time >= begin) & (time < end) for begin, end in CONTACTS], axis=0)
    tau = robot.inverse_dynamics(q[0], rest, rest) + bias - np.outer(pushed, push)
    return time, q, np.zeros_like(q), tau + rng.normal(0.0, 0.02, tau.shape)


time, q, v, tau = make_log()
monitor = cs.ContactMonitor(
    robot,
    dt=DT,
    observer_gain=30.0,  # [1/s]
    torque_threshold=0.1,  # [Nm] several times the noise of the external torque
    bias_time_constant=1.0,  # [s] the arm must be free of contact during the first second
)
ticks = []  # of the current contact
for row in zip(time, q, v, tau, strict=True):
    report = monitor.update(*row[1:])
    if report.collision:
        ticks.append((float(np.linalg.norm(report.external_torque)), row[0], report))
    elif ticks:
        _, _, strongest = max(ticks, key=lambda entry: entry[0])
        contact = strongest.contacts[0]
        print(f"contact from {ticks[0][1]:.2f} to {ticks[-1][1]:.2f} s: {contact.link}, ", end="")
        if contact.located:
            print(f"{np.linalg.norm(contact.force):.0f} N, point +- {1e3 * contact.point_std:.1f} mm")
        else:
            print("not located")
        ticks = []

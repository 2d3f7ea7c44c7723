"""What the measurements determine, from the true contacts: ranks, with NumPy alone (eqs. 28, 31)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from contactsense import Robot
from contactsense.sim._arrays import FloatArray

from .instruments import Method, carries, sensor_links

LEVER = 0.3  # [m], sets moments against forces
RANK_TOLERANCE = 1e-7  # of the largest singular value


def rank_deficit(robot: Robot, q: FloatArray, links: Sequence[str], method: Method = "torques") -> int:
    """Components of the wrenches on the links touched that the measurements leave open (eq. 31).

    `6 n` minus the rank of the stacked Jacobians; with sensors, of Jacobians and sensor readings.
    """
    blocks = []
    if method != "sensors":
        blocks.append(torques_per_wrench(robot, q, links))
    if method != "torques":
        blocks.append(readings_per_wrench(robot, q, links, sensor_links(method)))
    values = np.linalg.svd(np.vstack(blocks), compute_uv=False)
    return 6 * len(links) - int(np.sum(values > RANK_TOLERANCE * values[0]))


def torques_per_wrench(robot: Robot, q: FloatArray, links: Sequence[str]) -> FloatArray:
    """Stacked transposed Jacobians at the links' origins `(nv, 6 n)`; moments as forces at the lever."""
    balance = np.array([1.0] * 3 + [LEVER] * 3)
    return np.hstack([robot.jacobian(q, link).T * balance for link in links])


def readings_per_wrench(
    robot: Robot, q: FloatArray, links: Sequence[str], sensors: Sequence[str]
) -> FloatArray:
    """`(6 sensors, 6 n)`: what each sensor reads of each wrench, moments on both sides at the lever."""
    readings = np.zeros((6 * len(sensors), 6 * len(links)))
    for row, sensor in enumerate(sensors):
        origin = robot.link_pose(q, sensor)[:3, 3]
        for column, link in enumerate(links):
            if carries(robot, sensor, link):
                x, y, z = (robot.link_pose(q, link)[:3, 3] - origin) / LEVER
                block = readings[6 * row : 6 * row + 6, 6 * column : 6 * column + 6]
                block[:] = np.eye(6)
                block[3:, :3] = [[0, -z, y], [z, 0, -x], [-y, x, 0]]
    return readings

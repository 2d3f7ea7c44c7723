"""Stands in for ROS 2's Python library: an arm that is pushed after 0.5 s, for a page's node in the tests.

What the node logs and publishes is printed.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from geometry_msgs.msg import Stamp
from sensor_msgs.msg import JointState

import contactsense as cs

TICKS, PUSHED = 1000, 500  # at 1 kHz
NOISE = 0.1  # [Nm]


def init() -> None:
    """Nothing to set up."""


def try_shutdown() -> None:
    """Nothing to end."""


def spin(node: Any) -> None:
    """Sends joint states, in an order of joints that is not the robot's, and prints what was published."""
    robot, rng = cs.Robot.named("iiwa14"), np.random.default_rng(0)
    q, zero = np.array([0.0, 0.5, 0.0, -1.4, 0.0, 0.9, 0.0]), np.zeros(7)
    push = robot.jacobian(q, "iiwa_link_6", point=[0.515, 0.013, 0.605])[:3].T @ [38.0, 0.0, 13.0]
    order = rng.permutation(7)
    for tick in range(TICKS):
        tau = robot.inverse_dynamics(q, zero, zero) + rng.normal(0.0, NOISE, 7)
        tau -= push if tick >= PUSHED else 0.0
        message = JointState()
        # Every tenth message comes twice.
        message.header.stamp = Stamp(sec=100, nanosec=1_000_000 * tick)
        message.name = [robot.joint_names[k] for k in order]
        message.position, message.velocity, message.effort = q[order], zero, tau[order]
        for _ in range(2 if tick % 10 == 0 else 1):
            for callback in node.callbacks:
                callback(message)
    print(f"{len(node.published)} messages published")
    print(
        "last force",
        np.round(node.published[-1].wrench.force.values(), 0),
        node.published[-1].header.frame_id,
    )

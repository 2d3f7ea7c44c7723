"""An arm at rest that is pushed at its sixth link, as joint states."""

from __future__ import annotations

from pathlib import Path

import numpy as np

import contactsense as cs
from contactsense.bridge.configuration import Configuration
from contactsense.bridge.node import ContactNode
from contactsense.bridge.read_configuration import configuration_of
from contactsense.bridge.values import JointReading, LinkWrench, Published

LINK = "iiwa_link_6"
FORCE = np.array([38.0, 0.0, 13.0])  # in the world [N]
POINT = [0.515, 0.013, 0.605]  # in the world [m]
Q = np.array([0.0, 0.5, 0.0, -1.4, 0.0, 0.9, 0.0])
ZERO = np.zeros(7)
NOISE = 0.1  # [Nm]
STEP = 1_000_000  # [ns]
START = 1_700_000_000_000_000_000  # [ns]
CONFIGURATION = "robot: iiwa14\ntorque_threshold: 0.8\n"

ROBOT = cs.Robot.named("iiwa14")
NAMES = ROBOT.joint_names
HELD = ROBOT.inverse_dynamics(Q, ZERO, ZERO)
PUSH = ROBOT.jacobian(Q, LINK, point=POINT)[:3].T @ FORCE


def configuration(more: str = "") -> Configuration:
    return configuration_of("bridge.yaml", CONFIGURATION + more, Path())


def node(more: str = "") -> ContactNode:
    return ContactNode(configuration(more), ROBOT)


def efforts(ticks: int, pushed: range = range(0), seed: int = 0) -> np.ndarray:
    """`(ticks, 7)`, with a push in some of the ticks."""
    noise = np.random.default_rng(seed).normal(0.0, NOISE, (ticks, 7))
    return HELD + noise - np.array([[tick in pushed] for tick in range(ticks)]) * PUSH


def reading(tick: int, effort: np.ndarray = HELD, **changed) -> JointReading:
    fields = {"stamp": START + STEP * tick, "names": NAMES, "position": Q, "velocity": ZERO, "effort": effort}
    return JointReading(**fields | changed)


def run(bridge: ContactNode, rows: np.ndarray, first: int = 0) -> list[list[Published]]:
    """What is published in each tick."""
    return [bridge.take(reading(first + k, row), 1e-3 * (first + k)) for k, row in enumerate(rows)]


def on(published: list[list[Published]], topic: str) -> list:
    return [output for tick in published for name, output in tick if name == topic]


def true_wrench(link: str = LINK) -> np.ndarray:
    """The wrench of the push at the link's origin, in its axes."""
    pose = ROBOT.link_pose(Q, link)
    moment = np.cross(np.subtract(POINT, pose[:3, 3]), FORCE)
    return np.concatenate([pose[:3, :3].T @ FORCE, pose[:3, :3].T @ moment])


def is_the_push(output: LinkWrench) -> bool:
    """Whether it is near the true wrench: within 2 N, and 0.5 Nm."""
    error = output.wrench - true_wrench()
    return output.link == LINK and np.abs(error[:3]).max() < 2.0 and np.abs(error[3:]).max() < 0.5

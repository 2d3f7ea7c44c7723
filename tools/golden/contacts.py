"""Pushes on a robot whose point, force and joint torques are known."""

from __future__ import annotations

from itertools import islice
from typing import Any

import numpy as np

from .robot import GoldenRobot, Link

CONE = np.deg2rad(30.0)
FORCES = (10.0, 60.0)  # [N]
# Of the noisy torques [Nm].
NOISE = 0.03
# The least torque at the link's own joint [Nm]: what is not felt there is another question.
OWN = 0.5
# Triangles lie so far beside round shapes at most [m].
TRIANGLES = 1e-3
# Six joints determine a wrench if the least singular value of their Jacobian is this share of the greatest.
CONDITION = 1e-2
# Draws a push that is kept.
TRIES = 200


def _tilted(normal: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Uniform in the cone about the inward normal."""
    while True:
        vector = rng.standard_normal(3)
        vector /= np.linalg.norm(vector)
        if -vector @ normal > np.cos(CONE):
            return vector


def _push(robot: GoldenRobot, link: Link, rng: np.random.Generator) -> dict[str, Any] | None:
    """A random push, or nothing where a surface is in its way, or the link's own joint hardly feels it."""
    q = robot.configuration(rng)
    robot.place(q)
    shape = link.shapes[rng.integers(len(link.shapes))]
    local, normal = shape.draw(rng)
    pose = robot.pose(link)
    point, normal = pose.act(local), pose.rotation @ normal
    direction = _tilted(normal, rng)
    entries = {}
    for other in robot.links:
        passages = robot.passages(other, point, direction)
        if passages is None:
            return None
        if other is link and not (passages and abs(passages[0][0]) < TRIANGLES):
            return None
        if other is not link and any(start < TRIANGLES for start, _ in passages):
            return None
        entries[other.name] = len(passages)
    if any(abs(other.nearest(local)[0]) < 2.0 * TRIANGLES for other in link.shapes if other is not shape):
        return None
    force = rng.uniform(*FORCES) * direction
    jacobian = robot.jacobian(link, point)
    torque = jacobian[:3].T @ force
    own = robot.model.joints[link.joint]
    if np.abs(torque[own.idx_v : own.idx_v + own.nv]).max() < OWN:
        return None
    values = np.linalg.svd(jacobian, compute_uv=False)
    determined = np.sum(np.abs(jacobian).max(axis=0) > 1e-12) >= 6 and values[-1] > CONDITION * values[0]
    on_link = entries.pop(link.name)
    return {
        "link": link.name,
        "q": q,
        "point": point,
        "normal": normal,
        "force": force,
        "torque": torque,
        "noisy_torque": np.round(torque + NOISE * rng.standard_normal(torque.size), 6),
        # Whether the joints before the link determine the wrench.
        "determined": bool(determined),
        # How often the line of action enters this link, and all others.
        "entries": [on_link, sum(entries.values())],
    }


def make(robot: GoldenRobot, count: int, most: int, seed: int) -> dict[str, Any]:
    """`count` pushes on every link that moves, and `most` on a link of an arm behind six joints.

    There are fewer where a link can hardly be reached.
    """
    rng = np.random.default_rng(seed)
    rows = []
    for link in robot.links:
        if link.joint == 0:
            continue
        joints = len(robot.model.supports[link.joint]) - 1
        wanted = most if joints >= 6 else count
        tries = (_push(robot, link, rng) for _ in range(TRIES * wanted))
        rows += islice((push for push in tries if push is not None), wanted)
    return {"noise": NOISE, "contacts": rows}

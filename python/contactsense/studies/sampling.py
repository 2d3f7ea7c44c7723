"""Where and how a robot is pushed: poses, points by area, directions in a cone, lines that nothing blocks."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .. import Robot

FloatArray = NDArray[np.float64]

CONE = np.deg2rad(30.0)
FORCES = (1.0, 50.0)  # [N]
BATCHES = 40


@dataclass(frozen=True)
class Touch:
    """A true contact, world frame."""

    link: str
    q: FloatArray
    point: FloatArray  # [m]
    force: FloatArray  # [N]


def random_configuration(robot: Robot, rng: np.random.Generator) -> FloatArray:
    """A pose with every joint turned by up to half a turn, or moved by up to 0.1 m; the base anywhere."""
    q = robot.neutral()
    step = rng.uniform(-1.0, 1.0, robot.nv)
    return integrate(robot, q, step * (np.pi / 2))


def integrate(robot: Robot, q: FloatArray, step: FloatArray) -> FloatArray:
    """`q` moved by `step` `(nv,)`, joint by joint; the base's orientation by its rotation vector."""
    q, position = q.copy(), 0
    index = 0
    if robot.floating_base:
        q[:3] += step[:3]
        angle = float(np.linalg.norm(step[3:6]))
        axis = step[3:6] / max(angle, 1e-12)
        q[3:7] = [*(np.sin(angle / 2) * axis), np.cos(angle / 2)]
        position, index = 7, 6
    for kind in robot.joint_kinds[int(robot.floating_base) :]:
        if kind == "continuous":
            angle = float(np.arctan2(q[position + 1], q[position])) + step[index]
            q[position : position + 2] = np.cos(angle), np.sin(angle)
            position += 2
        else:
            q[position] += step[index] * (0.05 if kind == "prismatic" else 1.0)
            position += 1
        index += 1
    return q


def blocked(
    robot: Robot, q: FloatArray, link: str, points: FloatArray, directions: FloatArray
) -> NDArray[np.bool_]:
    """Whether the lines meet a surface before the points, coming along `directions`."""
    hit = np.zeros(len(points), dtype=bool)
    for name in robot.link_names:
        pose = robot.link_pose(q, name)
        local = (points - pose[:3, 3]) @ pose[:3, :3]
        back = -directions @ pose[:3, :3]
        hits = robot.surface(name).cast_rays(local, back)
        near = 1e-9 if name == link else -1.0  # a surface that coincides with another is neither's
        hit[hits.ray[hits.distance > near]] = True
    return hit


def tilt(directions: FloatArray, rng: np.random.Generator, cone: float = CONE) -> FloatArray:
    """Directions `(n, 3)`, each uniform in the cone of half-angle `cone` [rad] about the one given."""
    chance = rng.random((len(directions), 2))
    cos = (np.cos(cone) + (1.0 - np.cos(cone)) * chance[:, 0])[:, None]
    turn = (2 * np.pi * chance[:, 1])[:, None]
    along_x = np.abs(directions[:, :1]) >= 0.8
    other = np.cross(directions, np.where(along_x, [[0, 1.0, 0]], [[1.0, 0, 0]]))
    other /= np.linalg.norm(other, axis=1, keepdims=True)
    across = np.cos(turn) * other + np.sin(turn) * np.cross(directions, other)
    tilted: FloatArray = cos * directions + np.sqrt(1 - cos * cos) * across
    return tilted


def lines(
    robot: Robot, q: FloatArray, link: str, count: int, rng: np.random.Generator, cone: float = CONE
) -> tuple[FloatArray, FloatArray]:
    """Points `(n, 3)` and push directions `(n, 3)` on a link, world frame, free of all surfaces before them.

    `count` points are drawn uniformly by area, and those that are blocked are dropped: `n <= count`.
    """
    samples = robot.surface(link).sample(count, seed=int(rng.integers(2**63)))
    pose = robot.link_pose(q, link)
    points = samples.points @ pose[:3, :3].T + pose[:3, 3]
    directions = tilt(-samples.normals @ pose[:3, :3].T, rng, cone)
    free = ~blocked(robot, q, link, points, directions)
    return points[free], directions[free]


def touches_in_pose(
    robot: Robot, q: FloatArray, link: str, count: int, rng: np.random.Generator, cone: float = CONE
) -> list[Touch]:
    """`count` free touches of a link in one pose; fewer where it can hardly be reached."""
    found: list[Touch] = []
    for _ in range(BATCHES):
        if len(found) >= count:
            break
        points, directions = lines(robot, q, link, 2 * (count - len(found)) + 8, rng, cone)
        sizes = rng.uniform(*FORCES, len(points))[:, None]
        found += [Touch(link, q, p, f) for p, f in zip(points, directions * sizes, strict=True)]
    return found[:count]

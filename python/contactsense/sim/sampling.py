"""Random contacts: poses, points by area, directions in a cone, lines that nothing blocks."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from contactsense import Robot

from ._arrays import FloatArray

CONE = np.deg2rad(30.0)
FORCES = (1.0, 50.0)  # [N]
BATCHES = 40
TRIES, POINTS_PER_POSE = 300, 10  # of `touches`
SLIDE = 0.05  # [m/rad] what a sliding joint moves in a random pose where another would turn


@dataclass(frozen=True)
class Touch:
    """A true contact, world frame."""

    link: str
    q: FloatArray
    point: FloatArray  # [m]
    force: FloatArray  # [N]


def random_configuration(robot: Robot, rng: np.random.Generator) -> FloatArray:
    """A pose with every joint turned by up to a quarter turn, or moved by up to 8 cm, from neutral.

    A floating base is turned and moved by up to a quarter turn [rad] and 1.6 m along each of its axes.
    """
    step = rng.uniform(-1.0, 1.0, robot.nv) * (np.pi / 2)
    joints, sliding = robot.joint_kinds[int(robot.floating_base) :], np.zeros(robot.nv, dtype=bool)
    sliding[robot.nv - len(joints) :] = [kind == "prismatic" for kind in joints]
    return robot.integrate(robot.neutral(), np.where(sliding, SLIDE * step, step))


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


def touches(robot: Robot, link: str, count: int, rng: np.random.Generator) -> Iterator[Touch]:
    """Random touches of a link, their lines of action free of all surfaces before the contact.

    Fewer than `count` where the link can hardly be reached. A new pose after every few.
    """
    found = 0
    for _ in range(TRIES):
        q = random_configuration(robot, rng)
        for point, direction in zip(*lines(robot, q, link, POINTS_PER_POSE, rng), strict=True):
            yield Touch(link, q, point, direction * rng.uniform(*FORCES))
            found += 1
            if found == count:
                return

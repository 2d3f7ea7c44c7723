"""Isolation of single contacts from noisy torques: how many are located, and how many of those wrongly.

`python -m tools.figures.noisy_isolation` prints counts as JSON.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

import contactsense as cs
from contactsense.sim.sampling import lines, random_configuration
from contactsense_studies.example_robots import panda, share_folder

FloatArray = NDArray[np.float64]

SIGMA = 0.1  # of every torque, a third of the threshold [Nm]
PUSHES = 300
FORCE = (10.0, 60.0)  # [N]
# A located point is wrong if it is off by more than this and three standard deviations [m].
TOLERANCE = 0.01
# Thinner than this, nothing could push at a point [m].
LEAST_ROOM = 0.005


def _published(path: str, floating_base: bool = False) -> cs.Robot:
    share = share_folder()
    file = share / "example-robot-data" / "robots" / path
    return cs.Robot.from_urdf(file, package_dirs=share, floating_base=floating_base)


ROBOTS: dict[str, Callable[[], cs.Robot]] = {
    "iiwa14": lambda: cs.Robot.named("iiwa14"),
    "panda": panda,
    "xarm7": lambda: _published("xarm_description/urdf/xarm7.urdf"),
    "talos": lambda: _published("talos_data/robots/talos_reduced.urdf", floating_base=True),
    "g1": lambda: _published("g1_description/urdf/g1_29dof_rev_1_0.urdf", floating_base=True),
}


def count(robot: cs.Robot, rng: np.random.Generator, free: bool, pushes: int = PUSHES) -> dict[str, int]:
    """Pushes on random links in random poses, along lines that are free, or that other links may bar."""
    isolator = cs.ContactIsolator(robot, torque_threshold=3 * SIGMA)
    moving = [link for link in robot.link_names if robot.jacobian(robot.neutral(), link).any()]
    located = wrong = done = 0
    while done < pushes:
        q, link = random_configuration(robot, rng), str(rng.choice(moving))
        push = (_free_push if free else _any_push)(robot, q, link, rng)
        if push is None:
            continue
        done += 1
        point, force = push
        tau = robot.jacobian(q, link, point)[:3].T @ force + SIGMA * rng.standard_normal(robot.nv)
        for contact in isolator.isolate(q, tau).contacts:
            if contact.located:
                located += 1
                wrong += bool(np.linalg.norm(contact.point - point) > TOLERANCE + 3 * contact.point_std)
    return {"pushes": done, "located": located, "wrong": wrong}


def _free_push(
    robot: cs.Robot, q: FloatArray, link: str, rng: np.random.Generator
) -> tuple[FloatArray, FloatArray] | None:
    points, inward = lines(robot, q, link, 3, rng)
    return (points[0], inward[0] * rng.uniform(*FORCE)) if len(points) else None


def _any_push(
    robot: cs.Robot, q: FloatArray, link: str, rng: np.random.Generator
) -> tuple[FloatArray, FloatArray] | None:
    sample = robot.surface(link).sample(1, seed=int(rng.integers(2**32)))
    pose = robot.link_pose(q, link)
    point = pose[:3, :3] @ sample.points[0] + pose[:3, 3]
    inward = -pose[:3, :3] @ sample.normals[0]
    return None if is_covered(robot, q, link, point, inward) else (point, inward * rng.uniform(*FORCE))


def is_covered(robot: cs.Robot, q: FloatArray, link: str, point: FloatArray, inward: FloatArray) -> bool:
    """Whether the point lies inside another link, or there is too little room before it to push."""
    for other in robot.link_names:
        if other == link:
            continue
        pose = robot.link_pose(q, other)
        local = (point - pose[:3, 3]) @ pose[:3, :3]
        distances = robot.surface(other).cast_rays([local], [-inward @ pose[:3, :3]]).distance
        if len(distances) % 2 == 1 or (len(distances) and distances.min() < LEAST_ROOM):
            return True
    return False


def seeded(name: str, free: bool) -> np.random.Generator:
    """The random numbers of a robot."""
    return np.random.default_rng([len(name), free, 77])


def run() -> dict[str, Any]:
    """Counts by robot, along free lines and along others."""
    result: dict[str, Any] = {}
    for name, load in ROBOTS.items():
        robot = load()
        # The nested, open meshes of Talos' wrists do not tell what is inside another link.
        kinds = (True,) if name == "talos" else (True, False)
        result[name] = {"free" if free else "any": count(robot, seeded(name, free), free) for free in kinds}
    return result


if __name__ == "__main__":
    print(json.dumps(run(), indent=2))

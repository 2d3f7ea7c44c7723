"""A robot that leans on a fixed sphere and moves a little: a contact that the particle filters follow."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

import contactsense as cs

FloatArray = NDArray[np.float64]

RADIUS, STIFFNESS, FORCE = 0.05, 2000.0, 20.0  # [m], [N/m], [N]
SWAY = np.deg2rad(3.0)


class Pressed(NamedTuple):
    """One pose of the path, with the truth, world frame."""

    q: FloatArray
    tau_ext: FloatArray
    point: FloatArray


def path(robot: cs.Robot, link: str, steps: int, seed: int = 0) -> list[Pressed]:
    """A closed path of poses; at every one the sphere touches `link` with 5 N or more, without friction."""
    rng = np.random.default_rng(seed)
    for _ in range(1000):
        q = robot.neutral() + rng.uniform(-1.2, 1.2, robot.nq)
        samples, pose = robot.surface(link).sample(1, seed=int(rng.integers(2**31))), robot.link_pose(q, link)
        normal = pose[:3, :3] @ samples.normals[0]
        centre = pose[:3, :3] @ samples.points[0] + pose[:3, 3] + (RADIUS - FORCE / STIFFNESS) * normal
        sway = rng.normal(size=(2, robot.nv))
        phases = 2 * np.pi * np.arange(steps) / steps
        waves = np.stack([np.sin(phases), np.sin(2 * phases)])
        found = [_press(robot, link, q + SWAY * turn, centre) for turn in waves.T @ sway]
        pressed = [each for each in found if each is not None]
        if len(pressed) == steps:
            return pressed
    raise RuntimeError(f"no path along which a sphere stays on {link}")


def _press(robot: cs.Robot, link: str, q: FloatArray, centre: FloatArray) -> Pressed | None:
    pose = robot.link_pose(q, link)
    closest = robot.surface(link).closest_points(((centre - pose[:3, 3]) @ pose[:3, :3])[None])
    push = STIFFNESS * (RADIUS - closest.distances[0])
    point = pose[:3, :3] @ closest.points[0] + pose[:3, 3]
    force = push * (point - centre) / closest.distances[0]
    if push < 5.0 or force @ pose[:3, :3] @ closest.normals[0] > 0.0:
        return None
    return Pressed(q, robot.jacobian(q, link, point)[:3].T @ force, point)

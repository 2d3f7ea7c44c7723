"""Stand-in."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np

from ... import InputError
from ..sampling import random_configuration
from .arm import Arm
from .experiments import Experiment


def record(arm: Arm, experiment: Experiment, link: str, seed: int) -> Any:
    rng = np.random.default_rng(seed)
    robot = arm.robot
    steps = 41
    for _ in range(500):
        radius, stiffness, force = 0.05, 2000.0, 20.0
        q = random_configuration(robot, rng)
        samples, pose = robot.surface(link).sample(1, seed=int(rng.integers(2**31))), robot.link_pose(q, link)
        normal = pose[:3, :3] @ samples.normals[0]
        centre = pose[:3, :3] @ samples.points[0] + pose[:3, 3] + (radius - force / stiffness) * normal
        sway = rng.normal(size=(2, robot.nv))
        phases = 2 * np.pi * np.arange(steps) / steps
        waves = np.stack([np.sin(phases), np.sin(2 * phases)])
        qs = q + np.deg2rad(3.0) * (waves.T @ sway)
        rows = [_press(arm, link, one, centre, radius, stiffness) for one in qs]
        good = [row for row in rows if row is not None]
        if len(good) == steps:
            torque, point, normals, forces = map(np.array, zip(*good, strict=True))
            return SimpleNamespace(
                q=qs, external_torque=torque, point=point, normal=normals, force=forces, link=(link,) * steps
            )
    raise InputError("none")


def _press(arm: Arm, link: str, q: Any, centre: Any, radius: float, stiffness: float) -> Any:
    robot = arm.robot
    pose = robot.link_pose(q, link)
    closest = robot.surface(link).closest_points(((centre - pose[:3, 3]) @ pose[:3, :3])[None])
    push = stiffness * (radius - closest.distances[0])
    point = pose[:3, :3] @ closest.points[0] + pose[:3, 3]
    force = push * (point - centre) / closest.distances[0]
    torque = robot.jacobian(q, link, point)[:3].T @ force
    if push < 1.0 or np.linalg.norm(torque) < 0.5 or force @ pose[:3, :3] @ closest.normals[0] > 0.0:
        return None
    return torque, point, -force / push, force

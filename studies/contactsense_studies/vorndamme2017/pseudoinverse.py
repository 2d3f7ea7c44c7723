"""Beside the library: the paper's own steps (28), (26) and 4 in NumPy, told which links are touched."""

from __future__ import annotations

import numpy as np

from contactsense import Robot
from contactsense.sim._arrays import FloatArray

from .information import LEVER, torques_per_wrench
from .instruments import external_torque, moved_by
from .judge import Answer
from .scenes import Scene

CUTOFF = 1e-9  # of the largest singular value


def isolate(robot: Robot, scene: Scene) -> list[Answer]:
    """One answer a contact, ideal torques: least-norm wrenches, lines of action, first surface entered."""
    links = scene.links
    solved = np.linalg.pinv(torques_per_wrench(robot, scene.q, links), rcond=CUTOFF)
    wrenches = (solved @ external_torque(robot, scene)).reshape(-1, 6)
    return [
        _locate(robot, scene.q, link, wrench[:3], LEVER * wrench[3:])
        for link, wrench in zip(links, wrenches, strict=True)
    ]


def _locate(robot: Robot, q: FloatArray, link: str, force: FloatArray, moment: FloatArray) -> Answer:
    """Where the line of action enters the link, or else the first link behind it that it meets."""
    hits: list[FloatArray] = []
    if np.linalg.norm(force) > 0.0:
        along = force / np.linalg.norm(force)
        start = robot.link_pose(q, link)[:3, 3] + np.cross(force, moment) / (force @ force)
        behind = [name for name in robot.link_names if moved_by(robot, link) < moved_by(robot, name)]
        for name in (link, *behind):
            hits = _entries(robot, q, name, start, along)
            if hits:
                break
    estimate = hits[0] if hits else np.full(3, np.nan)
    return Answer(link, estimate, force, bool(hits), hits)


def _entries(
    robot: Robot, q: FloatArray, link: str, start: FloatArray, along: FloatArray
) -> list[FloatArray]:
    """Where a line enters a link's surface, in order."""
    pose = robot.link_pose(q, link)
    # From far before the robot, so that all of the line is seen.
    origin = (start - 10.0 * along - pose[:3, 3]) @ pose[:3, :3]
    hits = robot.surface(link).cast_rays(origin[None], (along @ pose[:3, :3])[None])
    entering = hits.normal @ (along @ pose[:3, :3]) < 0.0
    return list(hits.point[entering] @ pose[:3, :3].T + pose[:3, 3])

"""The links that a floating base carries along, and axes in which its velocity may be given."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .. import _core
from .quaternions import inverse, of_matrix, product, rotated

Rows = NDArray[np.float64]

# Two places nearer than this [m, rad] are one, as numbers of descriptions are rounded.
_SAME = 1e-9
# Axes are told from each other where velocities differ by more than this share in them.
_TELLING = 0.1
# Of the squared difference between both, what the better of them may be wrong by: as measured velocities are
# smoother than differences, up to a quarter.
_FITTING = 0.25


@dataclass(frozen=True)
class BaseFrames:
    """The frames of a floating base.

    Args:
        origin: `(4, 4)`, where the base is at the configuration zero: the place of its joint in the world.
        links: the pose of each link that does not move against the base, in its frame.
    """

    origin: Rows
    links: Mapping[str, Rows]

    @property
    def own(self) -> list[str]:
        """The links whose frame is the base's."""
        return [name for name, place in self.links.items() if is_same(place)]


def base_frames(robot: _core.Robot) -> BaseFrames:
    """Of a robot with a floating base."""
    neutral, turned = robot.neutral(), robot.random_configuration(0)
    move = _matrix(turned)
    names = robot.all_link_names
    poses = {name: (robot.link_pose(neutral, name), robot.link_pose(turned, name)) for name in names}
    # The base's frame moves from where it is by the base's own pose; others only by chance.
    origin = next((first for first, second in poses.values() if is_same(second, first @ move)), np.eye(4))
    places: dict[str, Rows] = {}
    for name, (first, second) in poses.items():
        place = np.asarray(np.linalg.solve(origin, first), np.float64)
        if is_same(second, origin @ move @ place):
            places[name] = place
    return BaseFrames(origin, places)


def is_same(pose: Rows, other: Rows | None = None) -> bool:
    """Whether two poses are one; the other is that of a frame in itself by default."""
    return bool(np.abs(pose - (np.eye(4) if other is None else other)).max() < _SAME)


def placed(pose: Rows, rows: Rows) -> Rows:
    """Rows of position and quaternion that are given in a frame at `pose`, where the pose is given."""
    if is_same(pose):
        return rows
    turn = np.broadcast_to(of_matrix(pose[:3, :3]), (len(rows), 4))
    return np.column_stack([pose[:3, 3] + rotated(turn, rows[:, :3]), product(turn, rows[:, 3:])])


def told_axes(given: Rows, expected: Rows, quaternions: Rows) -> str:
    """Whether velocities are in the axes of the "world" or the "base", by differences of the pose.

    Args:
        given: `(n, 3)`, in axes to be found out.
        expected: `(n, 3)`, by differences, in axes of the base.
        quaternions: of the base.

    Returns:
        "world", "base", or nothing where neither fits.
    """
    of_world = rotated(inverse(quaternions), given)
    apart = np.sum((of_world - given) ** 2)
    if apart <= _TELLING**2 * np.sum(given**2):
        return "base"
    errors = {"base": np.sum((given - expected) ** 2), "world": np.sum((of_world - expected) ** 2)}
    best = min(errors, key=lambda axes: float(errors[axes]))
    return best if errors[best] < _FITTING * apart else ""


def _matrix(q: Rows) -> Rows:
    """The pose of a base against its joint."""
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = rotated(np.asarray(q[3:7]), np.eye(3)).T, q[:3]
    return pose

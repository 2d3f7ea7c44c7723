"""The links that a floating base carries along, and axes in which its velocity may be given."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .. import _core
from .quaternions import inverse, rotated

Rows = NDArray[np.float64]

# Two places nearer than this [m, rad] are one, as numbers of descriptions are rounded.
_SAME = 1e-9
# Axes are told from each other where velocities differ by more than this share in them.
_TELLING = 0.1
# Of the squared difference between both, what the better of them may be wrong by: as measured velocities are
# smoother than differences, up to a quarter.
_FITTING = 0.25


def carried_links(robot: _core.Robot) -> dict[str, Rows]:
    """The pose of each link that does not move against the base, in its frame."""
    places: dict[str, Rows] = {}
    samples = [robot.neutral(), robot.random_configuration(0)]
    for name in robot.all_link_names:
        first, second = (_inverse_pose(q) @ robot.link_pose(q, name) for q in samples)
        if np.abs(first - second).max() < _SAME:
            places[name] = first
    return places


def is_base(place: Rows) -> bool:
    """Whether a frame at that pose is the base's."""
    return bool(np.abs(place - np.eye(4)).max() < _SAME)


def base_link(robot: _core.Robot) -> str:
    """The link whose pose a floating base has; empty if no link is there."""
    return next((name for name, place in carried_links(robot).items() if is_base(place)), "")


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


def _inverse_pose(q: Rows) -> Rows:
    """From the world to the frame of the base."""
    pose = np.eye(4)
    back = inverse(np.asarray(q[3:7]))
    pose[:3, :3] = rotated(back, np.eye(3)).T
    pose[:3, 3] = -rotated(back, np.asarray(q[:3]))
    return pose

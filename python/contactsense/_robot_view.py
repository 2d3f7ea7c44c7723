"""A robot's surfaces as a picture, by painter's order: no 3-D axes, so points can lie on top."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, TypeAlias

import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_rgb
from numpy.typing import NDArray

from ._core import Robot
from ._pictures import BODY

FloatArray: TypeAlias = NDArray[np.float64]

ELEVATION = 12.0  # [deg]
LONGEST = 0.08  # edge [m]

# Unit vectors to the right, up, and towards the eye.
Eye: TypeAlias = tuple[FloatArray, FloatArray, FloatArray]


def eye(azimuth: float, elevation: float = ELEVATION) -> Eye:
    """Where the eye is, around the vertical from x, and above the ground [deg]."""
    a, e = np.radians(azimuth), np.radians(elevation)
    towards = np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])
    across = np.array([-np.sin(a), np.cos(a), 0.0])
    return across, np.cross(towards, across), towards


def body(
    robot: Robot,
    q: FloatArray,
    view: Eye,
    others: Sequence[tuple[FloatArray, str]] = (),
    colours: Mapping[str, str] | None = None,
) -> PolyCollection:
    """The robot as the eye sees it, lit from the upper right.

    Args:
        robot: its surfaces are drawn.
        q: configuration, (nq,).
        view: where the eye is.
        others: things beside it, as triangles `(n, 3, 3)`, counterclockwise from outside, and their colours.
        colours: of links that differ from the rest.
    """
    colours = colours or {}
    solids = [(faces(robot, q, link), colours.get(link, BODY)) for link in robot.link_names]
    return painted(
        [
            (triangles, np.tile(to_rgb(colour), (len(triangles), 1)))
            for triangles, colour in [*solids, *others]
        ],
        view,
    )


def painted(solids: Sequence[tuple[FloatArray, Any]], view: Eye) -> PolyCollection:
    """Triangles `(n, 3, 3)`, counterclockwise from outside, in one colour `(3,)` or in one each `(n, 3)`."""
    across, up, towards = view
    corners, shades = [], []
    for triangles, colour in solids:
        colours = np.broadcast_to(colour, (len(triangles), 3))
        normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
        normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
        light = 0.72 + 0.28 * np.clip(normals @ (0.6 * towards + 0.5 * up + 0.6 * across), 0.0, 1.0)
        seen = normals @ towards > 0.0
        corners.append(triangles[seen])
        shades.append(np.clip(colours[seen] * 1.08 * light[seen, None], 0.0, 1.0))
    small, shade = split(np.concatenate(corners), np.concatenate(shades))
    order = np.argsort(small.mean(axis=1) @ towards)
    flat = np.stack([small @ across, small @ up], axis=2)[order]
    return PolyCollection(list(flat), facecolors=shade[order], edgecolors=shade[order], linewidths=0.4)


def share_scale(axes: Any) -> None:
    """Views of one size, each with the robot in its middle."""
    width, height = (
        max(high - low for low, high in ends)
        for ends in ([each.get_xlim() for each in axes], [each.get_ylim() for each in axes])
    )
    for each in axes:
        across, up = sum(each.get_xlim()) / 2, sum(each.get_ylim()) / 2
        each.set_xlim(across - width / 2, across + width / 2)
        each.set_ylim(up - height / 2, up + height / 2)
        each.set_aspect("equal")


def faces(robot: Robot, q: FloatArray, link: str) -> FloatArray:
    """A link's triangles `(n, 3, 3)`, world frame."""
    surface, pose = robot.surface(link), robot.link_pose(q, link)
    return (surface.vertices @ pose[:3, :3].T + pose[:3, 3])[surface.triangles]


def split(
    triangles: FloatArray, colours: FloatArray, longest: float = LONGEST
) -> tuple[FloatArray, FloatArray]:
    """Halves edges longer than this [m], by default until the painter's order holds."""
    done, shades = [], []
    while len(triangles):
        sides = np.linalg.norm(triangles - np.roll(triangles, -1, axis=1), axis=2)
        long = sides.max(axis=1) > longest
        done.append(triangles[~long])
        shades.append(colours[~long])
        triangles, colours, sides = triangles[long], colours[long], sides[long]
        first = sides.argmax(axis=1)
        row = np.arange(len(triangles))
        a, b, c = (triangles[row, (first + step) % 3] for step in range(3))
        middle = 0.5 * (a + b)
        triangles = np.concatenate([np.stack([a, middle, c], 1), np.stack([middle, b, c], 1)])
        colours = np.concatenate([colours, colours])
    return np.concatenate(done), np.concatenate(shades)

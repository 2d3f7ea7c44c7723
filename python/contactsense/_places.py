"""Places of contacts on a picture of the robot."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import cycle
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.patches import Patch

from ._contact_view import visible
from ._core import Robot
from ._pictures import JOINTS, TEXT
from ._robot_view import FloatArray, body, eye, share_scale

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# Opposite sides, from above, so that each place is seen from one of them [deg].
_AZIMUTHS = (50.0, 230.0)
_ELEVATION = 25.0

# Area of a dot, for each newton, and its bounds [points²].
_AREA, _SMALLEST, _LARGEST = 2.0, 20.0, 200.0


@dataclass(frozen=True, eq=False)
class Places:
    """Places of contacts.

    Args:
        links: of each.
        points: `(n, 3)`, in their links' frames [m].
        forces: `(n,)`, greatest force [N]; NaN where it is not known.
    """

    links: Sequence[str]
    points: FloatArray
    forces: FloatArray


def link_colours(links: Sequence[str]) -> dict[str, str]:
    """A colour for each link, in the order in which they come; there are few, and they come again."""
    return dict(zip(dict.fromkeys(links), cycle(JOINTS), strict=False))


def link_legend(axes: Axes, colours: Mapping[str, str]) -> None:
    """The links' colours, to the right of a drawing."""
    handles = [Patch(color=colour, alpha=0.6, label=link) for link, colour in colours.items()]
    axes.legend(handles=handles, loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False, fontsize=8)


def draw_places(
    axes: Sequence[Axes], robot: Robot, q: FloatArray, places: Places, colours: Mapping[str, str]
) -> None:
    """The robot from opposite sides; places that are seen from there are full, the others are circles."""
    points = _in_world(robot, q, places)
    shades = np.array([colours[link] for link in places.links], dtype=object)
    sizes = np.clip(_AREA * np.nan_to_num(places.forces, nan=0.0), _SMALLEST, _LARGEST)
    # Over the robot, and in the order of size, so that none is covered by a greater one.
    order = np.argsort(-sizes)
    for each, azimuth in zip(axes, _AZIMUTHS, strict=True):
        view = eye(azimuth, _ELEVATION)
        each.add_collection(body(robot, q, view))
        flat = np.column_stack([points @ view[0], points @ view[1]])
        seen = visible(robot, q, points, view)
        for rows, full in ((order[~seen[order]], False), (order[seen[order]], True)):
            each.scatter(
                flat[rows, 0],
                flat[rows, 1],
                s=sizes[rows],
                facecolors=shades[rows].tolist() if full else "none",
                edgecolors=shades[rows].tolist(),
                linewidths=0.8,
                alpha=0.9 if full else 0.5,
                zorder=5,
            )
        each.autoscale_view()
        each.set_axis_off()
    share_scale(axes)
    axes[0].text(
        0.0, 0.0, "Full: seen from this side. Circles: on the other side.", color=TEXT, fontsize=8,
        transform=axes[0].transAxes, va="top",
    )  # fmt: skip


def _in_world(robot: Robot, q: FloatArray, places: Places) -> FloatArray:
    poses = {link: robot.link_pose(q, link) for link in set(places.links)}
    moved = [
        poses[link][:3, :3] @ point + poses[link][:3, 3]
        for link, point in zip(places.links, places.points, strict=True)
    ]
    return np.array(moved).reshape(-1, 3)

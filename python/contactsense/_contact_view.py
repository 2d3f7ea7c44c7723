"""One contact on a picture of the robot: the link, the point, the region and the force."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ._core import Robot
from ._pictures import ESTIMATE, NAMED, TEXT, UNSURE
from ._robot_view import Eye, FloatArray, body, eye

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# Of the eyes that are tried [deg].
_ELEVATION, _STEP = 25.0, 15
# A place may lie a little below the surface that it is on [m].
_BELOW = 0.005
# Points of the link whose sight counts as much as that of the place.
_SAMPLES = 20
# Half the width and the length of its head [points].
_ARROW = "-|>,head_width=4.5,head_length=9"
# The greatest force of a picture, as a share of the robot's size.
_LONGEST = 0.2


@dataclass(frozen=True, eq=False)
class ShownContact:
    """What is drawn of one contact; NaN where it is not known.

    Args:
        q: pose of the robot, `(nq,)`.
        link: the likeliest link.
        point: `(3,)`, world frame [m].
        force: `(3,)`, on the robot, world frame [N].
        region_radius: of the region that holds 90 % of the posterior [m].
        located: whether the point is located.
    """

    q: FloatArray
    link: str
    point: FloatArray
    force: FloatArray
    region_radius: float
    located: bool

    @property
    def placed(self) -> bool:
        """Whether there is a point."""
        return bool(np.all(np.isfinite(self.point)))


def draw_contact(axes: Axes, robot: Robot, contact: ShownContact, greatest: float) -> None:
    """The robot with the link in blue, and the force as an arrow that ends at the point.

    The arrow is orange where the contact is located, and yellow where it is not. A circle is the region that
    holds 90 % of the posterior.

    Args:
        axes: of this contact alone.
        robot: its surfaces are drawn.
        contact: the contact.
        greatest: force of the longest arrow [N].
    """
    from matplotlib.patches import Circle, FancyArrowPatch
    from matplotlib.patheffects import withStroke

    view = _best_eye(robot, contact)
    axes.add_collection(body(robot, contact.q, view, colours={contact.link: NAMED}))
    if contact.placed:
        at = _flat(contact.point, view)
        colour = ESTIMATE if contact.located else UNSURE
        if np.isfinite(contact.region_radius):
            axes.add_patch(
                Circle((at[0], at[1]), contact.region_radius, fill=False, ls="--", ec=TEXT, zorder=4)
            )
        if np.all(np.isfinite(contact.force)):
            origins = np.array([robot.link_pose(contact.q, link)[:3, 3] for link in robot.link_names])
            longest = _LONGEST * float(np.ptp(origins, axis=0).max())
            start = _flat(contact.point - contact.force * (longest / max(greatest, 1e-9)), view)
            axes.update_datalim([start])
            arrow = FancyArrowPatch(
                (start[0], start[1]),
                (at[0], at[1]),
                arrowstyle=_ARROW,
                color=colour,
                lw=3.0,
                shrinkA=0.0,
                shrinkB=3.5,
                mutation_scale=1.0,
                zorder=5,
            )
            arrow.set_path_effects([withStroke(linewidth=5.5, foreground="white")])
            axes.add_patch(arrow)
        axes.plot(*at, "o", color=colour, ms=7.0, mec="white", mew=1.2, zorder=6)
    axes.autoscale_view()
    axes.set_axis_off()


def visible(robot: Robot, q: FloatArray, points: FloatArray, view: Eye) -> NDArray[np.bool_]:
    """Points with no surface between them and the eye."""
    seen = np.ones(len(points), dtype=bool)
    for link in robot.link_names:
        pose = robot.link_pose(q, link)
        towards = np.tile(view[2] @ pose[:3, :3], (len(points), 1))
        hits = robot.surface(link).cast_rays((points - pose[:3, 3]) @ pose[:3, :3], towards)
        seen[hits.ray[hits.distance > _BELOW]] = False
    return seen


def _best_eye(robot: Robot, contact: ShownContact) -> Eye:
    """Where the eye must be to see the link that is in contact, its point, and the force from aside."""
    pose = robot.link_pose(contact.q, contact.link)
    points = robot.surface(contact.link).sample(_SAMPLES).points @ pose[:3, :3].T + pose[:3, 3]
    if contact.placed:
        points = np.vstack([points, np.tile(contact.point, (_SAMPLES, 1))])
    size = np.linalg.norm(contact.force)
    against = -contact.force / size if size > 0.0 else np.zeros(3)

    def worth(view: Eye) -> float:
        seen = visible(robot, contact.q, points, view).mean()
        return 2.0 * float(seen) + float(np.linalg.norm(np.cross(against, view[2])))

    return max([eye(float(azimuth), _ELEVATION) for azimuth in range(0, 360, _STEP)], key=worth)


def _flat(point: FloatArray, view: Eye) -> FloatArray:
    return np.array([point @ view[0], point @ view[1]])

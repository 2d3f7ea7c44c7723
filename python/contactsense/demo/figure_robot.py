"""The robot at the moment of a hit, with the true and the estimated force."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from .. import Robot
from .._pictures import ESTIMATE, NAMED, TEXT, TRUTH, WRONG
from .._robot_view import Eye, body, eye
from ..sim.sampling import blocked
from .result import HitResult
from .settings import FloatArray

_ELEVATION = 20.0  # [deg]
# Points of the link whose sight counts as much as that of the point.
_SAMPLES = 40
_LENGTH = 0.0045  # of a force [m/N]

ROBOT_LEGEND = (
    Line2D([], [], color=TRUTH, lw=2.0, marker="o", ms=5, label="true force and point"),
    Line2D([], [], color=ESTIMATE, lw=4.5, marker="o", ms=11, label="estimated"),
    Patch(color=NAMED, label="estimated link, correct"),
    Patch(color=WRONG, label="estimated link, wrong"),
)


def draw_robot(axes: Any, robot: Robot, hit: HitResult) -> None:
    """Surfaces, the named link in colour, and forces that end at their points."""
    view = _best_eye(robot, hit)
    named = {} if hit.named is None else {hit.named: NAMED if hit.link_right else WRONG}
    axes.add_collection(body(robot, hit.q, view, colours=named))
    # Over the surfaces, whatever their depth: the hit faces the eye.
    _arrow(axes, view, hit.true_point, hit.true_force, TRUTH, 2.0, 5.0)
    if hit.point is not None and hit.estimated_force is not None:
        _arrow(axes, view, hit.point, hit.estimated_force, ESTIMATE, 4.5, 4.0)
    axes.autoscale_view()
    axes.set_axis_off()
    title = {"transform": axes.transAxes, "ha": "center"}
    axes.text(
        0.5, 1.15, f"Contact {hit.number}: {hit.link}, {hit.force:.0f} N", weight="bold", fontsize=12, **title
    )
    axes.text(0.5, 1.13, "\n".join(_outcome(hit)), color=TEXT, va="top", **title)


def _outcome(hit: HitResult) -> tuple[str, ...]:
    if hit.named is None:
        return ("not detected",)
    name = "link correct" if hit.link_right else f"wrong link: {hit.named}"
    if hit.point_error is None or hit.force_error is None:
        return name, "point not determined"
    return name, f"point {1e3 * hit.point_error:.1f} mm off, force {100 * hit.force_error:.1f} % off"


def _best_eye(robot: Robot, hit: HitResult) -> Eye:
    """Where the eye must be to see the link that is hit, and the force from aside."""
    pose = robot.link_pose(hit.q, hit.link)
    on_link = robot.surface(hit.link).sample(_SAMPLES).points @ pose[:3, :3].T + pose[:3, 3]
    points = np.vstack([on_link, np.tile(hit.true_point, (_SAMPLES, 1))])
    against = -hit.true_force / hit.force

    def worth(view: Eye) -> float:
        towards = view[2]
        seen = ~blocked(robot, hit.q, hit.link, points, np.tile(-towards, (len(points), 1)))
        aside = float(np.linalg.norm(np.cross(against, towards)) + against @ towards)
        return aside + 2.0 * float(seen.mean())

    return max([eye(10.0 * step, _ELEVATION) for step in range(36)], key=worth)


def _arrow(
    axes: Any, view: Eye, tip: FloatArray, force: FloatArray, colour: str, width: float, order: float
) -> None:
    across, up, _ = view
    ends = np.stack([tip - _LENGTH * force, tip])
    axes.plot(ends @ across, ends @ up, color=colour, lw=width, solid_capstyle="butt", zorder=order)
    axes.plot(tip @ across, tip @ up, "o", color=colour, ms=2.6 * width, zorder=order)

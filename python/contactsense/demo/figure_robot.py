"""The robot at the moment of a hit, with the true and the estimated force."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.colors import to_rgb
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from mpl_toolkits.mplot3d.art3d import Poly3DCollection  # type: ignore[import-untyped]

from .. import Robot
from .._pictures import BODY, ESTIMATE, NAMED, TEXT, TRUTH, WRONG
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
    Patch(color=NAMED, label="link named, right"),
    Patch(color=WRONG, label="link named, wrong"),
)


def draw_robot(axes: Any, robot: Robot, hit: HitResult, *, narrow: bool = False) -> None:
    """Fills 3D axes: surfaces, the named link in colour, forces that end at their points.

    `narrow`: for a robot higher than wide, in axes that overlap with their neighbours.
    """
    azimuth = _azimuth(robot, hit)
    towards = _direction(azimuth, _ELEVATION)
    faces, colours = [], []
    for link in robot.link_names:
        surface, pose = robot.surface(link), robot.link_pose(hit.q, link)
        corners = (surface.vertices @ pose[:3, :3].T + pose[:3, 3])[surface.triangles]
        colour = BODY if link != hit.named else NAMED if hit.link_right else WRONG
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
        facing = normals @ towards > 0.0
        light = 0.62 + 0.38 * np.clip(normals @ _direction(azimuth + 35.0, 50.0), 0.0, 1.0)
        faces.append(corners[facing])
        colours.append(np.array(to_rgb(colour)) * light[facing, None])
    triangles, shades = np.concatenate(faces), np.concatenate(colours)
    axes.add_collection3d(Poly3DCollection(triangles, facecolors=shades, edgecolors=shades, linewidths=0.3))
    # Over the surfaces, whatever their depth: the hit faces the eye.
    axes.computed_zorder = False
    _arrow(axes, hit.true_point, hit.true_force, TRUTH, 2.0, 0.0)
    if hit.point is not None and hit.estimated_force is not None:
        _arrow(axes, hit.point, hit.estimated_force, ESTIMATE, 4.5, -1.0)
    _frame(axes, triangles.reshape(-1, 3), hit)
    axes.view_init(elev=_ELEVATION, azim=azimuth)
    axes.set_axis_off()
    axes.patch.set_visible(False)
    title = {"transform": axes.transAxes, "ha": "center", "va": "top"}
    heights = (1.035, 0.98) if narrow else (1.09, 1.01)
    name = f"Hit {hit.number}: {hit.link}, {hit.force:.0f} N"
    axes.text2D(0.5, heights[0], name, weight="bold", fontsize=12, **title)
    outcome = ("\n" if narrow else ", ").join(_outcome(hit))
    axes.text2D(0.5, heights[1], outcome, color=TEXT, **title)


def _outcome(hit: HitResult) -> tuple[str, ...]:
    if hit.named is None:
        return ("not felt",)
    name = "link named" if hit.link_right else f"named {hit.named}"
    if hit.point_error is None or hit.force_error is None:
        return name, "point open"
    return name, f"point {1e3 * hit.point_error:.1f} mm off, force {100 * hit.force_error:.1f} % off"


def _azimuth(robot: Robot, hit: HitResult) -> float:
    """Where the eye must be [deg] to see the link that is hit, and the force from aside."""
    pose = robot.link_pose(hit.q, hit.link)
    on_link = robot.surface(hit.link).sample(_SAMPLES).points @ pose[:3, :3].T + pose[:3, 3]
    points = np.vstack([on_link, np.tile(hit.true_point, (_SAMPLES, 1))])
    against = -hit.true_force / hit.force

    def worth(azimuth: float) -> float:
        towards = _direction(azimuth, _ELEVATION)
        seen = ~blocked(robot, hit.q, hit.link, points, np.tile(-towards, (len(points), 1)))
        aside = float(np.linalg.norm(np.cross(against, towards)) + against @ towards)
        return aside + 2.0 * float(seen.mean())

    return max([10.0 * step for step in range(36)], key=worth)


def _direction(azimuth: float, elevation: float) -> FloatArray:
    a, e = np.radians(azimuth), np.radians(elevation)
    return np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])


def _arrow(axes: Any, tip: FloatArray, force: FloatArray, colour: str, width: float, order: float) -> None:
    tail = tip - _LENGTH * force
    axes.plot(*np.stack([tail, tip]).T, color=colour, lw=width, solid_capstyle="butt", zorder=20 + order)
    axes.plot(*tip[:, None], "o", color=colour, ms=2.6 * width, zorder=20 + order)


def _frame(axes: Any, points: FloatArray, hit: HitResult) -> None:
    points = np.vstack([points, hit.true_point - _LENGTH * hit.true_force])
    low, high = points.min(axis=0), points.max(axis=0)
    middle, half = 0.5 * (low + high), 0.5 * float((high - low).max())
    axes.set_xlim(middle[0] - half, middle[0] + half)
    axes.set_ylim(middle[1] - half, middle[1] + half)
    axes.set_zlim(middle[2] - half, middle[2] + half)
    axes.set_box_aspect((1, 1, 1), zoom=1.3)

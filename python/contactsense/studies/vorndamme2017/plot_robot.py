"""Single contacts on the robot, after Fig. 6."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure

from ... import Robot
from ...demo.style import BODY, DETECTED, ESTIMATE, TEXT, WRONG
from ..sampling import FloatArray, blocked
from .judge import Verdict
from .scenes import Scene
from .score import EXACT
from .study import Study

# Where the eye is: before, beside and behind the robot, a little above it.
VIEWS = (("from the front", 25.0), ("from the left", 110.0), ("from behind", 205.0))
ELEVATION = 12.0  # [deg]
BOTH, ALONE, NEITHER = "by joint torques and by sensors alone", "by joint torques only", "not located"
COLOURS = {BOTH: DETECTED, ALONE: ESTIMATE, NEITHER: WRONG}


def draw_robot(figure: Figure, study: Study) -> None:
    """Every touch that the eye sees, coloured by what locates it."""
    by_torques, by_sensors = study.run("singles", "torques"), study.run("singles", "sensors")
    kinds = [_kind(*both) for both in zip(by_torques.verdicts, by_sensors.verdicts, strict=True)]
    q = by_torques.scenes[0].q
    shown = [
        (scene, kind)
        for scene, kind in zip(by_torques.scenes, kinds, strict=True)
        if np.array_equal(scene.q, q)
    ]
    figure.suptitle(
        f"{len(kinds):,} single contacts, uniform over the surface: located within 1 nm",
        fontsize=13,
        weight="bold",
        x=0.02,
        ha="left",
    )
    axes = figure.subplots(1, len(VIEWS))
    for each, (title, azimuth) in zip(axes, VIEWS, strict=True):
        _draw_view(each, study.robot, q, shown, azimuth)
        each.set_title(title, color=TEXT, loc="center")
    _share_scale(axes)
    handles = [
        axes[0].plot([], [], "o", ms=6, color=colour, label=f"{kind}: {kinds.count(kind):,}")[0]
        for kind, colour in COLOURS.items()
    ]
    figure.legend(handles=handles, loc="outside lower center", ncols=3, frameon=False)


def _kind(torques: Verdict, sensors: Verdict) -> str:
    if torques.located and torques.error <= EXACT:
        return BOTH if sensors.located and sensors.error <= EXACT else ALONE
    return NEITHER


def _draw_view(
    axes: Any, robot: Robot, q: FloatArray, shown: list[tuple[Scene, str]], azimuth: float
) -> None:
    across, up, towards = _eye(azimuth)
    corners, shades = [], []
    for link in robot.link_names:
        surface, pose = robot.surface(link), robot.link_pose(q, link)
        faces = (surface.vertices @ pose[:3, :3].T + pose[:3, 3])[surface.triangles]
        normals = np.cross(faces[:, 1] - faces[:, 0], faces[:, 2] - faces[:, 0])
        normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
        light = 0.72 + 0.28 * np.clip(normals @ (0.6 * towards + 0.5 * up + 0.6 * across), 0.0, 1.0)
        seen = normals @ towards > 0.0
        corners.append(faces[seen])
        shades.append(np.clip(np.array(to_rgb(BODY)) * 1.08 * light[seen, None], 0.0, 1.0))
    triangles, colours = _split(np.concatenate(corners), np.concatenate(shades))
    order = np.argsort(triangles.mean(axis=1) @ towards)
    flat = np.stack([triangles @ across, triangles @ up], axis=2)[order]
    axes.add_collection(
        PolyCollection(list(flat), facecolors=colours[order], edgecolors=colours[order], linewidths=0.4)
    )
    for kind, colour in COLOURS.items():
        points = [
            scene.touches[0].point
            for scene, each in shown
            if each == kind and _visible(robot, scene, towards)
        ]
        if points:
            spots = np.array(points)
            axes.scatter(spots @ across, spots @ up, s=7, color=colour, linewidths=0, zorder=3)
    axes.autoscale_view()
    axes.set_axis_off()


def _share_scale(axes: Any) -> None:
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


def _split(
    triangles: FloatArray, colours: FloatArray, longest: float = 0.08
) -> tuple[FloatArray, FloatArray]:
    """Halves long edges until the painter's order holds."""
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


def _visible(robot: Robot, scene: Scene, towards: FloatArray) -> bool:
    touch = scene.touches[0]
    outside = touch.point - 1e-6 * touch.force / np.linalg.norm(touch.force)
    return not blocked(robot, scene.q, touch.link, outside[None], -towards[None])[0]


def _eye(azimuth: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Right, up, and towards the eye."""
    a, e = np.radians(azimuth), np.radians(ELEVATION)
    towards = np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])
    across = np.array([-np.sin(a), np.cos(a), 0.0])
    return across, np.cross(towards, across), towards

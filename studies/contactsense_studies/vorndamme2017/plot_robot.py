"""Single contacts on the robot, after Fig. 6."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from contactsense import Robot
from contactsense._pictures import DETECTED, ESTIMATE, TEXT, WRONG
from contactsense._robot_view import body, eye, share_scale
from contactsense.sim._arrays import FloatArray
from contactsense.sim.sampling import blocked

from .judge import Verdict
from .scenes import Scene
from .score import EXACT
from .study import Study

# Where the eye is: before, beside and behind the robot, a little above it.
VIEWS = (("from the front", 25.0), ("from the left", 110.0), ("from behind", 205.0))
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
    share_scale(axes)
    handles = [
        axes[0].plot([], [], "o", ms=6, color=colour, label=f"{kind}: {kinds.count(kind):,}")[0]
        for kind, colour in COLOURS.items()
    ]
    figure.legend(handles=handles, loc="outside lower center", ncols=3, frameon=False)


def _kind(torques: Verdict, sensors: Verdict) -> str:
    if torques.all_located and torques.error <= EXACT:
        return BOTH if sensors.all_located and sensors.error <= EXACT else ALONE
    return NEITHER


def _draw_view(
    axes: Any, robot: Robot, q: FloatArray, shown: list[tuple[Scene, str]], azimuth: float
) -> None:
    across, up, towards = eye(azimuth)
    axes.add_collection(body(robot, q, (across, up, towards)))
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


def _visible(robot: Robot, scene: Scene, towards: FloatArray) -> bool:
    touch = scene.touches[0]
    outside = touch.point - 1e-6 * touch.force / np.linalg.norm(touch.force)
    return not blocked(robot, scene.q, touch.link, outside[None], -towards[None])[0]

"""The picture: how exactly a contact's point is known, on the robots' bodies."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LogNorm, to_rgb
from matplotlib.figure import Figure

from contactsense import Robot
from contactsense._pictures import BODY, TEXT
from contactsense._robot_view import eye, faces, painted, share_scale, split
from contactsense.sim._arrays import FloatArray

from ..harness import Pictures
from .study import Pose, Study

# Azimuths of the eye: before and behind the robot [deg].
VIEWS = (30.0, 210.0)
COLOURS = "viridis_r"
# Ends of the colours [cm]: half a fingertip, and a link.
RANGE = (0.5, 15.0)
TICKS = (0.5, 1.0, 2.0, 5.0, 10.0)
FINEST = 0.03  # edge of a triangle of one colour [m]
_GREY = to_rgb(BODY)
NEIGHBOURS = 4  # samples that a triangle's colour comes from


def draw(figure: Figure, study: Study) -> None:
    """Every robot from two sides, coloured by the median over its poses."""
    options = study.options
    norm, colours = LogNorm(*RANGE), colormaps[COLOURS]
    halves: Any = figure.subfigures(2, 1, height_ratios=(1.0, 0.13))
    above, below = halves
    parts = above.subfigures(1, len(study.robots), squeeze=False)[0]
    for part, name in zip(parts, study.robots, strict=True):
        poses, robot = study.of(name), study.robot(name)
        solids = _solids(robot, poses)
        painted_solids = [
            (triangles, _GREY if deviation is None else colours(norm(100.0 * deviation))[:, :3])
            for triangles, deviation in solids
        ]
        axes = part.subplots(1, len(VIEWS))
        for each, azimuth in zip(axes, VIEWS, strict=True):
            each.add_collection(painted(painted_solids, eye(azimuth)))
            each.autoscale_view()
            each.set_axis_off()
        share_scale(axes)
        number = "one pose" if len(poses) == 1 else f"median of {len(poses)} poses"
        part.suptitle(f"{robot.name}, {number}", fontsize=12, color=TEXT)
    figure.suptitle(
        f"How exactly joint torques locate a contact of {options.force:g} N "
        f"(noise of {options.torque_noise:g} Nm and {100 * options.relative_noise:g} %)",
        fontsize=15,
        weight="bold",
    )
    left, middle, right = below.subplots(1, 3, width_ratios=(1.0, 2.4, 1.0))
    left.set_axis_off()
    right.set_axis_off()
    bar = below.colorbar(ScalarMappable(norm, colours), cax=middle, orientation="horizontal", extend="both")
    bar.set_ticks(TICKS, labels=[f"{tick:g} cm" for tick in TICKS])
    bar.minorticks_off()
    bar.set_label("standard deviation of the contact's point; grey: no joint moves the link")


def _solids(robot: Robot, poses: list[Pose]) -> list[tuple[FloatArray, FloatArray | None]]:
    """Small triangles of each link in one pose, world frame, and the median over all poses for each [m]."""
    deviation = np.median([pose.told.point_std for pose in poses], axis=0)
    links, first, drawn = np.array(poses[0].told.links), poses[0], _drawn(robot, poses)
    solids: list[tuple[FloatArray, FloatArray | None]] = []
    for link in robot.link_names:
        own, triangles = links == link, faces(robot, drawn, link)
        if not own.any():
            solids.append((triangles, None))
            continue
        # The first pose's samples in the pose that is drawn.
        before, now = robot.link_pose(first.q, link), robot.link_pose(drawn, link)
        local = (first.told.points[own] - before[:3, 3]) @ before[:3, :3]
        samples = local @ now[:3, :3].T + now[:3, 3]
        triangles, _ = split(triangles, np.zeros_like(triangles[:, 0]), FINEST)
        solids.append((triangles, _nearby(triangles.mean(axis=1), samples, deviation[own])))
    return solids


def _drawn(robot: Robot, poses: list[Pose]) -> FloatArray:
    """The pose of the picture, in which a robot is recognised: a body's neutral one, an upright arm."""
    if robot.floating_base and len(poses) > 1:
        return robot.neutral()
    return max(poses, key=lambda pose: float(pose.told.points[:, 2].max())).q


def _nearby(points: FloatArray, samples: FloatArray, values: FloatArray) -> FloatArray:
    """At each point, the geometric mean over the samples nearest to it."""
    count = min(NEIGHBOURS, len(samples))
    result = np.empty(len(points))
    for rows in np.array_split(np.arange(len(points)), max(1, len(points) // 500)):
        apart = (samples**2).sum(axis=1) - 2.0 * points[rows] @ samples.T
        near = np.argpartition(apart, count - 1, axis=1)[:, :count]
        result[rows] = np.exp(np.log(values[near]).mean(axis=1))
    return result


PICTURES: Pictures = {"identifiability.png": ((15.0, 6.4), draw)}

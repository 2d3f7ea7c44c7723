"""An arm, its obstacle and particles as one picture."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from contactsense._pictures import ESTIMATE, TRUTH
from contactsense._robot_view import Eye, body, eye
from contactsense.sim import CubeObstacle, CylinderObstacle, Obstacle, SphereObstacle
from contactsense.sim._arrays import FloatArray
from contactsense.sim.sampling import blocked

from .arm import Arm
from .progress import Moment

OBSTACLE = "#E8D9B5"
DRAWN = 2000  # particles
WORST = 0.3  # misfit at the end of the colours
COLOURS = "viridis"
ARROW = 4e-3  # [m/N]


def best_eye(moment: Moment) -> Eye:
    """From the side that is touched, but not from along the force: the arrow should be seen."""
    outward = -moment.true_force
    return eye(float(np.degrees(np.arctan2(outward[1], outward[0]))) + 40.0, 15.0)


def draw_moment(axes: Any, arm: Arm, moment: Moment, obstacle: Obstacle | None, view: Eye) -> Any:
    """Particles coloured by how badly they explain the torques; returns what a colour bar needs."""
    across, up, _ = view
    others = [] if obstacle is None else [(triangles(obstacle, moment.true_point), OBSTACLE)]
    axes.add_collection(body(arm.robot, moment.q, view, others))
    chosen = _drawn(arm, moment, view)
    points = moment.points[chosen]
    # The best come last, on top.
    order = np.argsort(-moment.misfit[chosen])
    dots = axes.scatter(
        (points @ across)[order],
        (points @ up)[order],
        c=moment.misfit[chosen][order],
        cmap=COLOURS,
        vmin=0.0,
        vmax=WORST,
        s=5,
        linewidths=0,
        zorder=3,
    )
    tail = moment.true_point - ARROW * moment.true_force
    axes.annotate(
        "",
        (moment.true_point @ across, moment.true_point @ up),
        (tail @ across, tail @ up),
        arrowprops={"arrowstyle": "-|>", "color": ESTIMATE, "lw": 1.8, "shrinkA": 0, "shrinkB": 0},
        zorder=5,
    )
    axes.plot(
        moment.estimate @ across,
        moment.estimate @ up,
        "o",
        ms=9,
        mfc="none",
        mec=TRUTH,
        mew=1.3,
        zorder=4,
    )
    axes.set_aspect("equal")
    axes.autoscale_view()
    axes.set_axis_off()
    return dots


def _drawn(arm: Arm, moment: Moment, view: Eye) -> NDArray[np.int64]:
    """Some of the particles, by weight, that the eye can see."""
    rng = np.random.default_rng(0)
    total = np.cumsum(moment.weights)
    chosen = np.searchsorted(total, total[-1] * (rng.random() + np.arange(DRAWN)) / DRAWN)
    chosen = np.unique(np.minimum(chosen, len(total) - 1))
    chosen = chosen[moment.normals[chosen] @ view[2] > 0.0]
    outside = moment.points[chosen] + 2e-3 * moment.normals[chosen]
    ways = np.broadcast_to(-view[2], outside.shape)
    seen: NDArray[np.int64] = chosen[~blocked(arm.robot, moment.q, "", outside, ways)]
    return seen


def triangles(obstacle: Obstacle, near: FloatArray) -> FloatArray:
    """(n, 3, 3) the obstacle's surface; of a pole the part near `near`, 0.6 m of it."""
    if isinstance(obstacle, SphereObstacle):
        return _round(obstacle.center, np.eye(3), obstacle.radius, 0.0)
    if isinstance(obstacle, CubeObstacle):
        return _box(obstacle)
    assert isinstance(obstacle, CylinderObstacle)
    axis = obstacle.axis
    middle = obstacle.center + np.clip((near - obstacle.center) @ axis, -0.2, 0.2) * axis
    return _round(middle, obstacle.frame, obstacle.radius, min(0.3, obstacle.half_length))


def _round(center: FloatArray, frame: FloatArray, radius: float, half: float) -> FloatArray:
    """A sphere, its halves drawn apart along the frame's third axis."""
    height, turn = np.linspace(-np.pi / 2, np.pi / 2, 14), np.linspace(0, 2 * np.pi, 25)
    h, t = np.meshgrid(height, turn, indexing="ij")
    z = radius * np.sin(h) + half * np.where(h > 0, 1.0, -1.0)
    grid = np.stack([radius * np.cos(h) * np.cos(t), radius * np.cos(h) * np.sin(t), z], axis=2)
    return _quads(center + grid @ frame.T)


def _quads(grid: FloatArray) -> FloatArray:
    a, b, c, d = grid[:-1, :-1], grid[:-1, 1:], grid[1:, 1:], grid[1:, :-1]
    both = np.concatenate([np.stack([a, b, c], axis=2), np.stack([a, c, d], axis=2)])
    return both.reshape(-1, 3, 3)


def _box(cube: CubeObstacle) -> FloatArray:
    faces = []
    for axis in range(3):
        for sign in (-1.0, 1.0):
            u, v = (axis + 1) % 3, (axis + 2) % 3
            corners = np.zeros((2, 2, 3))
            corners[..., axis] = sign
            corners[..., u] = [[-1, -1], [1, 1]]
            corners[..., v] = [[sign, -sign], [sign, -sign]]
            faces.append(_quads(cube.center + (corners * cube.half_extents) @ cube.rotation.T))
    return np.concatenate(faces)

"""Arms that lean on a springy ball and move a little: what it puts on their joints."""

from __future__ import annotations

from typing import Any

import numpy as np

from .robot import GoldenRobot, Link

LINKS = (4, 5, 6, 7)
UPDATES = 40
RADIUS = 0.05  # [m]
STIFFNESS = (1.5e3, 5e3)  # [N/m]
DEPTH = 0.008  # [m] at the start
BAND = (0.001, 0.02)  # [m]
CLEAR = 0.01  # [m] between the ball and all other links
LEAST = 1.0  # [Nm] on all joints together, at the start
AMPLITUDE = 0.04  # [rad]


def make(robot: GoldenRobot, seeds: tuple[int, ...]) -> dict[str, Any]:
    """A run a link and seed."""
    rows = []
    for number in LINKS:
        (link,) = (link for link in robot.links if link.name == f"iiwa_link_{number}")
        rows += [_run(robot, link, np.random.default_rng([seed, number])) for seed in seeds]
    return {"runs": rows}


def _run(robot: GoldenRobot, link: Link, rng: np.random.Generator) -> dict[str, Any]:
    stiffness = float(np.round(rng.uniform(*STIFFNESS)))
    while True:
        start = robot.configuration(rng)
        robot.place(start)
        local, normal = link.shapes[rng.integers(len(link.shapes))].draw(rng)
        centre = np.round(robot.pose(link).act(local + (RADIUS - DEPTH) * normal), 5)
        touch = _touch(robot, link, start, centre, stiffness)
        if touch is not None and np.linalg.norm(touch["torque"]) > LEAST:
            break
    updates = []
    for update in range(UPDATES):
        amplitude, touch = AMPLITUDE, None
        while touch is None:
            touch = _touch(robot, link, _swing(start, update, amplitude), centre, stiffness)
            amplitude *= 0.5
        updates.append(touch)
    final = updates[-1]
    return {
        "link": link.name,
        "stiffness": stiffness,
        "point": final["point"],
        "force": final["force"],
        "q": [touch["q"] for touch in updates],
        "torque": [touch["torque"] for touch in updates],
    }


def _swing(start: np.ndarray, update: int, amplitude: float) -> np.ndarray:
    """Every joint with a period of its own."""
    joint = np.arange(start.size)
    phase = 1.3 * joint
    return np.round(start + amplitude * (np.sin((0.4 + 0.13 * joint) * update + phase) - np.sin(phase)), 5)


def _touch(
    robot: GoldenRobot, link: Link, q: np.ndarray, centre: np.ndarray, stiffness: float
) -> dict[str, Any] | None:
    """The contact with the ball at `centre`; nothing where its depth is wrong, or another link is near."""
    robot.place(q)
    distance, point = _nearest(robot, link, centre)
    depth = RADIUS - distance
    others = (other for other in robot.links if other is not link)
    if not BAND[0] < depth < BAND[1] or any(
        _nearest(robot, other, centre)[0] < RADIUS + CLEAR for other in others
    ):
        return None
    force = stiffness * depth * (point - centre) / np.linalg.norm(point - centre)
    torque = robot.jacobian(link, point)[:3].T @ force
    return {"q": q, "point": point, "force": force, "torque": np.round(torque, 9)}


def _nearest(robot: GoldenRobot, link: Link, centre: np.ndarray) -> tuple[float, np.ndarray]:
    """Distance, negative inside, and nearest point of a link, world frame."""
    pose = robot.pose(link)
    local = pose.actInv(centre)
    best = (np.inf, centre)
    for shape in link.shapes:
        low, high = shape.mesh.bounds
        far = float(np.linalg.norm(np.maximum(0.0, np.maximum(low - local, local - high))))
        if far > RADIUS + CLEAR:
            found = (far, centre)
        else:
            distance, place = shape.nearest(local)
            found = (distance, pose.act(place))
        best = min(best, found, key=lambda pair: pair[0])
    return best

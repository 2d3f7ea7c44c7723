"""Poses in contact: corrected by the least change of the joints until a link is as deep as it should be."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

import numpy as np

from contactsense import Robot
from contactsense.errors import InputError

from ._arrays import FloatArray
from .contact_path import ContactPath, Pace
from .deepest import ContactQuery
from .scene import TouchScene

Step: TypeAlias = Callable[[int, np.random.Generator], FloatArray]

_NEWTON = 12
# Penetration is met this closely [m].
_CLOSE = 1e-6
# A correction never turns a joint farther than this at once [rad].
_LARGEST = 0.05
_TRIES = 20


class HeldLink:
    """A hand kept at the pose it has at `q`."""

    def __init__(self, robot: Robot, link: str, q: FloatArray, rows: int) -> None:
        self._robot, self._link, self._rows = robot, link, rows
        self._goal = robot.link_pose(q, link)

    def error(self, q: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Jacobian (rows, nv) and what is missing (rows,)."""
        pose = self._robot.link_pose(q, self._link)
        turn = self._goal[:3, :3] @ pose[:3, :3].T
        axis = 0.5 * np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]])
        missing = np.concatenate([self._goal[:3, 3] - pose[:3, 3], axis])[: self._rows]
        return self._robot.jacobian(q, self._link)[: self._rows], missing


def plan(
    robot: Robot,
    scene: TouchScene,
    step: Step,
    force_band: tuple[float, float],
    pace: Pace,
    seed: int,
    hold: HeldLink | None = None,
) -> ContactPath:
    low, high = force_band
    if not 0.0 < low <= high:
        raise InputError("force_band must be (least, greatest), both above zero")
    if robot.nq != robot.nv:
        raise InputError("robot: exploration needs a fixed base and joints with one coordinate each")
    rng = np.random.default_rng(seed)
    query = ContactQuery(robot, scene.obstacle, links=(scene.link,))
    others = ContactQuery(robot, scene.obstacle, links=robot.link_names)
    depth = float(np.linalg.norm(scene.force)) / scene.stiffness
    deepest = 0.9 * scene.obstacle.rounding
    corners, depths = [scene.q], [depth]
    for k in range(pace.motions):
        for _ in range(_TRIES):
            goal = min(depth * rng.uniform(low, high), deepest)
            q = _correct(query, scene.link, scene.q + step(k, rng), goal, hold)
            if q is not None and _alone(others, q, scene.link):
                corners.append(q)
                depths.append(goal)
                break
        else:
            raise InputError("scene: the contact is lost in every motion tried; smaller ones may keep it")
    return _path(query, scene, np.array(corners), np.array(depths), pace, hold)


def _alone(query: ContactQuery, q: FloatArray, link: str) -> bool:
    return all(query.near(q, other, 0.0) is None for other in query.links if other != link)


def _path(
    query: ContactQuery,
    scene: TouchScene,
    corners: FloatArray,
    depths: FloatArray,
    pace: Pace,
    hold: HeldLink | None,
) -> ContactPath:
    count = round(pace.rate * pace.duration)
    share = np.arange(1, count + 1) / count
    ease = share**3 * (10 + share * (-15 + 6 * share))
    poses, torques = [], []
    for k in range(len(corners)):
        if k == 0:
            sections = [(corners[0], depths[0])]
        else:
            sections = [
                (
                    corners[k - 1] + s * (corners[k] - corners[k - 1]),
                    depths[k - 1] + s * (depths[k] - depths[k - 1]),
                )
                for s in ease
            ]
        for between, goal in sections:
            q = _correct(query, scene.link, between, goal, hold)
            poses.append(between if q is None else q)
            torques.append(_torque(query, scene, poses[-1]))
    time = np.arange(len(poses)) / pace.rate
    return ContactPath(time, np.array(poses), np.array(torques))


def _torque(query: ContactQuery, scene: TouchScene, q: FloatArray) -> FloatArray:
    contact = query.near(q, scene.link, 0.0)
    if contact is None:
        return np.zeros(query.robot.nv)
    jacobian = query.robot.jacobian(q, scene.link, contact.point)[:3]
    torque: FloatArray = -scene.stiffness * contact.penetration * (jacobian.T @ contact.normal)
    return torque


def _correct(
    query: ContactQuery, link: str, q: FloatArray, depth: float, hold: HeldLink | None
) -> FloatArray | None:
    """`q` changed by as little as brings `link` to `depth`; None where that is not found."""
    for _ in range(_NEWTON):
        contact = query.at(q, link)
        missing = np.array([depth - contact.penetration])
        rows = (contact.normal @ query.robot.jacobian(q, link, contact.point)[:3])[None]
        if hold is not None:
            task, error = hold.error(q)
            rows, missing = np.vstack([rows, task]), np.concatenate([missing, error])
        if float(np.abs(missing).max()) < _CLOSE:
            return q
        size = float((rows * rows).sum())
        if not rows[0].any():  # the core is reached, or the contact turns no joint
            return None
        square = rows @ rows.T + 1e-8 * size * np.eye(len(rows))
        change = rows.T @ np.linalg.solve(square, missing)
        largest = float(np.abs(change).max())
        if not np.isfinite(largest):
            return None
        q = q + change * min(1.0, _LARGEST / max(largest, 1e-12))
    return None

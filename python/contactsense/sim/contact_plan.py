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
# Beyond this, there is no such pose nearby [rad].
_FARTHEST = 1.0
_TRIES, _SHORTER = 20, 0.8
# A motion is corrected at least so often.
_STEPS = 8


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
    """A path of motions to `scene.q + step(k, generator)`, each corrected; see the explorations."""
    low, high = force_band
    if not 0.0 < low <= high:
        raise InputError("force_band must be (least, greatest), both above zero")
    if robot.nq != robot.nv:
        raise InputError("robot: exploration needs a fixed base and joints with one coordinate each")
    rng = np.random.default_rng(seed)
    walk = _Walk(robot, scene, pace, hold)
    deepest = 0.9 * scene.obstacle.rounding
    poses, depth = [scene.q], walk.depth
    for k in range(pace.motions):
        for failed in range(_TRIES):
            goal = min(walk.depth * rng.uniform(low, high), deepest)
            # Where long ones fail, shorter ones may do.
            knots = walk.to(poses[-1], scene.q + _SHORTER**failed * step(k, rng), depth, goal)
            if knots is not None:
                poses += knots
                depth = goal
                break
        else:
            raise InputError("scene: the contact is lost in every motion tried; smaller ones may keep it")
    torques = np.array([walk.torque(q) for q in poses])
    return ContactPath(np.arange(len(poses)) / pace.rate, np.array(poses), torques)


class _Walk:
    """From pose to pose in contact."""

    def __init__(self, robot: Robot, scene: TouchScene, pace: Pace, hold: HeldLink | None) -> None:
        self._robot, self._scene, self._hold = robot, scene, hold
        self._query = ContactQuery(robot, scene.obstacle, links=robot.link_names)
        self.depth = float(np.linalg.norm(scene.force)) / scene.stiffness
        count = round(pace.rate * pace.duration)
        self._every = -(-_STEPS // count)
        share = np.arange(count * self._every + 1) / (count * self._every)
        self._ease = share**3 * (10 + share * (-15 + 6 * share))

    def to(self, start: FloatArray, end: FloatArray, depth: float, goal: float) -> list[FloatArray] | None:
        """Knots after `start`, at rest at both ends, on the way to `end`; None if contact is lost."""
        q, knots = start, []
        for k in range(1, len(self._ease)):
            moved = q + (self._ease[k] - self._ease[k - 1]) * (end - start)
            corrected = self._correct(moved, depth + self._ease[k] * (goal - depth))
            if corrected is None or not self._only(corrected):
                return None
            q = corrected
            if k % self._every == 0:
                knots.append(q)
        return knots

    def torque(self, q: FloatArray) -> FloatArray:
        """(nv,) external torque of the frictionless contact at `q`."""
        contact = self._query.at(q, self._scene.link)
        jacobian = self._robot.jacobian(q, contact.link, contact.point)[:3]
        torque: FloatArray = -self._scene.stiffness * contact.penetration * (jacobian.T @ contact.normal)
        return torque

    def _only(self, q: FloatArray) -> bool:
        """Whether the link touches at one point, and no other link touches."""
        others = (link for link in self._query.links if link != self._scene.link)
        if any(self._query.near(q, link, 0.0) is not None for link in others):
            return False
        return self._query.single(q, self._query.at(q, self._scene.link))

    def _correct(self, q: FloatArray, depth: float) -> FloatArray | None:
        """`q` changed by as little as brings the link to `depth`; None where that is not found."""
        for _ in range(_NEWTON):
            contact = self._query.at(q, self._scene.link)
            missing = np.array([depth - contact.penetration])
            rows = (contact.normal @ self._robot.jacobian(q, contact.link, contact.point)[:3])[None]
            if not rows.any():  # the obstacle's core is reached, or the contact turns no joint
                return None
            if self._hold is not None:
                task, error = self._hold.error(q)
                rows, missing = np.vstack([rows, task]), np.concatenate([missing, error])
            if float(np.abs(missing).max()) < _CLOSE:
                return q
            square = rows @ rows.T
            square += 1e-8 * np.trace(square) * np.eye(len(rows))
            change = rows.T @ np.linalg.solve(square, missing)
            largest = float(np.abs(change).max())
            if not largest < _FARTHEST:
                return None
            q = q + change * min(1.0, _LARGEST / max(largest, 1e-12))
        return None

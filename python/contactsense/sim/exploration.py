"""Small motions in contact, planned so that the contact is kept.

From pose to pose the arm moves by random or deliberate steps; each pose is then corrected, by the least change of
the joints, until the link is as deep in the obstacle as planned. So the force stays within a band, while the
contact wanders over the surface.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from contactsense import Robot
from contactsense.errors import InputError

from ._arrays import FloatArray, positive
from .deepest import ContactQuery
from .scene import TouchScene

Step: TypeAlias = Callable[[int, np.random.Generator], FloatArray]

_NEWTON = 12
# Penetration is met this closely [m].
_CLOSE = 1e-6
# A correction never turns a joint farther than this at once [rad].
_LARGEST = 0.05
_TRIES = 20


@dataclass(frozen=True, eq=False)
class ContactPath:
    """Poses that an arm goes through in contact, `T` knots."""

    time: FloatArray  # (T,) [s]
    q: FloatArray  # (T, nq)
    external_torque: FloatArray  # (T, nv) what the contact is planned to put on the joints [Nm]

    def __len__(self) -> int:
        return len(self.time)

    def at(self, time: float) -> tuple[FloatArray, FloatArray]:
        """Pose and planned external torque at `time` [s], linear between knots; held at both ends."""
        k = int(np.clip(np.searchsorted(self.time, time, side="right") - 1, 0, len(self.time) - 2))
        share = float(np.clip((time - self.time[k]) / (self.time[k + 1] - self.time[k]), 0.0, 1.0))
        q: FloatArray = self.q[k] + share * (self.q[k + 1] - self.q[k])
        torque = self.external_torque[k] + share * (self.external_torque[k + 1] - self.external_torque[k])
        return q, torque


@dataclass(frozen=True)
class Pace:
    """How many motions, how long, and how finely planned."""

    motions: int = 40
    duration: float = 0.25  # of one motion [s]; starts and ends at rest
    rate: float = 50.0  # of the knots [Hz]

    def __post_init__(self) -> None:
        if self.motions < 1:
            raise InputError(f"motions must be 1 or more, not {self.motions}")
        positive("duration", self.duration)
        if positive("rate", self.rate) * self.duration < 1.0:
            raise InputError("rate must give at least one knot a motion")


def joint_exploration(
    robot: Robot,
    scene: TouchScene,
    *,
    amplitude: float = np.deg2rad(2.0),
    force_band: tuple[float, float] = (0.5, 1.5),
    pace: Pace | None = None,
    seed: int = 0,
) -> ContactPath:
    """Random poses around the scene's: each joint uniform within `amplitude` [rad], then corrected.

    Args:
        force_band: the planned force, as shares of the scene's; uniform in the band.
        pace: of the motions.
        seed: same seed, same path.

    Raises:
        InputError: names the argument; also if the contact cannot be kept.
    """
    positive("amplitude", amplitude)

    def step(_: int, rng: np.random.Generator) -> FloatArray:
        offset: FloatArray = amplitude * rng.uniform(-1.0, 1.0, robot.nv)
        return offset

    return _plan(robot, scene, step, force_band, pace or Pace(), seed)


def sliding_exploration(
    robot: Robot,
    scene: TouchScene,
    *,
    travel: float = 0.04,
    largest: float = np.deg2rad(10.0),
    force_band: tuple[float, float] = (0.5, 1.5),
    pace: Pace | None = None,
    seed: int = 0,
) -> ContactPath:
    """Deliberate motions that move the contact along the surface, to and fro in all tangential directions.

    Args:
        travel: of the touched point from where it was, along the obstacle [m]; as far as the joints allow.
        largest: change of a joint [rad].
        force_band, pace, seed, errors: as for `joint_exploration`.
    """
    positive("travel", travel)
    positive("largest", largest)
    jacobian = robot.jacobian(scene.q, scene.link, scene.point)[:3]
    helper = np.eye(3)[int(np.argmin(np.abs(scene.normal)))]
    first = np.cross(scene.normal, helper)
    first /= np.linalg.norm(first)
    tangents = np.stack([first, np.cross(scene.normal, first)])
    # Damped, so that directions which the joints hardly move do not ask for large turns.
    along = tangents @ jacobian
    inverse = along.T @ np.linalg.inv(along @ along.T + 1e-2 * np.trace(along @ along.T) * np.eye(2))
    golden = np.pi * (3.0 - np.sqrt(5.0))

    def step(k: int, rng: np.random.Generator) -> FloatArray:
        # Successive directions differ by the golden angle: any few of them cover all directions.
        angle = golden * k + 0.2 * rng.normal()
        offset = inverse @ (travel * np.array([np.cos(angle), np.sin(angle)]))
        bounded: FloatArray = offset * min(1.0, largest / max(float(np.abs(offset).max()), 1e-12))
        return bounded

    return _plan(robot, scene, step, force_band, pace or Pace(), seed)


def null_space_exploration(
    robot: Robot,
    scene: TouchScene,
    hand: str,
    *,
    amplitude: float = np.deg2rad(5.0),
    hold: str = "position",
    force_band: tuple[float, float] = (0.3, 1.7),
    pace: Pace | None = None,
    seed: int = 0,
) -> ContactPath:
    """Motions in the null space of the hand's task: the hand stays where it is, the elbow moves.

    Args:
        hand: link whose origin is held; not the touched one, nor before it.
        amplitude: of the random turns that are projected into the null space [rad].
        hold: "position", which leaves a seven-joint arm four directions, or "pose", which leaves it one: then
            the force band alone says how far the elbow goes.
        force_band, pace, seed, errors: as for `joint_exploration`.
    """
    positive("amplitude", amplitude)
    if hold not in ("position", "pose"):
        raise InputError(f"hold must be 'position' or 'pose', not {hold!r}")
    rows = 3 if hold == "position" else 6
    task = robot.jacobian(scene.q, hand)[:rows]
    if robot.nv <= rows or not np.abs(task).max() > 0.0:
        raise InputError(f"hand: holding '{hand}' leaves this robot no motion, or it does not move")
    _, _, rest = np.linalg.svd(task)
    basis = rest[rows:]

    def step(_: int, rng: np.random.Generator) -> FloatArray:
        offset: FloatArray = basis.T @ (basis @ (amplitude * rng.uniform(-1.0, 1.0, robot.nv)))
        return offset

    return _plan(robot, scene, step, force_band, pace or Pace(), seed, _Hold(robot, hand, scene.q, rows))


class _Hold:
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


def _plan(
    robot: Robot,
    scene: TouchScene,
    step: Step,
    force_band: tuple[float, float],
    pace: Pace,
    seed: int,
    hold: _Hold | None = None,
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
    hold: _Hold | None,
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
                (corners[k - 1] + s * (corners[k] - corners[k - 1]), depths[k - 1] + s * (depths[k] - depths[k - 1]))
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
    query: ContactQuery, link: str, q: FloatArray, depth: float, hold: _Hold | None
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
        square = rows @ rows.T + 1e-8 * size * np.eye(len(rows))
        change = rows.T @ np.linalg.solve(square, missing)
        largest = float(np.abs(change).max())
        if not np.isfinite(largest):
            return None
        q = q + change * min(1.0, _LARGEST / max(largest, 1e-12))
    return None

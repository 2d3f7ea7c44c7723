"""Where an obstacle stands so that one chosen link presses on it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from contactsense import Robot
from contactsense.errors import InputError

from ._arrays import FloatArray, positive, vector
from .deepest import ContactQuery, moving_links
from .obstacles import CubeObstacle, CylinderObstacle, Obstacle, SphereObstacle
from .penalty import PenaltyContact

ObstacleKind: TypeAlias = Literal["sphere", "cube", "cylinder"]

# Share of each joint's range that poses are drawn from.
_RANGE = 0.9
_TRIES = 2000
# Points of the surface tried in one pose.
_POINTS = 4
# Of edges and poles out of the tangent plane, at most [rad].
_TILT = 0.15
# A pressed obstacle's rounding must not be used up [share].
_DEEPEST = 0.7


@dataclass(frozen=True, eq=False)
class TouchScene:
    """A pose in which one link presses on an obstacle; world frame."""

    link: str
    q: FloatArray  # (nq,)
    obstacle: Obstacle
    stiffness: float  # [N/m]
    point: FloatArray  # (3,) on the link's surface [m]
    normal: FloatArray  # (3,) unit, outward of the link
    force: FloatArray  # (3,) on the robot [N], frictionless
    external_torque: FloatArray  # (nv,) [Nm]

    def contact(self, robot: Robot, *, friction: float = 0.0, dissipation: float = 0.0) -> PenaltyContact:
        """The spring between `robot` and the obstacle."""
        return PenaltyContact(
            robot, self.obstacle, stiffness=self.stiffness, friction=friction, dissipation=dissipation
        )


def touch_scene(
    robot: Robot,
    link: str,
    *,
    kind: ObstacleKind = "sphere",
    q: ArrayLike | None = None,
    force_range: tuple[float, float] = (5.0, 40.0),
    radius_range: tuple[float, float] = (0.02, 0.1),
    stiffness_range: tuple[float, float] = (3e3, 3e3),
    least_torque: float = 0.5,
    clearance: float = 0.005,
    seed: int = 0,
) -> TouchScene:
    """A random pose, a random point of `link`, and an obstacle that presses there and touches nothing else.

    A point whose force turns no joint cannot be felt by joint torques, whoever looks: such draws (near joint
    1's axis, or pressed along it) are thrown away, as are those with another link, moving or fixed, within
    `clearance`, and those in a fold of the link, where an obstacle touches at several points. So points are
    uniform by area only among those that can be touched and felt.

    Args:
        robot: poses are drawn from the middle 90 % of its joints' limits (a turn about zero where there are
            none).
        link: the contact link; it has a surface and moves.
        kind: "sphere"; "cube", with an edge towards the link; "cylinder", a pole across it in a random
            way.
        q: (nq,) this pose instead of a random one.
        force_range: uniform [N].
        radius_range: of sphere and pole, log-uniform; half extent of the cube [m].
        stiffness_range: log-uniform [N/m]; equal ends fix it. Where the force would press deeper than the
            obstacle's rounding allows, it is drawn again.
        least_torque: Euclidean norm that the external torque must reach [Nm].
        clearance: least distance of the other links from the obstacle [m].
        seed: same seed, same scene.

    Raises:
        InputError: names the argument; also if nothing is found.
    """
    if link not in moving_links(robot):
        raise InputError(f"link: '{link}' has no surface or does not move")
    if kind not in ("sphere", "cube", "cylinder"):
        raise InputError(f"kind must be sphere, cube or cylinder, not {kind!r}")
    ranges = {"force_range": force_range, "radius_range": radius_range, "stiffness_range": stiffness_range}
    for name, (low, high) in ranges.items():
        if positive(name, low) > positive(name, high):
            raise InputError(f"{name} must be (least, greatest)")
    rng = np.random.default_rng(seed)
    fixed = None if q is None else vector("q", q, robot.nq)
    for _ in range(_TRIES // _POINTS):
        pose = _random_pose(robot.model, rng) if fixed is None else fixed
        for _ in range(_POINTS):
            force = rng.uniform(*force_range)
            size, stiffness = _log_uniform(rng, radius_range), _log_uniform(rng, stiffness_range)
            drawn = _place(robot, pose, link, kind, size, force / stiffness, rng)
            scene = drawn and _judge(robot, pose, link, drawn, stiffness, clearance)
            if (
                scene
                and np.linalg.norm(scene.external_torque) >= least_torque
                and _within(scene, force_range)
            ):
                return scene
    raise InputError(
        f"link: no touch of '{link}' by a {kind} was found in {_TRIES} draws; other poses, sizes or a lower"
        f" least_torque ({least_torque:g} Nm) may do"
    )


def _place(
    robot: Robot,
    q: FloatArray,
    link: str,
    kind: ObstacleKind,
    size: float,
    depth: float,
    rng: np.random.Generator,
) -> Obstacle | None:
    """An obstacle `depth` deep in a random point of the link; None if it is too small for that."""
    sample = robot.surface(link).sample(1, seed=int(rng.integers(2**62)))
    pose = robot.link_pose(q, link)
    point = pose[:3, :3] @ sample.points[0] + pose[:3, 3]
    normal = pose[:3, :3] @ sample.normals[0]
    across = np.cross(normal, rng.normal(size=3))
    # Not quite tangent: along a flat face, any point of the line would be as deep as the others.
    across /= np.linalg.norm(across)
    tilt = rng.uniform(-_TILT, _TILT)
    across = np.cos(tilt) * across + np.sin(tilt) * normal
    if kind != "sphere":
        normal = normal - (normal @ across) * across
        normal /= np.linalg.norm(normal)
    if kind == "sphere":
        ball = SphereObstacle(point + (size - depth) * normal, size)
        return ball if depth < _DEEPEST * size else None
    if kind == "cylinder":
        pole = CylinderObstacle(point + (size - depth) * normal, across, size, 0.5)
        return pole if depth < _DEEPEST * size else None
    edge = min(max(0.01, 1.5 * depth), 0.5 * size)
    if depth > _DEEPEST * edge:
        return None
    other = np.cross(normal, across)
    # Two faces lean by 30 to 60 degrees from the normal, their common edge comes first.
    lean = rng.uniform(np.pi / 6, np.pi / 3)
    first = np.cos(lean) * normal + np.sin(lean) * other
    rotation = np.stack([across, first, np.cross(across, first)], axis=1)
    box = CubeObstacle(np.zeros(3), np.full(3, size), rotation, edge)
    support = -(np.abs(normal @ rotation) @ box.core) - edge
    corner = -(rotation @ (np.sign(normal @ rotation) * box.core * [0.0, 1.0, 1.0])) - edge * normal
    assert abs(corner @ normal - support) < 1e-9
    return CubeObstacle(point - depth * normal - corner, np.full(3, size), rotation, edge)


def _judge(
    robot: Robot, q: FloatArray, link: str, obstacle: Obstacle, stiffness: float, clearance: float
) -> TouchScene | None:
    query = ContactQuery(robot, obstacle, links=robot.link_names)
    if any(query.near(q, other, clearance) is not None for other in robot.link_names if other != link):
        return None
    contact = query.at(q, link)
    if not 0.0 < contact.penetration < _DEEPEST * obstacle.rounding or not query.single(q, contact):
        return None
    force = -stiffness * contact.penetration * contact.normal
    torque = robot.jacobian(q, link, contact.point)[:3].T @ force
    return TouchScene(link, q.copy(), obstacle, stiffness, contact.point, contact.normal, force, torque)


def _within(scene: TouchScene, force_range: tuple[float, float]) -> bool:
    # A dent lets the obstacle press elsewhere, and harder, than where it was put.
    low, high = force_range
    return bool(low * (1 - 1e-6) <= np.linalg.norm(scene.force) <= high * (1 + 1e-6))


def _random_pose(model: pin.Model, rng: np.random.Generator) -> FloatArray:
    low = np.maximum(np.asarray(model.lowerPositionLimit), -np.pi)
    high = np.minimum(np.asarray(model.upperPositionLimit), np.pi)
    half = 0.5 * _RANGE * (high - low)
    pose: FloatArray = 0.5 * (low + high) + half * rng.uniform(-1.0, 1.0, low.size)
    return pose


def _log_uniform(rng: np.random.Generator, limits: tuple[float, float]) -> float:
    low, high = limits
    return low * float((high / low) ** rng.uniform())

"""Where a link's true surface and an obstacle meet deepest.

The deepest point is the point of the link's surface that is nearest to the obstacle's core; the contact
normal runs between the two, also on edges and corners of the mesh. For a sphere that is the nearest point to
its centre. For a pole and a cube, coal finds the nearest pair of the surface's triangles and the core; on
exact primitives, which it gets as triangles, the pair is then drawn to the true surface by alternate
projections, their steps lengthened after Barzilai and Borwein (1988).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contactsense import Robot, Surface
from contactsense.errors import InputError

from ._arrays import FloatArray
from .nearest_pair import ObstacleCore, link_body
from .obstacles import Obstacle, SphereObstacle

# Rounds of projection, and the step at which they end [m].
_ROUNDS, _STILL = 50, 1e-8
# Triangles that stand for primitives may be off by this [m].
_TESSELLATION = 1e-3
# A link may rise above the tangent plane by this share of the penetration, or this [m].
_RISE, _LEAST_RISE = 0.1, 1e-4
# Below this cosine between the triangle's normal and the way to the query, the side is checked with a ray.
_CLEAR = 0.2


@dataclass(frozen=True)
class DeepestPoint:
    """Where one link comes nearest to, or is deepest in, an obstacle; world frame."""

    link: str
    point: FloatArray  # (3,) on the link's surface [m]
    normal: FloatArray  # (3,) unit, from the link towards the obstacle; zero where its core is reached
    penetration: float  # [m], negative: the gap


class ContactQuery:
    """Deepest points of a robot's links in one obstacle.

    Args:
        robot: its surfaces are used as they are, meshes as triangles and primitives exactly.
        obstacle: in the world.
        links: to look at; by default all that have a surface and move.

    Raises:
        InputError: a link that has no surface.
    """

    def __init__(self, robot: Robot, obstacle: Obstacle, *, links: tuple[str, ...] | None = None) -> None:
        names = moving_links(robot) if links is None else links
        unknown = [name for name in names if name not in robot.link_names]
        if unknown:
            raise InputError(f"links: '{unknown[0]}' has no surface; there are {', '.join(robot.link_names)}")
        self.robot, self.obstacle, self.links = robot, obstacle, names
        self._shape = None if isinstance(obstacle, SphereObstacle) else ObstacleCore(obstacle)
        self._surfaces = {name: robot.surface(name) for name in names}

    def touching(self, q: FloatArray) -> list[DeepestPoint]:
        """One for each link that penetrates the obstacle at `q`, deepest first."""
        found = [found for link in self.links if (found := self.near(q, link, 0.0)) is not None]
        return sorted(found, key=lambda contact: -contact.penetration)

    def near(self, q: FloatArray, link: str, margin: float) -> DeepestPoint | None:
        """The deepest point of `link`, or None where the gap exceeds `margin` [m]."""
        pose = self.robot.link_pose(q, link)
        center, radius = link_body(self.robot, link, self._surfaces[link]).ball
        middle = pose[:3, :3] @ center + pose[:3, 3]
        if float(self.obstacle.signed_distance(middle[None])[0]) > radius + margin:
            return None
        contact = self._deepest(pose, link, margin)
        return contact if contact is not None and contact.penetration > -margin else None

    def at(self, q: FloatArray, link: str) -> DeepestPoint:
        """The deepest point of `link`, whether it touches or not."""
        contact = self._deepest(self.robot.link_pose(q, link), link, np.inf)
        assert contact is not None
        return contact

    def single(self, q: FloatArray, contact: DeepestPoint) -> bool:
        """Whether all of the link that is in the obstacle lies under the tangent plane at the deepest point.

        If not, the obstacle is in a fold of the link: it would touch at several points, and the deepest one
        jumps between them.
        """
        pose = self.robot.link_pose(q, contact.link)
        samples = link_body(self.robot, contact.link, self._surfaces[contact.link]).samples
        points = samples @ pose[:3, :3].T + pose[:3, 3]
        within = points[self.obstacle.signed_distance(points) < 0.0]
        rise = (within - contact.point) @ contact.normal
        return not (rise > _RISE * contact.penetration + _LEAST_RISE).any()

    def _deepest(self, pose: FloatArray, link: str, margin: float) -> DeepestPoint | None:
        surface = self._surfaces[link]
        rotation, origin = pose[:3, :3], pose[:3, 3]
        if self._shape is None:
            return _at_center(surface, link, rotation, origin, self.obstacle)
        body = link_body(self.robot, link, surface)
        on_link, on_core = self._shape.nearest(body, rotation, origin)
        gap = float(np.linalg.norm(on_core - on_link))
        if gap > self.obstacle.rounding + margin + _TESSELLATION:
            return None
        if body.exact and gap > 0.0:
            on_link, on_core = self._polish(surface, rotation, origin, on_core)
        arm = on_core - on_link
        distance = float(np.linalg.norm(arm))
        normal = arm / distance if distance > 1e-12 else np.zeros(3)
        return DeepestPoint(link, on_link, normal, self.obstacle.rounding - distance)

    def _polish(
        self, surface: Surface, rotation: FloatArray, origin: FloatArray, on_core: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        least, best, step = np.inf, (on_core, on_core), 1.0
        before, slope_before = on_core, np.zeros(3)
        for turn in range(_ROUNDS):
            local = surface.closest_points(((on_core - origin) @ rotation)[None]).points[0]
            on_link = rotation @ local + origin
            slope = on_core - on_link
            gap = float(np.sqrt(slope @ slope))
            way, change = on_core - before, slope - slope_before
            length, product = float(way @ way), float(way @ change)
            if gap < least:
                least, best = gap, (on_link, on_core)
                step = length / product if turn and product > 1e-3 * length else 1.0
            else:  # A long step that led away is taken back; a plain projection never leads away.
                (on_link, on_core), step = best, 1.0
                slope = on_core - on_link
            before, slope_before = on_core, slope
            on_core = self.obstacle.project((on_core - max(step, 1.0) * slope)[None])[0]
            if float(np.abs(on_core - before).max()) < _STILL:
                break
        return best


def _at_center(
    surface: Surface, link: str, rotation: FloatArray, origin: FloatArray, sphere: Obstacle
) -> DeepestPoint:
    center = (sphere.center - origin) @ rotation
    closest = surface.closest_points(center[None])
    point, distance = closest.points[0], float(closest.distances[0])
    arm = center - point
    outside = float(arm @ closest.normals[0]) > _CLEAR * distance or not inside(surface, center)
    sign = 1.0 if outside else -1.0
    normal = sign * arm / distance if distance > 1e-9 else closest.normals[0]
    penetration = sphere.rounding - sign * distance
    return DeepestPoint(link, rotation @ point + origin, rotation @ normal, penetration)


def inside(surface: Surface, point: FloatArray) -> bool:
    """Whether `point` (3,) [m], link frame, is in the body.

    A ray from it then meets the surface an odd number of times. On a surface that is not closed, the side of
    the nearest triangle decides.
    """
    if not surface.watertight:
        closest = surface.closest_points(point[None])
        return float((point - closest.points[0]) @ closest.normals[0]) < 0.0
    hits = surface.cast_rays(point[None], _RAY)
    return len(hits.distance) % 2 == 1


_RAY = np.array([[0.36, 0.48, 0.8]])


def moving_links(robot: Robot) -> tuple[str, ...]:
    """Links with a surface that some joint moves."""
    q = robot.neutral()
    return tuple(link for link in robot.link_names if np.abs(robot.jacobian(q, link)).max() > 0.0)

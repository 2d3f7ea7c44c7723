"""Where a link's true surface and an obstacle meet deepest.

The deepest point is the point of the link's surface that is nearest to the obstacle's core; the contact normal
runs between the two, also on edges and corners of the mesh. For a sphere this is exact: the nearest surface
point to its centre. For a pole and a cube, the distance of the core's points from the link is minimised over
the core: from a grid of starts, by projected gradient steps whose length follows Barzilai and Borwein (1988).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contactsense import Robot, Surface
from contactsense.errors import InputError

from ._arrays import FloatArray
from .obstacles import Obstacle, SphereObstacle

_ROUNDS = 80
_STILL = 1e-9  # [m]
# Below this cosine between the triangle's normal and the way to the query, the side is checked with a ray.
_CLEAR = 0.2


@dataclass(frozen=True)
class DeepestPoint:
    """Where one link comes nearest to, or is deepest in, an obstacle; world frame."""

    link: str
    point: FloatArray  # (3,) on the link's surface [m]
    normal: FloatArray  # (3,) unit, from the link towards the obstacle
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
        self._surfaces = {name: robot.surface(name) for name in names}
        self._balls = {name: _bounding_ball(surface) for name, surface in self._surfaces.items()}

    def touching(self, q: FloatArray) -> list[DeepestPoint]:
        """One for each link that penetrates the obstacle at `q`, deepest first."""
        found = [found for link in self.links if (found := self.near(q, link, 0.0)) is not None]
        return sorted(found, key=lambda contact: -contact.penetration)

    def clearance(self, q: FloatArray, link: str) -> float:
        """Gap between `link` and the obstacle [m], negative in contact."""
        return -self.at(q, link).penetration

    def near(self, q: FloatArray, link: str, margin: float) -> DeepestPoint | None:
        """The deepest point of `link`, or None where the gap exceeds `margin` [m]."""
        pose = self.robot.link_pose(q, link)
        center, radius = self._balls[link]
        middle = pose[:3, :3] @ center + pose[:3, 3]
        if float(self.obstacle.signed_distance(middle[None])[0]) > radius + margin:
            return None
        contact = self._deepest(pose, link)
        return contact if contact.penetration > -margin else None

    def at(self, q: FloatArray, link: str) -> DeepestPoint:
        """The deepest point of `link`, whether it touches or not."""
        return self._deepest(self.robot.link_pose(q, link), link)

    def _deepest(self, pose: FloatArray, link: str) -> DeepestPoint:
        surface = self._surfaces[link]
        rotation, origin = pose[:3, :3], pose[:3, 3]
        core = (self.obstacle.starts() - origin) @ rotation
        if not isinstance(self.obstacle, SphereObstacle):
            core = self._nearest_of_core(surface, core, rotation, origin)[None]
        closest = surface.closest_points(core)
        point, distance = closest.points[0], float(closest.distances[0])
        arm = core[0] - point
        outside = float(arm @ closest.normals[0]) > _CLEAR * distance or not inside(surface, core[0])
        sign = 1.0 if outside else -1.0
        normal = sign * arm / distance if distance > 1e-9 else closest.normals[0]
        penetration = self.obstacle.rounding - sign * distance
        return DeepestPoint(link, rotation @ point + origin, rotation @ normal, penetration)

    def _nearest_of_core(
        self, surface: Surface, starts: FloatArray, rotation: FloatArray, origin: FloatArray
    ) -> FloatArray:
        """(3,) the point of the core nearest to the surface, link frame."""
        reach = float(np.linalg.norm(starts[1] - starts[0]))
        distances = surface.closest_points(starts).distances
        # The distance changes by no more than the way between two points: farther starts cannot win.
        order = np.argsort(distances)
        order = order[distances[order] < distances[order[0]] + reach][:_STARTS]
        points = starts[order]
        steps = np.ones((len(points), 1))
        best, least = points[0], float(distances[order[0]])
        before, slope_before = points, np.zeros_like(points)
        for turn in range(_ROUNDS):
            closest = surface.closest_points(points)
            slope = points - closest.points
            k = int(np.argmin(closest.distances))
            if closest.distances[k] < least:
                best, least = points[k], float(closest.distances[k])
            if turn:
                way, change = points - before, slope - slope_before
                product = (way * change).sum(axis=1, keepdims=True)
                length = (way * way).sum(axis=1, keepdims=True)
                steps = np.where(product > 1e-3 * length, length / np.maximum(product, 1e-300), 1.0)
            before, slope_before = points, slope
            world = (points - steps * slope) @ rotation.T + origin
            points = (self.obstacle.project(world) - origin) @ rotation
            if float(np.abs(points - before).max()) < _STILL:
                break
        return best


_STARTS = 4


def inside(surface: Surface, point: FloatArray) -> bool:
    """Whether `point` (3,), link frame, is in the body: a ray from it leaves as often as it enters, and once more.

    On a surface that is not closed, the side of the nearest triangle decides.
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


def _bounding_ball(surface: Surface) -> tuple[FloatArray, float]:
    vertices = surface.vertices
    center = 0.5 * (vertices.min(axis=0) + vertices.max(axis=0))
    # Primitives bulge a little beyond their tessellation.
    return center, 1.02 * float(np.linalg.norm(vertices - center, axis=1).max()) + 1e-3

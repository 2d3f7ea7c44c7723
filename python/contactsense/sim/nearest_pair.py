"""Nearest points of a link's triangles and the core of a cube or a pole, with coal."""

from __future__ import annotations

from typing import Any
from weakref import WeakKeyDictionary

import coal
import numpy as np

from contactsense import Robot, Surface

from ._arrays import FloatArray
from .obstacles import CubeObstacle, CylinderObstacle

# Points of a link to look at one by one.
_SAMPLES = 4000
# Relative accuracy of coal's distances.
_TOLERANCE = 1e-9


class LinkBody:
    """A link's triangles as coal searches them, and a sphere around all of it."""

    def __init__(self, surface: Surface) -> None:
        vertices, triangles = surface.vertices, surface.triangles
        points, corners = coal.StdVec_Vec3s(), coal.StdVec_Triangle()
        for vertex in vertices:
            points.append(vertex)
        for a, b, c in triangles.tolist():
            corners.append(coal.Triangle(a, b, c))
        self.model = coal.BVHModelOBBRSS()
        self.model.beginModel(len(triangles), len(vertices))
        self.model.addSubModel(points, corners)
        self.model.endModel()
        # Exact primitives answer without a triangle.
        self.exact = bool((surface.closest_points(vertices[:1]).triangles < 0).all())
        self.samples = surface.sample(_SAMPLES).points
        center = 0.5 * (vertices.min(axis=0) + vertices.max(axis=0))
        # Primitives bulge a little beyond their tessellation.
        self.ball = center, 1.02 * float(np.linalg.norm(vertices - center, axis=1).max()) + 1e-3


# Shared by all queries of a robot.
_KNOWN: WeakKeyDictionary[Robot, dict[str, LinkBody]] = WeakKeyDictionary()


def link_body(robot: Robot, link: str, surface: Surface) -> LinkBody:
    """The link's body, made at first need."""
    known = _KNOWN.setdefault(robot, {})
    if link not in known:
        known[link] = LinkBody(surface)
    return known[link]


class ObstacleCore:
    """The core of a cube or a pole as coal knows it."""

    def __init__(self, obstacle: CubeObstacle | CylinderObstacle) -> None:
        if isinstance(obstacle, CubeObstacle):
            self._shape: Any = coal.Box(*np.maximum(2.0 * obstacle.core, 1e-9))
            rotation = obstacle.rotation
        else:
            self._shape = coal.Capsule(0.0, 2.0 * obstacle.half_length)
            rotation = obstacle.frame
        self._pose = coal.Transform3s(rotation, obstacle.center)
        self._request = coal.DistanceRequest()
        self._request.gjk_tolerance = _TOLERANCE

    def nearest(
        self, body: LinkBody, rotation: FloatArray, origin: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """World points, each (3,), of the surface and of the core; the same where they cross."""
        result = coal.DistanceResult()
        pose = coal.Transform3s(rotation, origin)
        distance = coal.distance(body.model, pose, self._shape, self._pose, self._request, result)
        first = np.array(result.getNearestPoint1(), dtype=np.float64)
        second = np.array(result.getNearestPoint2(), dtype=np.float64)
        return first, second if distance > 0.0 else first

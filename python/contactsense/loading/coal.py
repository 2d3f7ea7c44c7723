"""Collision geometry of Pinocchio (coal) as plain numbers and arrays, and back."""

from __future__ import annotations

from typing import Any

import coal
import numpy as np

from ..errors import GeometryError
from .description import Shape

_SUPPORTED = "triangle meshes (BVHModel), Convex, Box, Cylinder, Sphere, Capsule"


def shape_of(geometry: Any, name: str, mirrored: bool = False) -> Shape:
    """Kind and parameters of a coal geometry; `GeometryError` with the object's name where not supported.

    `mirrored`: the mesh file was scaled by a negative factor, which turned its triangles inside out.
    """
    owner = f"geometry object '{name}'"
    kind = type(geometry).__name__
    if kind.startswith("BVHModel"):
        count = int(geometry.num_tris)
        return _mesh(geometry.vertices(), [geometry.tri_indices(i) for i in range(count)], mirrored, owner)
    if kind == "Convex":
        polygons = geometry.polygons
        return _mesh(
            geometry.points(), [polygons(i) for i in range(int(geometry.num_polygons))], mirrored, owner
        )
    if kind == "Box":
        return "box", _positive(2.0 * np.asarray(geometry.halfSide, dtype=np.float64), owner)
    if kind == "Sphere":
        return "sphere", _positive([geometry.radius], owner)
    if kind == "Cylinder":
        return "cylinder", _positive([geometry.radius, 2.0 * geometry.halfLength], owner)
    if kind == "Capsule":
        return "capsule", _positive([geometry.radius, 2.0 * geometry.halfLength], owner)
    raise GeometryError(f"{owner} is a {kind}; supported: {_SUPPORTED}")


def geometry_of(shape: Shape) -> Any:
    """The coal geometry of a mesh or a capsule."""
    kind, params = shape
    if kind == "capsule":
        return coal.Capsule(*params)
    vertices, triangles = params
    mesh = coal.BVHModelOBBRSS()
    mesh.beginModel(len(triangles), len(vertices))
    mesh.addVertices(vertices)
    mesh.addTriangles(triangles.astype(np.int64))
    mesh.endModel()
    return mesh


def _mesh(vertices: Any, faces: list[Any], mirrored: bool, owner: str) -> Shape:
    points = np.array(vertices, dtype=np.float64).reshape(-1, 3)
    if not faces:
        raise GeometryError(f"{owner} has no triangles")
    # coal keeps the scale of a mesh file in the vertices.
    order = (0, 2, 1) if mirrored else (0, 1, 2)
    triangles = np.array([[face[i] for i in order] for face in faces], dtype=np.uint32)
    if not np.isfinite(points).all() or triangles.max() >= len(points):
        raise GeometryError(f"{owner} has vertices that are not finite or triangles that name none")
    return "mesh", (points, triangles)


def _positive(sizes: Any, owner: str) -> tuple[float, ...]:
    values = tuple(float(size) for size in sizes)
    if not all(0.0 < value < np.inf for value in values):
        raise GeometryError(f"{owner}: sizes must be positive and finite, not {', '.join(map(str, values))}")
    return values

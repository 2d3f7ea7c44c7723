"""All hits of a line with a triangle mesh: trimesh for the mesh, embree for the search."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import trimesh
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]

MAX_HITS = 100


class Hit(NamedTuple):
    """In the frame of the mesh."""

    distance: float
    point: FloatArray
    normal: FloatArray
    pushing: bool


class ReferenceSurface:
    """A mesh and its embree scene.

    trimesh's own `mesh.ray` does the same for batches, but takes 100 us for one line, so the scene is asked
    directly. Embree (f32) says which triangle is next; where it is follows from the triangle's plane in f64.
    """

    def __init__(self, vertices: FloatArray, triangles: NDArray[np.int64]) -> None:
        mesh = trimesh.Trimesh(vertices, triangles, process=False)
        self.corners = mesh.triangles[:, 0, :].view(np.ndarray).copy()
        self.normals = mesh.face_normals.view(np.ndarray).copy()
        low, high = mesh.bounds
        self.centre = 0.5 * (low + high)
        self.radius = float(np.linalg.norm(mesh.vertices - self.centre, axis=1).max())
        self.advance = 1e-5 * self.radius
        self.scene = EmbreeScene()
        TriangleMesh(self.scene, mesh.triangles.astype(np.float32))
        self.origin32 = np.zeros((1, 3), dtype=np.float32)
        self.direction32 = np.zeros((1, 3), dtype=np.float32)

    def line_hits(self, start: FloatArray, direction: FloatArray) -> list[Hit]:
        """All hits of the line through `start` along the unit vector `direction`, in order."""
        to_centre = self.centre - start
        along = float(to_centre.dot(direction))
        if to_centre.dot(to_centre) - along * along > self.radius * self.radius:
            return []
        distance = along - 1.1 * self.radius
        self.direction32[0] = direction
        hits: list[Hit] = []
        last = -1
        for _ in range(MAX_HITS):
            self.origin32[0] = start + direction * distance
            triangle = int(self.scene.run(self.origin32, self.direction32)[0])
            if triangle < 0:
                break
            normal = self.normals[triangle]
            slope = float(normal.dot(direction))
            if triangle != last and slope != 0.0:
                distance = float(normal.dot(self.corners[triangle] - start)) / slope
                hits.append(Hit(distance, start + direction * distance, normal, slope < 0.0))
            last = triangle
            distance += self.advance
        return hits

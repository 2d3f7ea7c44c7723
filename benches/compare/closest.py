"""`Surface.closest_points` beside libigl, fcpw and trimesh: 10,000 queries 3 mm off the surface."""

from __future__ import annotations

import fcpw
import numpy as np
import trimesh
from trimesh.proximity import closest_point

from .meshes import MeshCase, cases
from .peers import columns32, fcpw_scene, igl_tree
from .timing import Comparison, Contestant, Pace, interleave

BATCH = 10_000
TRIMESH_BATCH = 500  # it takes long
OFFSET = 3e-3  # [m]
MAX_US = 1.0


def compare(pace: Pace) -> list[Comparison]:
    """Two meshes of 5,120 triangles."""
    return [_compare(case, pace) for case in cases()]


def _compare(case: MeshCase, pace: Pace) -> Comparison:
    samples = case.surface.sample(BATCH, seed=1)
    points = samples.points + OFFSET * samples.normals
    points32, radii = columns32(points), np.full(BATCH, np.inf, dtype=np.float32)
    tree, scene, mesh = igl_tree(case), fcpw_scene(case), trimesh.Trimesh(case.vertices, case.triangles)
    found = fcpw.interaction_3D_list()

    distances = case.surface.closest_points(points).distances
    squared, _, _ = tree.squared_distance(case.vertices, case.triangles, points)
    np.testing.assert_allclose(np.sqrt(squared), distances, rtol=0, atol=1e-9)
    scene.find_closest_points(points32, radii, found)
    np.testing.assert_allclose([hit.d for hit in found], distances, rtol=0, atol=1e-5)
    few = points[:TRIMESH_BATCH]
    # trimesh takes candidates within 1e-8 and can miss the nearest of them by a little.
    np.testing.assert_allclose(closest_point(mesh, few)[1], distances[: len(few)], rtol=0, atol=1e-6)

    names = {"points": points, "points32": points32, "radii": radii, "found": found, "scene": scene}
    names |= {"surface": case.surface, "tree": tree, "vertices": case.vertices, "triangles": case.triangles}
    names |= {"closest_point": closest_point, "mesh": mesh, "few": few}
    contestants = [
        Contestant("contactsense (f64)", "surface.closest_points(points)", names, BATCH),
        Contestant("libigl (f64)", "tree.squared_distance(vertices, triangles, points)", names, BATCH),
        Contestant("fcpw (f32)", "scene.find_closest_points(points32, radii, found)", names, BATCH),
        Contestant("trimesh (f64)", "closest_point(mesh, few)", names, len(few)),
    ]
    return Comparison(f"closest point, {case.name}", interleave(contestants, pace), max_us=MAX_US)

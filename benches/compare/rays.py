"""`Surface.cast_rays`, all hits, beside libigl, trimesh with embree, and fcpw: 10,000 random rays."""

from __future__ import annotations

from typing import Any

import fcpw
import numpy as np
import trimesh
from numpy.typing import NDArray

from .meshes import RADIUS, MeshCase, cases
from .peers import fcpw_scene, igl_tree
from .timing import Comparison, Contestant, Pace, interleave

FloatArray = NDArray[np.float64]

BATCH = 10_000
MAX_US = 1.3
AGREE = 0.99  # share of hits


def compare(pace: Pace) -> list[Comparison]:
    """Two meshes of 5,120 triangles."""
    return [_compare(case, pace) for case in cases()]


def _compare(case: MeshCase, pace: Pace) -> Comparison:
    origins, directions = _random_rays(np.random.default_rng(2))
    tree, scene = igl_tree(case), fcpw_scene(case)
    mesh = trimesh.Trimesh(case.vertices, case.triangles, process=False)
    rays32 = list(zip(origins.astype(np.float32), directions.astype(np.float32), strict=True))

    hits = case.surface.cast_rays(origins, directions)
    ours = set(zip(hits.ray.tolist(), hits.triangle.tolist(), strict=True))
    found = tree.intersect_ray(case.vertices, case.triangles, origins, directions)
    _check(ours, {(k, hit[0]) for k, row in enumerate(found) for hit in row})
    _, ray, triangle = mesh.ray.intersects_location(origins, directions)
    _check(ours, set(zip(ray.tolist(), triangle.tolist(), strict=True)))
    found = _fcpw_all(scene, rays32)
    _check(ours, {(k, hit.primitive_index) for k, row in enumerate(found) for hit in row})

    names: dict[str, Any] = {"surface": case.surface, "tree": tree, "scene": scene, "mesh": mesh}
    names |= {"vertices": case.vertices, "triangles": case.triangles, "fcpw_all": _fcpw_all}
    names |= {"origins": origins, "directions": directions, "rays32": rays32}
    contestants = [
        Contestant("contactsense (f64)", "surface.cast_rays(origins, directions)", names, BATCH),
        Contestant(
            "trimesh, embree (f32)", "mesh.ray.intersects_location(origins, directions)", names, BATCH
        ),
        Contestant(
            "libigl (f64)", "tree.intersect_ray(vertices, triangles, origins, directions)", names, BATCH
        ),
        Contestant("fcpw (f32), a call a ray", "fcpw_all(scene, rays32)", names, BATCH),
    ]
    return Comparison(f"all hits of a ray, {case.name}", interleave(contestants, pace), max_us=MAX_US)


def _random_rays(rng: np.random.Generator) -> tuple[FloatArray, FloatArray]:
    """From a sphere around the mesh to points uniform in a ball inside it."""
    origins = _unit(rng.normal(size=(BATCH, 3))) * 2.0 * RADIUS
    targets = _unit(rng.normal(size=(BATCH, 3))) * RADIUS * np.cbrt(rng.uniform(size=(BATCH, 1)))
    return origins, _unit(targets - origins)


def _unit(rows: FloatArray) -> FloatArray:
    unit: FloatArray = rows / np.linalg.norm(rows, axis=1, keepdims=True)
    return unit


def _check(ours: set[tuple[int, int]], theirs: set[tuple[int, int]]) -> None:
    """The same triangles are hit by the same rays, but for edges and tangents in f32."""
    share = len(ours & theirs) / len(ours | theirs)
    assert share > AGREE, f"{share:.4f} of the hits agree"


def _fcpw_all(scene: Any, rays32: list[tuple[NDArray[np.float32], NDArray[np.float32]]]) -> list[Any]:
    """fcpw gives all hits of one ray, not of a batch."""
    rows = []
    for origin, direction in rays32:
        found = fcpw.interaction_3D_list()
        scene.intersect(fcpw.ray_3D(origin, direction), found, False, True)
        rows.append(found)
    return rows

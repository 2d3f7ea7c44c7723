"""Set-up that peers need before they answer; none of it is timed."""

from __future__ import annotations

from typing import Any

import fcpw
import igl
import numpy as np
from numpy.typing import ArrayLike, NDArray

from .meshes import MeshCase


def fcpw_scene(case: MeshCase) -> Any:
    """A vectorised tree, by the surface area heuristic (f32)."""
    scene = fcpw.scene_3D()
    scene.set_object_count(1)
    scene.set_object_vertices(columns32(case.vertices), 0)
    scene.set_object_triangles(np.asfortranarray(case.triangles, dtype=np.int32), 0)
    scene.build(fcpw.aggregate_type.bvh_surface_area, True)
    return scene


def columns32(array: ArrayLike) -> NDArray[np.float32]:
    """The layout that fcpw asks for."""
    return np.asfortranarray(array, dtype=np.float32)


def igl_tree(case: MeshCase) -> Any:
    """libigl's tree (f64)."""
    tree = igl.AABB()
    tree.init(case.vertices, case.triangles)
    return tree

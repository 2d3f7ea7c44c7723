"""Meshes of 5,120 triangles, as our surfaces and as arrays for the peers."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
import trimesh
from numpy.typing import NDArray

import contactsense as cs

RADIUS = 0.15  # [m]
URDF = """<robot name="ball"><link name="ball">
<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>
<collision><geometry><mesh filename="ball.obj"/></geometry></collision>
</link></robot>"""


class MeshCase(NamedTuple):
    """One mesh; the peers get the vertices and triangles that our surface has."""

    name: str
    surface: cs.Surface
    vertices: NDArray[np.float64]
    triangles: NDArray[np.int64]


def cases() -> Iterator[MeshCase]:
    """An icosphere, and the same with bumps, which is not convex."""
    ball = trimesh.creation.icosphere(subdivisions=4, radius=RADIUS)
    yield _case("icosphere", ball)
    x, y, z = (ball.vertices / RADIUS).T
    bumps = 1.0 + 0.2 * np.sin(9.0 * x + 1.0) * np.sin(8.0 * y) + 0.15 * np.sin(10.0 * z)
    yield _case("bumpy", trimesh.Trimesh(ball.vertices * bumps[:, None], ball.faces, process=False))


def _case(name: str, mesh: trimesh.Trimesh) -> MeshCase:
    with tempfile.TemporaryDirectory() as folder:
        mesh.export(Path(folder) / "ball.obj", digits=17)
        path = Path(folder) / "ball.urdf"
        path.write_text(URDF)
        surface = cs.Robot.from_urdf(path, floating_base=True).surface("ball")
    assert surface.watertight
    triangles = surface.triangles
    return MeshCase(f"{name}, {len(triangles)} triangles", surface, surface.vertices, triangles)

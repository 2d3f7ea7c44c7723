"""An arm whose links are one mesh, which is not convex; its kinematics are those of another URDF."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import trimesh

# Vertices are multiples of it [m]: exact in the single precision of a mesh reader.
GRID = 2.0**-14


def _bumpy() -> trimesh.Trimesh:
    """A body of 320 triangles, 11 to 16 cm wide and 23 cm long, with dents."""
    ball = trimesh.creation.icosphere(subdivisions=2)
    x, y, z = ball.vertices.T
    radius = 0.075 * (1.0 + 0.15 * np.sin(5.0 * x) * np.cos(4.0 * y) + 0.1 * np.sin(6.0 * z + 1.0))
    vertices = ball.vertices * radius[:, None] * [1.0, 1.0, 1.4]
    mesh = trimesh.Trimesh(np.round(vertices / GRID) * GRID, ball.faces, process=False)
    assert mesh.is_watertight
    assert not mesh.is_convex
    return mesh


def write(source: Path, folder: Path) -> Path:
    """Writes `meshed_arm.urdf` and its mesh into `folder`; the URDF's path."""
    mesh = _bumpy()
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in mesh.vertices.tolist()]
    lines += [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in mesh.faces.tolist()]
    (folder / "bumpy_link.obj").write_text("\n".join(lines) + "\n", encoding="utf-8")
    root = ElementTree.parse(source).getroot()
    root.set("name", "meshed_arm")
    for link in root.findall("link"):
        shapes = link.findall("visual") + link.findall("collision")
        for shape in shapes:
            link.remove(shape)
        if shapes and link is not root.find("link"):
            collision = ElementTree.SubElement(link, "collision")
            at = link.find("inertial/origin").get("xyz")
            ElementTree.SubElement(collision, "origin", xyz=at)
            geometry = ElementTree.SubElement(collision, "geometry")
            ElementTree.SubElement(geometry, "mesh", filename="bumpy_link.obj")
    ElementTree.indent(root)
    path = folder / "meshed_arm.urdf"
    ElementTree.ElementTree(root).write(path, encoding="utf-8")
    path.write_text(path.read_text(encoding="utf-8") + "\n", encoding="utf-8")
    return path

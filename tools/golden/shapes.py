"""Collision shapes of a URDF: points drawn on them in closed form, and triangles for trimesh."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pinocchio as pin
import trimesh

# Triangles differ from round shapes by at most 0.2 % of the radius.
SECTIONS = 64
# Points keep away from edges, where a normal is not defined [m].
EDGE = 1e-3


def _numbers(text: str | None, default: str = "0 0 0") -> np.ndarray:
    return np.array((text or default).split(), dtype=float)


@dataclass(frozen=True)
class Shape:
    """One shape of a link. `pose` `(4, 4)` and `mesh` are in the link frame."""

    kind: str
    size: np.ndarray
    pose: np.ndarray
    mesh: trimesh.Trimesh

    @classmethod
    def read(cls, collision: ElementTree.Element, folder: Path) -> Shape:
        """From a `<collision>` element; mesh files are in `folder`."""
        origin = collision.find("origin")
        attributes = origin.attrib if origin is not None else {}
        pose = np.eye(4)
        pose[:3, :3] = pin.rpy.rpyToMatrix(_numbers(attributes.get("rpy")))
        pose[:3, 3] = _numbers(attributes.get("xyz"))
        element = collision.find("geometry")[0]
        if element.tag == "mesh":
            size = np.zeros(0)
            mesh = trimesh.load(folder / element.get("filename"), process=False)
        else:
            names = {"box": ("size",), "sphere": ("radius",)}.get(element.tag, ("radius", "length"))
            size = np.concatenate([_numbers(element.get(name)) for name in names])
            mesh = _triangles(element.tag, size)
        assert mesh.is_watertight
        return cls(element.tag, size, pose, mesh.apply_transform(pose))

    def draw(self, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
        """A point by area and its outward normal, link frame."""
        if self.kind == "mesh":
            face = rng.choice(len(self.mesh.faces), p=self.mesh.area_faces / self.mesh.area)
            weights = 0.85 * rng.dirichlet(np.ones(3)) + 0.05
            return weights @ self.mesh.triangles[face], self.mesh.face_normals[face]
        point, normal = _DRAW[self.kind](self.size, rng)
        return self.pose[:3, :3] @ point + self.pose[:3, 3], self.pose[:3, :3] @ normal

    def nearest(self, point: np.ndarray) -> tuple[float, np.ndarray]:
        """Distance from a point, negative inside, and the nearest place on the surface, link frame."""
        triangles = self.mesh.triangles
        places = trimesh.triangles.closest_point(triangles, np.broadcast_to(point, (len(triangles), 3)))
        distances = np.linalg.norm(places - point, axis=1)
        face = int(np.argmin(distances))
        inside = (point - places[face]) @ self.mesh.face_normals[face] < 0.0
        return float(-distances[face] if inside else distances[face]), places[face]


def _triangles(kind: str, size: np.ndarray) -> trimesh.Trimesh:
    if kind == "box":
        return trimesh.creation.box(extents=size)
    if kind == "sphere":
        return trimesh.creation.uv_sphere(radius=size[0], count=[SECTIONS // 2, SECTIONS])
    if kind == "cylinder":
        return trimesh.creation.cylinder(radius=size[0], height=size[1], sections=SECTIONS)
    mesh = trimesh.creation.capsule(radius=size[0], height=size[1], count=[SECTIONS // 2, SECTIONS])
    np.testing.assert_allclose(mesh.bounds[:, 2], [-size[1] / 2 - size[0], size[1] / 2 + size[0]])
    return mesh


def _unit(rng: np.random.Generator) -> np.ndarray:
    vector = rng.standard_normal(3)
    return vector / np.linalg.norm(vector)


def _on_box(size: np.ndarray, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    areas = np.prod(size) / size
    axis = rng.choice(3, p=areas / areas.sum())
    normal = np.zeros(3)
    normal[axis] = rng.choice([-1.0, 1.0])
    point = rng.uniform(-1.0, 1.0, 3) * (size / 2 - EDGE)
    point[axis] = normal[axis] * size[axis] / 2
    return point, normal


def _on_sphere(size: np.ndarray, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    normal = _unit(rng)
    return size[0] * normal, normal


def _on_cylinder(size: np.ndarray, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    radius, length = size
    angle = rng.uniform(0.0, 2.0 * np.pi)
    around = np.array([np.cos(angle), np.sin(angle), 0.0])
    if rng.random() < length / (length + radius):
        height = rng.uniform(-1.0, 1.0) * (length / 2 - EDGE)
        return radius * around + [0.0, 0.0, height], around
    side = rng.choice([-1.0, 1.0])
    inside = (radius - EDGE) * np.sqrt(rng.random())
    return inside * around + [0.0, 0.0, side * length / 2], np.array([0.0, 0.0, side])


def _on_capsule(size: np.ndarray, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    radius, length = size
    if rng.random() < length / (length + 2.0 * radius):
        angle = rng.uniform(0.0, 2.0 * np.pi)
        around = np.array([np.cos(angle), np.sin(angle), 0.0])
        return radius * around + [0.0, 0.0, rng.uniform(-0.5, 0.5) * length], around
    normal = _unit(rng)
    return radius * normal + [0.0, 0.0, np.copysign(length / 2, normal[2])], normal


_DRAW = {"box": _on_box, "sphere": _on_sphere, "cylinder": _on_cylinder, "capsule": _on_capsule}

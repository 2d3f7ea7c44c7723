"""A robot for the golden data: Pinocchio's model and trimesh's surfaces."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pinocchio as pin
import trimesh
from trimesh.ray.ray_triangle import RayMeshIntersector

from .shapes import Shape

# A line is cast from so far outside [m].
FAR = 5.0
# Passages and gaps shorter than it are left to rounding [m].
GRAZE = 2e-3


@dataclass(frozen=True)
class Link:
    """A link with a surface."""

    name: str
    joint: int  # Pinocchio's index; 0 is the world
    frame: int
    shapes: tuple[Shape, ...]
    caster: RayMeshIntersector
    mesh: trimesh.Trimesh


@dataclass(frozen=True)
class GoldenRobot:
    """`links` are those with a surface."""

    model: pin.Model
    data: pin.Data
    links: tuple[Link, ...]

    @classmethod
    def read(cls, path: Path, *, floating_base: bool) -> GoldenRobot:
        """From a URDF; its meshes are beside it."""
        text = path.read_text(encoding="utf-8")
        root = (pin.JointModelFreeFlyer(),) if floating_base else ()
        tree = ElementTree.fromstring(text)
        shapes_of = {link.get("name"): link.findall("collision") for link in tree.findall("link")}
        # Pinocchio's reader knows no capsule, and needs no shape for the kinematics.
        for link in tree.findall("link"):
            for shape in link.findall("visual") + link.findall("collision"):
                link.remove(shape)
        model = pin.buildModelFromXML(ElementTree.tostring(tree, encoding="unicode"), *root)
        links = []
        for name, elements in shapes_of.items():
            shapes = tuple(Shape.read(element, path.parent) for element in elements)
            if shapes:
                frame = model.getFrameId(name, pin.FrameType.BODY)
                mesh = trimesh.util.concatenate([shape.mesh for shape in shapes])
                joint = model.frames[frame].parentJoint
                links.append(Link(name, joint, frame, shapes, RayMeshIntersector(mesh), mesh))
        return cls(model, model.createData(), tuple(links))

    def configuration(self, rng: np.random.Generator) -> np.ndarray:
        """Joints within 80 % of their limits, in four digits; the base anywhere within a metre."""
        model = self.model
        low, high = model.lowerPositionLimit.copy(), model.upperPositionLimit.copy()
        free = 7 if model.joints[1].nq == 7 else 0
        low[:free], high[:free] = -1.0, 1.0
        q = np.round(0.5 * (low + high) + 0.4 * (high - low) * rng.uniform(-1.0, 1.0, model.nq), 4)
        if free:
            q[3:7] = rng.standard_normal(4)
            q[3:7] /= np.linalg.norm(q[3:7])
        return q

    def place(self, q: np.ndarray) -> None:
        """Poses and Jacobians at `q`, for what follows."""
        pin.computeJointJacobians(self.model, self.data, q)
        pin.framesForwardKinematics(self.model, self.data, q)

    def pose(self, link: Link) -> pin.SE3:
        """Of a link in the world, as placed last."""
        return self.data.oMf[link.frame]

    def jacobian(self, link: Link, point: np.ndarray) -> np.ndarray:
        """At a point of the link, world frame `(6, nv)`: linear, angular."""
        rows = pin.getFrameJacobian(self.model, self.data, link.frame, pin.LOCAL_WORLD_ALIGNED).copy()
        rows[:3] -= pin.skew(point - self.pose(link).translation) @ rows[3:]
        return rows

    def passages(
        self, link: Link, point: np.ndarray, direction: np.ndarray
    ) -> list[tuple[float, float]] | None:
        """Where the line runs inside the link, from and to [m from `point`]; none where it only grazes it."""
        pose = self.pose(link)
        start = pose.actInv(point - FAR * direction)
        along = pose.rotation.T @ direction
        faces, _, places = link.caster.intersects_id(
            start[None], along[None], multiple_hits=True, return_locations=True
        )
        enters = link.mesh.face_normals[faces] @ along < 0.0 if len(faces) else np.zeros(0, dtype=bool)
        steps = sorted(zip((places - start) @ along - FAR, enters, strict=True)) if len(faces) else []
        found, depth, since = [], 0, 0.0
        for at, entering in steps:
            depth += 1 if entering else -1
            if entering and depth == 1:
                since = at
            elif not entering and depth == 0:
                found.append((float(since), float(at)))
        edges = np.ravel(found)
        if depth != 0 or (np.diff(edges) < GRAZE).any():
            return None
        return found

"""MuJoCo's own contact of convex links with an obstacle: an independent check of the penalty contact.

MuJoCo's constraint is made a spring: at a small constant impedance `d` its regularisation
`R = (1 - d) / d W` outweighs the link's own inertia (`W` is MuJoCo's estimate of its inverse), so that the
force is `stiffness * depth / (W (1 - d))` with a direct `solref`; scaled by that factor, it is the stiffness
asked for, exactly at rest and to about one per cent (`d`) in motion.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
import pinocchio as pin

from contactsense import Robot
from contactsense.errors import InputError
from contactsense.sim import (
    ContactForce,
    CubeObstacle,
    Geom,
    Obstacle,
    SimulatedRobot,
    SphereObstacle,
    TorqueNoise,
    mjcf_tree,
)
from contactsense.sim._arrays import FloatArray, not_negative, positive
from contactsense.sim._mujoco import mujoco
from contactsense.sim._text import pose_attributes, text

_IMPEDANCE = 0.01
_OBSTACLE = "obstacle"


@dataclass(frozen=True, eq=False)
class ConvexPart:
    """A convex piece of a link: the hull of `vertices` (n, 3), in the link's frame [m]."""

    link: str
    vertices: FloatArray


def hull_parts(robot: Robot, links: Iterable[str] | None = None) -> tuple[ConvexPart, ...]:
    """Each link's hull as one part; right where links are convex, as those of Franka's arm are."""
    names = robot.link_names if links is None else tuple(links)
    return tuple(ConvexPart(name, robot.surface(name).vertices) for name in names)


class MujocoContact:
    """What `PenaltyContact` is, left to MuJoCo: the obstacle is part of the simulated world.

    Args:
        obstacle: stands still.
        parts: convex pieces of links, or primitives named `link:number` as by `geoms_of`; where several
            touch, each is a spring, and the forces add up.
        stiffness: of each [N/m].
        damping: of each [Ns/m].
        friction: coefficient; 0 = frictionless.

    Raises:
        InputError: names the argument.
    """

    def __init__(
        self,
        obstacle: Obstacle,
        parts: Iterable[ConvexPart | Geom],
        *,
        stiffness: float,
        damping: float = 0.0,
        friction: float = 0.0,
    ) -> None:
        self.obstacle = obstacle
        self.parts = tuple(parts)
        self.stiffness = positive("stiffness", stiffness)
        self.damping = not_negative("damping", damping)
        self.friction = not_negative("friction", friction)

    def arm(self, model: pin.Model, *, dt: float = 0.001, noise: TorqueNoise | None = None) -> SimulatedRobot:
        """The robot in a world with the obstacle in it.

        Raises:
            InputError: a part is on a link that `model` has not.
        """
        for part in self.parts:
            if not model.existFrame(_link(part), pin.FrameType.BODY):
                raise InputError(f"parts: the model has no link '{_link(part)}'")
        root = mjcf_tree(model, dt=dt)
        option = root.find("option")
        assert option is not None
        # One contact for each pair: several springs side by side would be a stiffer one.
        ET.SubElement(option, "flag", multiccd="disable")
        bodies = {body.get("name"): body for body in root.iter("body")}
        assets = ET.SubElement(root, "asset")
        for number, part in enumerate(self.parts):
            joint = _joint(model, part)
            if joint == 0:
                continue  # fixed to the world, as the obstacle is
            _write(part, number, model, bodies[model.names[joint]], assets, self._condim)
        world = root.find("worldbody")
        assert world is not None
        _write_obstacle(world, self.obstacle)
        arm = SimulatedRobot(model, dt=dt, mjcf=ET.tostring(root, encoding="unicode"), noise=noise)
        self._soften(arm)
        return arm

    def apply(self, arm: SimulatedRobot) -> None:
        """Nothing: MuJoCo does it by itself."""

    def to_dict(self) -> dict[str, Any]:
        """Plain values of its settings."""
        return {
            "contact": "MuJoCo",
            "obstacle": self.obstacle.to_dict(),
            "stiffness": self.stiffness,
            "friction": self.friction,
            "damping": self.damping,
        }

    def present(self, arm: SimulatedRobot) -> tuple[ContactForce, ...]:
        """What the obstacle does to each link it touches, now, the hardest first.

        Of several contacts of a link the force is the sum, point and normal are means weighted by force.
        """
        found: dict[str, list[tuple[FloatArray, FloatArray, float, FloatArray]]] = {}
        for k in range(arm.mj_data.ncon):
            contact = arm.mj_data.contact[k]
            wrench = np.zeros(6)
            mujoco.mj_contactForce(arm.mj_model, arm.mj_data, k, wrench)
            names = [arm.mj_model.geom(int(number)).name for number in contact.geom]
            side = names.index(_OBSTACLE)
            # The frame's first row runs from the first geom to the second, and the force is on the second.
            sign = 1.0 if side == 1 else -1.0
            frame = np.array(contact.frame).reshape(3, 3)
            normal = sign * frame[0]
            point = np.array(contact.pos) - 0.5 * contact.dist * normal
            depth = float(contact.includemargin - contact.dist)
            link = names[1 - side].rsplit(":", 1)[0]
            found.setdefault(link, []).append((point, normal, depth, -sign * (wrench[:3] @ frame)))
        merged = [_merge(link, contacts) for link, contacts in found.items()]
        return tuple(sorted(merged, key=lambda contact: -float(np.linalg.norm(contact.force))))

    @property
    def _condim(self) -> int:
        return 3 if self.friction > 0.0 else 1

    def _soften(self, arm: SimulatedRobot) -> None:
        mj = arm.mj_model
        obstacle = mujoco.mj_name2id(mj, mujoco.mjtObj.mjOBJ_GEOM, _OBSTACLE)
        for geom in range(mj.ngeom):
            if geom != obstacle:
                inverse = (1.0 - _IMPEDANCE) * mj.body_invweight0[mj.geom_bodyid[geom], 0]
                mj.geom_solref[geom] = -self.stiffness * inverse, -self.damping * inverse
                mj.geom_solimp[geom] = _IMPEDANCE, _IMPEDANCE, 0.001, 0.5, 2.0
                mj.geom_friction[geom] = self.friction, 0.0, 0.0
        arm.reset(arm.q)


def _merge(link: str, contacts: list[tuple[FloatArray, FloatArray, float, FloatArray]]) -> ContactForce:
    points, normals, depths, forces = (np.array(column) for column in zip(*contacts, strict=True))
    share = np.linalg.norm(forces, axis=1)
    share = share / share.sum() if share.sum() > 0.0 else np.full(len(share), 1.0 / len(share))
    normal = share @ normals
    return ContactForce(
        link, share @ points, normal / np.linalg.norm(normal), float(share @ depths), forces.sum(axis=0)
    )


def _link(part: ConvexPart | Geom) -> str:
    return part.link if isinstance(part, ConvexPart) else part.name.rsplit(":", 1)[0]


def _joint(model: pin.Model, part: ConvexPart | Geom) -> int:
    if isinstance(part, Geom):
        return part.joint
    return int(model.frames[model.getFrameId(part.link, pin.FrameType.BODY)].parentJoint)


def _write(
    part: ConvexPart | Geom, number: int, model: pin.Model, body: ET.Element, assets: ET.Element, condim: int
) -> None:
    if isinstance(part, Geom):
        part.write(body)
        geom = body[-1]
    else:
        name = f"{part.link}:{number}"
        ET.SubElement(assets, "mesh", name=name, vertex=text(np.ravel(part.vertices)))
        frame = model.frames[model.getFrameId(part.link, pin.FrameType.BODY)]
        pose = pose_attributes(np.asarray(frame.placement.homogeneous, dtype=np.float64))
        geom = ET.SubElement(body, "geom", pose, name=name, type="mesh", mesh=name, mass="0")
    # Links meet the obstacle, and not each other; of the two, their settings count.
    for key, value in {"contype": 0, "conaffinity": 1, "condim": condim, "priority": 1}.items():
        geom.set(key, str(value))


def _write_obstacle(world: ET.Element, obstacle: Obstacle) -> None:
    pose = np.eye(4)
    pose[:3, 3] = obstacle.center
    # A rounded edge is a sharp one that acts from a distance on.
    margin = 0.0
    if isinstance(obstacle, SphereObstacle):
        kind, size = "sphere", [obstacle.radius]
    elif isinstance(obstacle, CubeObstacle):
        kind, size, margin = "box", list(np.maximum(obstacle.core, 1e-6)), obstacle.edge_radius
        pose[:3, :3] = obstacle.rotation
    else:
        kind, size = "capsule", [obstacle.radius, obstacle.half_length]
        pose[:3, :3] = obstacle.frame
    geom = ET.SubElement(world, "geom", pose_attributes(pose), name=_OBSTACLE, type=kind, size=text(size))
    geom.set("margin", text([margin]))
    geom.set("contype", "1")
    geom.set("conaffinity", "0")

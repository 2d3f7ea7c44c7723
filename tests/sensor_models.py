"""Force/torque sensors in Pinocchio models: what a sensor at any link reads, and what pushes behind it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pinocchio as pin
from robots import RobotFile

import contactsense as cs


def joints_by_child(path: Path) -> dict[str, ElementTree.Element]:
    joints = ElementTree.parse(path).getroot().findall("joint")
    return {joint.find("child").get("link"): joint for joint in joints}


def random_pose(rng: np.random.Generator) -> np.ndarray:
    pose = np.eye(4)
    pose[:3, :3] = pin.exp3(rng.uniform(-2, 2, 3))
    pose[:3, 3] = rng.uniform(-0.1, 0.1, 3)
    return pose


def adjoint(translation: np.ndarray, wrench: np.ndarray) -> np.ndarray:
    """A wrench about a point at `translation`, about the origin."""
    return np.r_[wrench[:3], wrench[3:] + np.cross(translation, wrench[:3])]


@dataclass
class Motion:
    q: np.ndarray
    v: np.ndarray
    a: np.ndarray


class SensedModel:
    """A robot with sensors, and Pinocchio's model of it in which every sensor's joint is a moving one.

    Fixed joints with a sensor become revolute ones that stand still, so that Pinocchio keeps their force.
    """

    def __init__(self, file: RobotFile, links: list[str], seed: int = 0, conventions: str = "load") -> None:
        rng = np.random.default_rng(seed)
        self.file = file.require()
        self.robot = file.robot()
        self.rng = rng
        self.sensors = [
            cs.ForceTorqueSensor(
                f"S{k}",
                link,
                pose=random_pose(rng),
                convention=conventions if conventions != "mixed" else ("load", "support")[k % 2],
            )
            for k, link in enumerate(links)
        ]
        root = ElementTree.parse(file.path).getroot()
        self.freed = set()
        for joint in root.findall("joint"):
            if joint.find("child").get("link") in links and joint.get("type") == "fixed":
                joint.set("type", "revolute")
                self.freed.add(joint.get("name"))
                for tag in ("axis", "limit"):
                    for old in joint.findall(tag):
                        joint.remove(old)
                ElementTree.SubElement(joint, "limit", lower="-1", upper="1", effort="1", velocity="1")
        text = ElementTree.tostring(root, encoding="unicode")
        base = (pin.JointModelFreeFlyer(),) if file.floating_base else ()
        self.model = pin.buildModelFromXML(text, *base)
        self.data = self.model.createData()
        self.plain = file.model()

    def motion(self, scale: float = 1.0) -> Motion:
        q = pin.integrate(self.plain, pin.neutral(self.plain), self.rng.uniform(-1, 1, self.plain.nv))
        v, a = self.rng.uniform(-scale, scale, (2, self.plain.nv))
        return Motion(q, v, a)

    def spread(self, motion: Motion) -> Motion:
        """The same motion of the model with more joints."""
        q, v, a = pin.neutral(self.model), np.zeros(self.model.nv), np.zeros(self.model.nv)
        for index in range(1, self.plain.njoints):
            here, there = (
                self.plain.joints[index],
                self.model.joints[self.model.getJointId(self.plain.names[index])],
            )
            q[there.idx_q : there.idx_q + there.nq] = motion.q[here.idx_q : here.idx_q + here.nq]
            for target, source in ((v, motion.v), (a, motion.a)):
                target[there.idx_v : there.idx_v + there.nv] = source[here.idx_v : here.idx_v + here.nv]
        return Motion(q, v, a)

    def evaluate(self, motion: Motion, push: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
        """Readings of the sensors, and the external wrenches behind each: world axes, sensor's origin."""
        wide = self.spread(motion)
        external = pin.StdVec_Force()
        for _ in range(self.model.njoints):
            external.append(pin.Force(push * self.rng.uniform(-1, 1, 6)))
        external[0] = pin.Force.Zero()
        pin.rnea(self.model, self.data, wide.q, wide.v, wide.a, external)
        # Turns of joint frames alone: rnea leaves the absolute placements out.
        pin.forwardKinematics(self.model, self.data, wide.q, wide.v, wide.a)
        pin.updateFramePlacements(self.model, self.data)
        readings, seen = [], []
        for sensor in self.sensors:
            frame = self.model.getFrameId(sensor.link, pin.FrameType.BODY)
            joint = self.model.frames[frame].parentJoint
            pose = self.data.oMf[frame] * pin.SE3(sensor.pose)
            sign = -1.0 if sensor.convention == "load" else 1.0
            readings.append(sign * pose.actInv(self.data.oMi[joint].act(self.data.f[joint])).vector)
            at_sensor = pin.SE3(np.eye(3), pose.translation)
            total = pin.Force.Zero()
            for index in self.model.subtrees[joint]:
                total += at_sensor.actInv(self.data.oMi[index].act(external[index]))
            seen.append(total.vector)
        return np.reshape(readings, (-1, 6)), np.reshape(seen, (-1, 6))


def moving_and_fixed_links(file: RobotFile) -> tuple[list[str], list[str]]:
    """Links of moving and of fixed joints, the latter with a parent that moves."""
    joints = joints_by_child(file.path)
    moves: dict[str, bool] = {}

    def is_moved(link: str) -> bool:
        if link not in moves:
            joint = joints.get(link)
            moves[link] = (
                file.floating_base
                if joint is None
                else (joint.get("type") != "fixed" or is_moved(joint.find("parent").get("link")))
            )
        return moves[link]

    moving = [link for link, joint in joints.items() if joint.get("type") != "fixed"]
    fixed = [
        link
        for link, joint in joints.items()
        if joint.get("type") == "fixed" and is_moved(joint.find("parent").get("link"))
    ]
    return moving, fixed

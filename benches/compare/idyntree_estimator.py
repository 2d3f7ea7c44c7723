"""The external wrenches that force/torque sensors see, by iDynTree's estimator."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

import contactsense as cs

FloatArray = NDArray[np.float64]


def sensed_urdf(path: Path, sensors: list[cs.ForceTorqueSensor]) -> str:
    """The URDF without shapes, with the sensors as <sensor> elements, their frames those of their links."""
    root = ElementTree.parse(path).getroot()
    by_child = {joint.find("child").get("link"): joint.get("name") for joint in root.findall("joint")}
    for link in root.findall("link"):
        for shape in link.findall("visual") + link.findall("collision"):
            link.remove(shape)
    for sensor in root.findall("sensor"):
        root.remove(sensor)
    for sensor in sensors:
        element = ElementTree.SubElement(root, "sensor", name=sensor.name, type="force_torque")
        ElementTree.SubElement(element, "parent", joint=str(by_child[sensor.link]))
        entry = ElementTree.SubElement(element, "force_torque")
        ElementTree.SubElement(entry, "frame").text = "child"
        # What the child exerts on its parent is the convention "load".
        ElementTree.SubElement(entry, "measure_direction").text = "child_to_parent"
        ElementTree.SubElement(element, "origin", rpy="0 0 0", xyz="0 0 0")
    return ElementTree.tostring(root, encoding="unicode")


class IdyntreeEstimator:
    """What `LoadCompensator` gives, by `ExtWrenchesAndJointTorquesEstimator`.

    Its submodels end at the sensors; each has one unknown wrench, at the origin of its sensor's link (of the
    base for the first). So a sensor with others behind it sees the sum of several.
    """

    def __init__(self, path: Path, sensors: list[cs.ForceTorqueSensor], joint_names: list[str]) -> None:
        with warnings.catch_warnings():
            # Its binding warns on import, and crashes where that is an error.
            warnings.simplefilter("ignore")
            import idyntree.bindings as idt

        loader = idt.ModelLoader()
        if not loader.loadModelFromString(sensed_urdf(path, sensors), "urdf"):
            raise RuntimeError("iDynTree cannot read the model")
        self.idt = idt
        self.estimator = idt.ExtWrenchesAndJointTorquesEstimator()
        self.estimator.setModel(loader.model())
        model = self.estimator.model()
        self.base = model.getFrameIndex(model.getLinkName(model.getDefaultBaseLink()))
        self.order = [model.getJoint(model.getJointIndex(name)).getDOFsOffset() for name in joint_names]
        self.torques = idt.JointDOFsDoubleArray(model)
        self.contacts = idt.LinkContactWrenches(model)
        self.unknowns = idt.LinkUnknownWrenchContacts(model)
        self.links = [model.getLinkIndex(sensor.link) for sensor in sensors]
        known = model.sensors()
        self.kind = idt.SIX_AXIS_FORCE_TORQUE
        self.rows = [known.getSensorIndex(self.kind, sensor.name) for sensor in sensors]
        if min([*self.rows, *self.links], default=0) < 0:
            raise RuntimeError("iDynTree leaves out a link or sensor")
        for link in [model.getDefaultBaseLink(), *self.links]:
            self.unknowns.addNewUnknownFullWrenchInFrameOrigin(model, link)
        self.readings = idt.SensorsMeasurements(known)
        self.gravity = idt.Vector3.FromPython(np.array([0.0, 0.0, -9.81]))

    def set(self, q: FloatArray, v: FloatArray, a: FloatArray, readings: FloatArray) -> None:
        """Joint positions, velocities, accelerations in the order of `joint_names`; readings, link axes."""
        ordered = np.empty((3, len(self.order)))
        ordered[:, self.order] = q, v, a
        self.q = self.idt.JointPosDoubleArray.FromPython(ordered[0])
        self.v = self.idt.JointDOFsDoubleArray.FromPython(ordered[1])
        self.a = self.idt.JointDOFsDoubleArray.FromPython(ordered[2])
        for row, reading in zip(self.rows, readings, strict=True):
            self.readings.setMeasurement(self.kind, row, self.idt.Wrench.FromPython(reading))

    def estimate(self, base: tuple[Any, Any, Any] | None = None) -> None:
        """`base`: a floating base's proper acceleration, angular velocity and acceleration, its axes."""
        if base is None:
            self.estimator.updateKinematicsFromFixedBase(self.q, self.v, self.a, self.base, self.gravity)
        else:
            moving = [self.idt.Vector3.FromPython(vector) for vector in base]
            self.estimator.updateKinematicsFromFloatingBase(self.q, self.v, self.a, self.base, *moving)
        if not self.estimator.estimateExtWrenchesAndJointTorques(
            self.unknowns, self.readings, self.contacts, self.torques
        ):
            raise RuntimeError("iDynTree gives no estimate")

    def wrenches_on_submodels(self) -> FloatArray:
        """(n_sensors, 6): on the links between each sensor and the next, at its link's origin, link axes."""
        contacts = [self.contacts.contactWrench(link, 0) for link in self.links]
        return np.array(
            [[wrench.getVal(k) for k in range(6)] for wrench in (c.contactWrench for c in contacts)]
        )


def on_submodels(
    robot: cs.Robot,
    q: FloatArray,
    sensors: list[cs.ForceTorqueSensor],
    parents: list[int | None],
    external: FloatArray,
) -> FloatArray:
    """Wrenches of `LoadCompensator`, for sensors without pose, less those of the next behind; link axes."""
    poses = [robot.link_pose(q, sensor.link) for sensor in sensors]
    own = external.copy()
    for child, parent in enumerate(parents):
        if parent is not None:
            arm = poses[child][:3, 3] - poses[parent][:3, 3]
            own[parent, :3] -= external[child, :3]
            own[parent, 3:] -= external[child, 3:] + np.cross(arm, external[child, :3])
    turned = [
        np.r_[pose[:3, :3].T @ w[:3], pose[:3, :3].T @ w[3:]] for pose, w in zip(poses, own, strict=True)
    ]
    return np.array(turned).reshape(-1, 6)

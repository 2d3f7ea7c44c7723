"""A MuJoCo model (MJCF) with exactly the dynamics of a Pinocchio model.

Joints, placements, inertias, armature and gravity are those of the Pinocchio model, so mass matrix, bias
forces and inverse dynamics agree to rounding. There is no damping, friction or joint limit, and no contact
unless asked for: what a momentum observer sees is then motor torque and external force alone.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterable, Sequence
from typing import Any, Literal, TypeAlias

import numpy as np
import pinocchio as pin

from contactsense import ForceTorqueSensor
from contactsense.errors import InputError, ModelError
from contactsense.loading.description import JointTuple

from ._arrays import positive
from ._text import pose_attributes, text
from .floor import Floor
from .geoms import Geom
from .joints import SimulatedJoint, joints
from .sensors import write_sensors

Integrator: TypeAlias = Literal["Euler", "RK4", "implicit", "implicitfast"]

# MuJoCo refuses massless moving bodies; this is far below the rounding of any robot [kg, kg m^2].
_LEAST = 1e-12


def mjcf_string(model: pin.Model, **options: Any) -> str:
    """MJCF text for `model`; options and errors are those of `mjcf_tree`."""
    root = mjcf_tree(model, **options)
    ET.indent(root)
    return ET.tostring(root, encoding="unicode")


def mjcf_tree(
    model: pin.Model,
    *,
    dt: float = 0.001,
    integrator: Integrator = "RK4",
    geoms: Iterable[Geom] = (),
    floor: Floor | None = None,
    sensors: Sequence[ForceTorqueSensor] = (),
) -> ET.Element:
    """MJCF elements for `model`, open to additions (obstacles) before they are written out.

    Bodies and joints bear Pinocchio's joint names; every joint but a free base has a motor of the same name.

    Args:
        model: revolute, prismatic and continuous joints, with or without a free base.
        dt: time step [s].
        integrator: "RK4" follows the true motion closely; "Euler" is MuJoCo's usual semi-implicit one.
        geoms: shapes to attach; without any, nothing collides.
        floor: to stand on, for the geoms that are made to touch it; none by default.
        sensors: force/torque sensors before links that hang on a moving joint.

    Raises:
        ModelError: a joint that MuJoCo lacks, or an inertia that no body can have; names the joint.
        InputError: another argument; names it.
    """
    if integrator not in ("Euler", "RK4", "implicit", "implicitfast"):
        raise InputError(f"integrator must be Euler, RK4, implicit or implicitfast, not {integrator!r}")
    root = ET.Element("mujoco", model=str(model.name) or "robot")
    compiler = {"angle": "radian", "inertiafromgeom": "false", "balanceinertia": "false"}
    ET.SubElement(root, "compiler", compiler, fusestatic="false")
    option = ET.SubElement(root, "option", timestep=text([positive("dt", dt)]), integrator=integrator)
    option.set("gravity", text(model.gravity.linear))
    # MuJoCo 4.0.0 has a fault in its sparse solver; robots are small, dense costs nothing.
    option.set("jacobian", "dense")
    bodies = {0: ET.SubElement(root, "worldbody")}
    motors = ET.SubElement(root, "actuator")
    for joint in joints(model):
        bodies[joint.index] = _body(bodies[joint.body.parent], joint)
        if joint.kind != "free":
            ET.SubElement(motors, "motor", name=joint.name, joint=joint.name)
    for geom in geoms:
        if geom.joint not in bodies:
            raise InputError(f"geoms: '{geom.name}' is on joint {geom.joint}, the last is {len(bodies) - 1}")
        geom.write(bodies[geom.joint])
    if floor is not None:
        floor.write(root, bodies[0])
    write_sensors(root, bodies, model, sensors)
    return root


def _body(parent: ET.Element, joint: SimulatedJoint) -> ET.Element:
    body = ET.SubElement(parent, "body", pose_attributes(joint.body.placement), name=joint.name)
    _inertial(body, joint.body)
    if joint.kind == "free":
        ET.SubElement(body, "freejoint", name=joint.name)
    else:
        element = ET.SubElement(body, "joint", name=joint.name, type=joint.kind)
        element.set("axis", text(joint.body.axis))
        element.set("armature", text([joint.body.armature]))
    return body


def _inertial(body: ET.Element, joint: JointTuple) -> None:
    a, b, c = np.linalg.eigvalsh(joint.inertia)
    if joint.mass < 0 or a < -_LEAST or a + b < c * (1 - 1e-9):
        raise ModelError(
            f"the body behind joint '{joint.name}' has an inertia no body can have (mass {joint.mass:g} kg,"
            f" principal moments {a:g}, {b:g}, {c:g} kg m^2): correct the description"
        )
    tensor = joint.inertia + (_LEAST * np.eye(3) if a < _LEAST else 0.0)
    full = text(tensor[i, j] for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)))
    mass = text([max(joint.mass, _LEAST)])
    ET.SubElement(body, "inertial", pos=text(joint.com), mass=mass, fullinertia=full)

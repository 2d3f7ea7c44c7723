"""The robots: ours and Pinocchio's model of the same description, and motions to follow."""

from __future__ import annotations

from collections.abc import Sequence
from importlib import resources
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

import contactsense as cs

FloatArray = NDArray[np.float64]
Step = tuple[FloatArray, FloatArray, FloatArray]  # q, v, tau

# example-robot-data installs beside Pinocchio.
EXAMPLE_SHARE = Path(pin.__file__).resolve().parents[4] / "share"
PANDA = EXAMPLE_SHARE / "example-robot-data/robots/panda_description/urdf/panda.urdf"
# iiwa14 with meshes, in a folder beside the project that not everyone has.
IIWA14_MESHES = Path(__file__).resolve().parents[3] / "shared/robots/iiwa14/iiwa14.urdf"
TALOS = EXAMPLE_SHARE / "example-robot-data/robots/talos_data/robots/talos_reduced.urdf"


def packaged(name: str) -> tuple[cs.Robot, Any]:
    """A robot of the package ("iiwa14", "atlas") and its Pinocchio model."""
    text = (resources.files("contactsense") / "descriptions" / f"{name}.urdf").read_text()
    root = ElementTree.fromstring(text)
    # The model needs no shapes, and its parser complains of every capsule.
    for link in root.iter("link"):
        for shape in [*link.findall("visual"), *link.findall("collision")]:
            link.remove(shape)
    base = [pin.JointModelFreeFlyer()] if name == "atlas" else []
    return cs.Robot.named(name), pin.buildModelFromXML(ElementTree.tostring(root, "unicode"), *base)


def talos() -> tuple[cs.Robot, Any]:
    """Talos of example-robot-data, floating, and its Pinocchio model.

    Raises:
        FileNotFoundError: example-robot-data is not installed.
    """
    if not TALOS.exists():
        raise FileNotFoundError(f"{TALOS} is absent: install example-robot-data")
    robot = cs.Robot.from_urdf(TALOS, package_dirs=EXAMPLE_SHARE, floating_base=True)
    return robot, pin.buildModelFromUrdf(str(TALOS), pin.JointModelFreeFlyer())


def iiwa14_meshes() -> tuple[str, cs.Robot, Any]:
    """iiwa14 with its meshes where they are there, else the packaged one; and a name that says which."""
    if not IIWA14_MESHES.exists():
        return ("iiwa14 (package)", *packaged("iiwa14"))
    return "iiwa14 (meshes)", cs.Robot.from_urdf(IIWA14_MESHES), pin.buildModelFromUrdf(str(IIWA14_MESHES))


def panda() -> tuple[str, cs.Robot, Any]:
    """The Panda of example-robot-data, its fingers too.

    Raises:
        FileNotFoundError: example-robot-data is not installed.
    """
    if not PANDA.exists():
        raise FileNotFoundError(f"{PANDA} is absent: install example-robot-data")
    robot = cs.Robot.from_urdf(PANDA, package_dirs=EXAMPLE_SHARE)
    return "panda", robot, pin.buildModelFromUrdf(str(PANDA))


def example(path: str, *, floating_base: bool, locked: Sequence[str] = ()) -> tuple[cs.Robot, Any]:
    """A robot of example-robot-data and its Pinocchio model, the `locked` joints at zero.

    Raises:
        FileNotFoundError: example-robot-data is not installed.
    """
    file = EXAMPLE_SHARE / "example-robot-data/robots" / path
    if not file.exists():
        raise FileNotFoundError(f"{file} is absent: install example-robot-data")
    robot = cs.Robot.from_urdf(
        file, package_dirs=EXAMPLE_SHARE, floating_base=floating_base, locked_joints=list(locked) or None
    )
    base = [pin.JointModelFreeFlyer()] if floating_base else []
    model = pin.buildModelFromUrdf(str(file), *base)
    if locked:
        model = pin.buildReducedModel(model, [model.getJointId(name) for name in locked], pin.neutral(model))
    return robot, model


def random_posture(model: Any, rng: np.random.Generator) -> FloatArray:
    """Every joint off its neutral position by up to 1 rad or m, the base by up to that too."""
    q: FloatArray = pin.integrate(model, pin.neutral(model), rng.uniform(-1.0, 1.0, model.nv))
    return q


def motion(model: Any, dt: float, steps: int, rng: np.random.Generator) -> list[Step]:
    """A smooth motion that ends where it began, with the torques that bring it about, `(nv,)`.

    The six torques of a floating base are those of a hoist that carries it.
    """
    start = random_posture(model, rng)
    along = rng.uniform(-1.0, 1.0, model.nv)
    rate = 2.0 * np.pi / (steps * dt)
    path = []
    for phase in rate * dt * np.arange(steps):
        q = pin.integrate(model, start, 0.5 / rate * np.sin(phase) * along)
        v, a = 0.5 * np.cos(phase) * along, -0.5 * rate * np.sin(phase) * along
        path.append((q, v, pin.rnea(model, model.createData(), q, v, a).copy()))
    return path

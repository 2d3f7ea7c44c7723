"""The robots: ours and Pinocchio's model of the same description, and motions to follow."""

from __future__ import annotations

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

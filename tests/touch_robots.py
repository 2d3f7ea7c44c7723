"""Robots to touch in the simulation's tests, each with its Pinocchio model."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pinocchio as pin
from robots import BY_NAME, IIWA14

import contactsense as cs
from contactsense import sim


@cache
def packaged() -> tuple[cs.Robot, pin.Model]:
    """The packaged iiwa14, of exact primitives."""
    return cs.Robot.named("iiwa14"), sim.named_model("iiwa14")


def meshes() -> tuple[cs.Robot, pin.Model]:
    """The iiwa14 with meshes, which are not convex; skips where it is absent."""
    file = IIWA14.require()
    return file.robot(), sim.model_from_urdf(file.path)


def panda() -> tuple[cs.Robot, pin.Model]:
    """Franka's arm with convex links, fingers and all; skips where it is absent."""
    file = BY_NAME["panda"].require()
    return file.robot(), sim.model_from_urdf(file.path)


def convex_parts(link: str) -> list[np.ndarray]:
    """Vertices of the convex pieces of a link of `meshes`, link frame."""
    folder = Path(IIWA14.require().path).parent / "convex_parts"
    files = sorted(folder.glob(f"link_{link[-1]}_*.obj"))
    lines = [path.read_text(encoding="utf-8").splitlines() for path in files]
    return [np.array([line.split()[1:4] for line in text if line.startswith("v ")], float) for text in lines]


def rotation(rng: np.random.Generator) -> np.ndarray:
    """A random rotation (3, 3)."""
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    return turn * np.sign(np.linalg.det(turn))

"""How far off the posterior of a contact is, beside what `ContactMap.identifiability` states without it.

`python -m tools.figures.point_errors` prints both as JSON.
"""

from __future__ import annotations

import json
from typing import Any

import numpy as np
from numpy.typing import NDArray

import contactsense as cs
from contactsense_studies.example_robots import panda

FloatArray = NDArray[np.float64]

FORCE = 10.0  # [N]
FRICTION = 0.5
NOISE = cs.NoiseModel(torque=0.1, model=0.0, relative=0.03)
LARGEST_SHARE = 0.1  # of the relative error of the largest torque, on every joint
CONTACTS = 300  # of each link
SAMPLES = 2000  # of each link


def errors(robot: cs.Robot, link: str, seed: int) -> dict[str, float]:
    """Root mean squares over contacts of one normal force, all known to be on this link [m]."""
    contact_map = cs.ContactMap(robot, samples=SAMPLES, friction=FRICTION, noise=NOISE, links=[link])
    samples = robot.surface(link).sample(CONTACTS, seed=seed)
    rng = np.random.default_rng(seed)
    squares = []
    for point_local, normal_local in zip(samples.points, samples.normals, strict=True):
        q = robot.random_configuration(int(rng.integers(2**31)))
        pose = robot.link_pose(q, link)
        point, normal = pose[:3, :3] @ point_local + pose[:3, 3], pose[:3, :3] @ normal_local
        across = 0.5 * FRICTION * FORCE * rng.standard_normal(3)
        force = across - (across @ normal) * normal - FORCE * normal
        torque = robot.jacobian(q, link, point)[:3].T @ force
        own = np.hypot(torque, LARGEST_SHARE * np.abs(torque).max())
        noisy = torque + np.hypot(NOISE.torque, NOISE.relative * own) * rng.standard_normal(robot.nv)
        found = contact_map.evaluate(q, noisy)
        told = contact_map.identifiability(q, force=FORCE)
        shares = np.exp(found.log_posterior)
        mean = shares @ found.points / shares.sum()
        spread = shares @ ((found.points - mean) ** 2).sum(axis=1) / shares.sum()
        nearest = ((told.points - point) ** 2).sum(axis=1).argmin()
        squares.append((told.point_std[nearest] ** 2, ((mean - point) ** 2).sum(), spread))
    stated, error, spread = np.sqrt(np.mean(squares, axis=0))
    return {"stated": float(stated), "error": float(error), "spread": float(spread)}


def run() -> dict[str, Any]:
    """By robot and link."""
    result: dict[str, Any] = {}
    for name, robot in (("iiwa14", cs.Robot.named("iiwa14")), ("panda", panda())):
        joints = {link: robot.jacobian(robot.neutral(), link).any(axis=0).sum() for link in robot.link_names}
        moving = [link for link, count in joints.items() if count]
        result[name] = {link: errors(robot, link, seed) for seed, link in enumerate(moving)}
    return result


if __name__ == "__main__":
    print(json.dumps(run(), indent=2))

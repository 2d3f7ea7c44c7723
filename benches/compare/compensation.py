"""`LoadCompensator.update` beside iDynTree's estimator of external wrenches."""

from __future__ import annotations

from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np

import contactsense as cs

from . import robots
from .idyntree_estimator import IdyntreeEstimator, on_submodels
from .timing import Comparison, Contestant, Pace, interleave

STEPS = 50


def compare(pace: Pace) -> list[Comparison]:
    """iiwa14 with a sensor at its flange, Talos with sensors at wrists and ankles."""
    tips = [*(f"arm_{side}_7_link" for side in ("left", "right"))]
    tips += [f"leg_{side}_6_link" for side in ("left", "right")]
    with resources.as_file(resources.files("contactsense") / "descriptions" / "iiwa14.urdf") as path:
        return [
            _compare("iiwa14, 1 sensor", path, ["iiwa_link_7"], *robots.packaged("iiwa14"), pace),
            _compare("talos, floating, 4 sensors", robots.TALOS, tips, *robots.talos(), pace),
        ]


def _compare(name: str, path: Path, links: list[str], robot: cs.Robot, model: Any, pace: Pace) -> Comparison:
    sensors = [cs.ForceTorqueSensor(f"sensor of {link}", link) for link in links]
    free = 6 if robot.floating_base else 0
    ours = cs.LoadCompensator(robot, sensors)
    theirs = IdyntreeEstimator(path, sensors, list(robot.joint_names[1 if free else 0 :]))
    rng = np.random.default_rng(0)
    steps, peer_steps = [], []
    for _ in range(STEPS):
        q = robots.random_posture(model, rng)
        v, a = rng.uniform(-1.0, 1.0, (2, model.nv))
        readings = rng.uniform(-50.0, 50.0, (len(sensors), 6))
        base = _base_motion(robot, q, v, a) if free else None
        steps.append((q, v, a, readings))
        peer_steps.append(((q[7 if free else 0 :], v[free:], a[free:], readings), base))
        external = on_submodels(robot, q, sensors, [None] * len(sensors), ours.update(*steps[-1]))
        theirs.set(*peer_steps[-1][0])
        theirs.estimate(base)
        np.testing.assert_allclose(theirs.wrenches_on_submodels(), external, rtol=1e-8, atol=1e-8)
    names = {"steps": steps, "peer_steps": peer_steps, "update": ours.update, "peer": theirs, "base": base}
    whole = "for step, base in peer_steps: peer.set(*step); peer.estimate(base); peer.wrenches_on_submodels()"
    contestants = [
        Contestant("contactsense", "for step in steps: update(*step)", names, STEPS),
        Contestant("idyntree, its estimate alone", "for step in steps: peer.estimate(base)", names, STEPS),
        Contestant("idyntree, with its inputs and outputs", whole, names, STEPS),
    ]
    return Comparison(f"compensation, {name}", interleave(contestants, pace), min_ratio=1.0)


def _base_motion(robot: cs.Robot, q: Any, v: Any, a: Any) -> tuple[Any, Any, Any]:
    """Proper acceleration, angular velocity and angular acceleration of the base, its axes."""
    turn = robot.link_pose(q, "base_link")[:3, :3]
    return a[:3] + np.cross(v[3:6], v[:3]) - turn.T @ [0.0, 0.0, -9.81], v[3:6], a[3:6]

"""`MomentumObserver.update` from Python beside Pinocchio and NumPy."""

from __future__ import annotations

from typing import Any

import numpy as np

import contactsense as cs

from . import robots
from .reference_observer import ReferenceObserver
from .timing import Comparison, Contestant, Pace, interleave

DT = 1e-3  # [s]
STEPS = 200
FOLLOW = "for q, v, tau in path: update(q, v, tau)"


def compare(pace: Pace) -> list[Comparison]:
    """iiwa14 (7 joints, fixed) and Talos (32 joints, floating)."""
    return [
        _compare("iiwa14, 7 joints", *robots.packaged("iiwa14"), 8.0, pace),
        _compare("talos, floating, nv 38", *robots.talos(), 5.0, pace),
    ]


def _compare(name: str, robot: cs.Robot, model: Any, min_ratio: float, pace: Pace) -> Comparison:
    missing = 6 if robot.floating_base else 0
    path = [(q, v, tau[missing:]) for q, v, tau in robots.motion(model, DT, STEPS, np.random.default_rng(0))]
    ours, reference = cs.MomentumObserver(robot, dt=DT), ReferenceObserver(model, dt=DT)
    for step in path:
        torque = ours.update(*step)
        np.testing.assert_allclose(reference.update(*step), torque, rtol=1e-9, atol=1e-9)
    contestants = [
        Contestant("contactsense", FOLLOW, {"path": path, "update": ours.update}, STEPS),
        Contestant("pinocchio, numpy", FOLLOW, {"path": path, "update": reference.update}, STEPS),
    ]
    return Comparison(f"observer, {name}", interleave(contestants, pace), min_ratio=min_ratio)

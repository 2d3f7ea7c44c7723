"""Runs of an arm that leans on an obstacle, in closed form, for the tests of the particle filter."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
from robots import packaged

import contactsense as cs
from contactsense import sim

arm = packaged
Which = Callable[[], tuple[cs.Robot, Any]]


@cache
def explored(link: int, seed: int, kind: str = "sphere", which: Which = packaged) -> sim.ContactRun:
    """Forty motions of two degrees, three samples each."""
    robot = which()
    return scene_run(robot, f"iiwa_link_{link}", seed, kind, least_torque=1.0)


def scene_run(
    robot: cs.Robot,
    link: str,
    seed: int,
    kind: str = "sphere",
    *,
    least_torque: float = 0.5,
    stiffness: tuple[float, float] = (1e3, 1e4),
) -> sim.ContactRun:
    for chance in range(seed, seed + 500, 50):
        try:
            scene = sim.touch_scene(
                robot,
                link,
                kind=kind,
                stiffness_range=stiffness,
                least_torque=least_torque,
                seed=chance,
            )
            path = sim.joint_exploration(robot, scene, pace=sim.Pace(motions=40, duration=0.25), seed=chance)
        except cs.InputError:
            continue
        rows = slice(None, None, 4)
        return sim.record_quasi_static(robot, scene.contact(robot), path.time[rows], path.q[rows])
    raise AssertionError(f"no scene on {link}")


def follow(
    run: sim.ContactRun, noise: float = 0.0, robot: cs.Robot | None = None, **options: Any
) -> cs.ContactEstimate:
    generator = np.random.default_rng(3)
    tracker = cs.ContactParticleFilter(robot or arm(), **options)
    for q, torque in zip(run.q, run.external_torque, strict=True):
        estimate = tracker.update(q, torque * (1.0 + noise * generator.standard_normal(torque.size)))
    return estimate


def error(estimate: cs.ContactEstimate, run: sim.ContactRun) -> float:
    return float(np.linalg.norm(estimate.point - run.point[-1]))
